//! Both detectors on the same frames, for one kind of floor and one kind of dirt.

use floorguard_laboratory::evaluate::{DirtFigures, DirtTotals};
use floorguard_perception::floor::dirt::FloorView;
use floorguard_robot::picture_files::{DirtAnswer, DirtDetectors};
use floorguard_sim::floor::{DirtKind, FloorKind, FloorPicture, PictureMoment};
use floorguard_types::sensing::ColorImage;
use floorguard_types::time::Stamp;

use super::scenes::{Approach, FRAMES, view};

/// Every so many pixels one goes into the curves.
const CURVE_STEP: usize = 7;

/// What both detectors did on one kind of floor with one kind of dirt: published, ours from one frame, ours.
#[derive(Clone, Debug)]
pub struct Cell {
    /// The floor.
    pub floor: FloorKind,
    /// The dirt.
    pub dirt: DirtKind,
    /// Published, ours from the last frame alone, ours from all frames.
    pub figures: [DirtFigures; 3],
    /// Score, comparable between frames, and truth of pixels: published and ours.
    pub curves: [Vec<(f32, bool)>; 2],
}

/// Runs so many scenes of a floor and a dirt, drawn from a seed.
///
/// # Errors
/// A frame could not be judged.
pub fn compare(floor: FloorKind, dirt: DirtKind, (scenes, seed): (u64, u64)) -> anyhow::Result<Cell> {
    let mut detectors = DirtDetectors::default();
    let mut totals: [DirtTotals; 3] = Default::default();
    let mut curves = [Vec::new(), Vec::new()];
    for number in 0..scenes {
        let approach = Approach::new(floor, dirt, (number, seed));
        detectors.forget();
        let mut last = None;
        for frame in 0..FRAMES {
            let pose = approach.pose(frame);
            let picture = approach.scene.picture(
                &approach.camera,
                pose,
                PictureMoment { frame, at_s: approach.time_s(frame) },
            );
            let view = view(&approach.camera, pose);
            watch(&mut detectors, &picture, &view)?;
            last = Some((picture, view));
        }
        let (picture, view) = last.expect("there are frames");
        let image = ColorImage::new(Stamp::ZERO, picture.size, &picture.rgb)?;
        let usable = picture.usable();
        let [published, ours] = detectors.judge(&image, &usable, Some(&view))?;
        detectors.forget();
        let [_, alone] = detectors.judge(&image, &usable, None)?;
        let truth: Vec<bool> = picture.dirt.iter().map(Option::is_some).collect();
        let judged: Vec<bool> =
            published.scores.iter().zip(&ours.scores).map(|(a, b)| !a.is_nan() && !b.is_nan()).collect();
        for (total, answer) in totals.iter_mut().zip([&published, &alone, &ours]) {
            total.add(answer, (&truth, &judged), picture.size.width);
        }
        curves[0].extend(points(&standardised(&published), &truth, &judged));
        curves[1].extend(points(&ours.scores, &truth, &judged));
    }
    Ok(Cell { floor, dirt, figures: totals.map(|total| total.figures()), curves })
}

fn watch(detectors: &mut DirtDetectors, picture: &FloorPicture, view: &FloorView) -> anyhow::Result<()> {
    let image = ColorImage::new(Stamp::ZERO, picture.size, &picture.rgb)?;
    Ok(detectors.watch(&image, &picture.usable(), Some(view))?)
}

fn points(scores: &[f32], truth: &[bool], judged: &[bool]) -> Vec<(f32, bool)> {
    let all = scores.iter().zip(truth).zip(judged).step_by(CURVE_STEP);
    all.filter(|(_, is_judged)| **is_judged).map(|((score, truth), _)| (*score, *truth)).collect()
}

/// The published scores in spreads above the frame's median: that is how the published threshold compares them.
fn standardised(answer: &DirtAnswer) -> Vec<f32> {
    let middle = |mut values: Vec<f32>| {
        values.sort_by(f32::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let known = || answer.scores.iter().copied().filter(|score| !score.is_nan());
    let median = middle(known().collect());
    let spread = middle(known().map(|score| (score - median).abs()).collect()).max(1e-3);
    answer.scores.iter().map(|score| (score - median) / spread).collect()
}
