//! Dirt in a folder of frames with masks: the published detector and ours, on the same pixels.

use std::path::Path;

use anyhow::Context;
use floorguard_perception::floor::dirt::DirtFault;
use floorguard_types::sensing::{ColorImage, ImageSize};
use floorguard_types::time::Stamp;
use image::{Rgb, RgbImage};
use serde::Serialize;

use super::dirt_figures::{DirtFigures, DirtTotals};
use floorguard_host::outcome::BadInput;
use floorguard_robot::picture_files::DirtFolder;
use floorguard_robot::picture_files::{ColourFile, make_folder};
use floorguard_robot::picture_files::{DirtAnswer, DirtDetectors};

/// Both detectors on the frames of one folder. The figures of ours stand also at the top.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DirtReport {
    /// Frames that were judged.
    pub frames: usize,
    /// Frames that could not be judged, with too little free floor: unknown, not clean.
    pub frames_unknown: usize,
    /// Pictures in the folder that are neither frames nor masks.
    pub other_pictures: usize,
    /// Pixels of the files along one judged pixel, the most over all frames.
    pub reduced_by: usize,
    /// Our detector.
    #[serde(flatten)]
    pub figures: DirtFigures,
    /// The published one.
    pub published: DirtFigures,
    /// Our detector.
    pub ours: DirtFigures,
}

/// Judges every frame of a folder; pictures go to `out`.
///
/// # Errors
/// The folder or a file cannot be used, a frame has no mask, or no frame can be judged: all of the floor is unknown.
pub fn dirt(root: &Path, out: Option<&Path>) -> anyhow::Result<DirtReport> {
    let folder = DirtFolder::open(root)?;
    let mut report = DirtReport { other_pictures: folder.others, ..DirtReport::default() };
    let (mut published, mut ours) = (DirtTotals::default(), DirtTotals::default());
    let mut detectors = DirtDetectors::default();
    for path in &folder.frames {
        let frame = folder.read(path)?;
        report.reduced_by = report.reduced_by.max(frame.reduced_by);
        let size = (frame.picture.width, frame.picture.height);
        let image =
            ColorImage::new(Stamp::ZERO, ImageSize { width: size.0, height: size.1 }, &frame.picture.rgb)?;
        let [first, second] = match detectors.judge(&image, &frame.usable, None) {
            Ok(answers) => answers,
            Err(problem @ (DirtFault::TooLittleFloor { .. } | DirtFault::Unlit(_))) => {
                say!("{}: floor unknown: {problem}", path.display());
                report.frames_unknown += 1;
                continue;
            }
            Err(problem) => {
                return Err(BadInput(format!("{}: floor unknown: {problem}", path.display())).into());
            }
        };
        let judged: Vec<bool> =
            first.scores.iter().zip(&second.scores).map(|(a, b)| !a.is_nan() && !b.is_nan()).collect();
        published.add(&first, (&frame.dirt, &judged), frame.picture.width);
        ours.add(&second, (&frame.dirt, &judged), frame.picture.width);
        if let Some(out) = out {
            let path = make_folder(out)?.join(format!("{}_dirt.png", frame.name));
            let picture = picture(&frame.picture, &frame.dirt, [&first, &second]);
            picture.save(&path).with_context(|| format!("{}: cannot be written", path.display()))?;
        }
        report.frames += 1;
    }
    if report.frames == 0 {
        return Err(BadInput(format!("{}: no frame could be judged: floor unknown", root.display())).into());
    }
    if !ours.has_dirt() {
        say!(
            "{}: no mask shows dirt on free floor: nobody can tell overlap, areas and recall",
            root.display()
        );
    }
    report.published = published.figures();
    report.ours = ours.figures();
    report.figures = report.ours;
    Ok(report)
}

/// The frame with the true dirt in green, the published answer in blue and ours in red, side by side.
fn picture(file: &ColourFile, truth: &[bool], [published, ours]: [&DirtAnswer; 2]) -> RgbImage {
    let (width, height) = (file.width as u32, file.height as u32);
    let mut picture = RgbImage::new(width * 3, height);
    let panels = [
        (truth, Rgb([40, 200, 70])),
        (&published.is_dirty, Rgb([50, 90, 235])),
        (&ours.is_dirty, Rgb([235, 50, 60])),
    ];
    for (panel, (marked, colour)) in panels.into_iter().enumerate() {
        for (index, (pixel, is_marked)) in file.rgb.chunks_exact(3).zip(marked).enumerate() {
            let own = Rgb([pixel[0], pixel[1], pixel[2]]);
            let x = (index % file.width) as u32 + panel as u32 * width;
            picture.put_pixel(x, (index / file.width) as u32, if *is_marked { colour } else { own });
        }
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::random::Pcg32;

    /// A covered camera says nothing of dirt: its frame is unknown, and counts neither as clean nor as the end of the folder.
    #[test]
    fn black_frame_is_unknown_others_are_judged() {
        let folder = tempfile::tempdir().unwrap();
        let mut random = Pcg32::new(1, 1);
        let mut frame = |name: &str, grey: u8| {
            let noise = if grey > 20 { 12.0 } else { 0.0 };
            let stain = |x: u32, y: u32| (140..180).contains(&x) && (100..140).contains(&y);
            let picture = RgbImage::from_fn(320, 240, |x, y| {
                let value = f32::from(grey) * if stain(x, y) { 0.5 } else { 1.0 } + noise * random.normal();
                image::Rgb([value.clamp(0.0, 255.0) as u8; 3])
            });
            picture.save(folder.path().join(format!("{name}.png"))).unwrap();
            let mask = image::GrayImage::from_fn(320, 240, |x, y| image::Luma([255 * u8::from(stain(x, y))]));
            mask.save(folder.path().join(format!("{name}_mask.png"))).unwrap();
        };
        frame("a1", 140);
        frame("a2", 3);
        let report = dirt(folder.path(), None).unwrap();
        assert_eq!((report.frames, report.frames_unknown), (1, 1));
        std::fs::remove_file(folder.path().join("a1.png")).unwrap();
        std::fs::remove_file(folder.path().join("a1_mask.png")).unwrap();
        let refused = dirt(folder.path(), None).unwrap_err().to_string();
        assert!(refused.contains("no frame could be judged"), "{refused}");
    }
}
