//! Dirt in a folder of frames with masks: the published detector and ours, on the same pixels.

use std::path::Path;

use floorguard_core::floor::dirt::{DirtFault, NOVELTY_BIN, NoveltyDetector, PublishedDetector};
use floorguard_core::sensing::ColorImage;
use floorguard_core::time::Stamp;
use image::{Rgb, RgbImage};
use serde::Serialize;

use super::dirt_figures::{Answer, DirtFigures, Totals};
use super::dirt_folder::{DirtFolder, DirtFrame};
use super::dirt_memory::NoveltyBuffers;
use super::images::ColourFile;
use crate::commands::BadInput;

/// Pixels along a block.
const BLOCK: usize = 16;

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
    let (mut published, mut ours) = (Totals::default(), Totals::default());
    let mut detectors = Detectors::default();
    for path in &folder.frames {
        let frame = folder.read(path)?;
        report.reduced_by = report.reduced_by.max(frame.reduced_by);
        let [first, second] = match detectors.judge(&frame) {
            Ok(answers) => answers,
            Err(problem @ DirtFault::TooLittleFloor(..)) => {
                anstream::eprintln!("{}: floor unknown: {problem}", path.display());
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
            std::fs::create_dir_all(out)?;
            let name = format!("{}_dirt.png", frame.name);
            picture(&frame.picture, &frame.dirt, [&first, &second]).save(out.join(name))?;
        }
        report.frames += 1;
    }
    if report.frames == 0 {
        return Err(BadInput(format!("{}: no frame could be judged: floor unknown", root.display())).into());
    }
    report.published = published.figures();
    report.ours = ours.figures();
    report.figures = report.ours;
    Ok(report)
}

/// Both detectors and their memory.
#[derive(Default)]
struct Detectors {
    published: Box<PublishedDetector>,
    ours: Box<NoveltyDetector>,
    memory: NoveltyBuffers,
}

impl Detectors {
    fn judge(&mut self, frame: &DirtFrame) -> Result<[Answer; 2], DirtFault> {
        let (file, usable) = (&frame.picture, frame.usable.as_slice());
        let pixels = file.width * file.height;
        let too_little = |_| DirtFault::TooLittleFloor(0, pixels);
        let image = ColorImage::new(Stamp::ZERO, (file.width, file.height), &file.rgb).map_err(too_little)?;
        self.published.detect(&image, usable)?;
        let columns = self.published.columns();
        let of_block = |index: usize| {
            let (column, row) = (index % file.width / BLOCK, index / file.width / BLOCK);
            (column < columns).then_some(row * columns + column)
        };
        let lookup = |index: usize| of_block(index).and_then(|block| self.published.scores().get(block));
        let dirty = |index: usize| of_block(index).and_then(|block| self.published.dirty().get(block));
        let first = Answer {
            scores: (0..pixels).map(|index| lookup(index).copied().unwrap_or(f32::NAN)).collect(),
            is_dirty: (0..pixels).map(|index| dirty(index) == Some(&true)).collect(),
        };
        self.memory.resize(pixels);
        self.ours.detect(&image, usable, None, &mut self.memory.lend())?;
        let (columns, rows) = (self.ours.columns(), self.ours.rows());
        let score = |index: usize| {
            let (column, row) = (index % file.width / NOVELTY_BIN, index / file.width / NOVELTY_BIN);
            if column < columns && row < rows {
                self.memory.scores()[row * columns + column]
            } else {
                f32::NAN
            }
        };
        let scores: Vec<f32> = (0..pixels).map(score).collect();
        let is_dirty = scores.iter().map(|score| *score > self.ours.threshold()).collect();
        Ok([first, Answer { scores, is_dirty }])
    }
}

/// The frame with the true dirt in green, the published answer in blue and ours in red, side by side.
fn picture(file: &ColourFile, truth: &[bool], [published, ours]: [&Answer; 2]) -> RgbImage {
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
