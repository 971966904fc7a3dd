//! CLEAR-MOT figures of two files in the MOT15 format: what was there, and what a tracker said.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use super::text::{numbers, read_text};
use crate::commands::BadInput;
use crate::metrics::{MotAccumulator, MotSummary};

/// Largest distance of a pair: 1 − intersection over union, the usual gate of that format.
pub const RECTANGLE_GATE: f64 = 0.5;
/// Cells that a row needs: frame, id, left, top, width, height.
const CELLS_MIN: usize = 6;

/// Left, top, width, height.
type Rectangle = [f64; 4];
type Frames = BTreeMap<u64, Vec<(u64, Rectangle)>>;

/// The figures, with the name that the field has elsewhere for the switches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TracksReport {
    /// Times that an object was covered by another track than before.
    pub id_switches: u64,
    /// All figures.
    #[serde(flatten)]
    pub summary: MotSummary,
}

/// Compares two files of rows `frame,id,left,top,width,height[,confidence,…]`.
///
/// # Errors
/// A file cannot be read or is not in this form.
pub fn tracks(truth: &Path, result: &Path) -> anyhow::Result<TracksReport> {
    let (objects, found) = (frames(truth, true)?, frames(result, false)?);
    if objects.is_empty() {
        return Err(BadInput(format!("{}: no rows", truth.display())).into());
    }
    let mut numbers: Vec<u64> = objects.keys().chain(found.keys()).copied().collect();
    numbers.sort_unstable();
    numbers.dedup();
    let mut accumulator = MotAccumulator::new();
    let nobody = Vec::new();
    for number in numbers {
        let (objects, found) =
            (objects.get(&number).unwrap_or(&nobody), found.get(&number).unwrap_or(&nobody));
        let ids = |list: &[(u64, Rectangle)]| -> Vec<u64> { list.iter().map(|(id, _)| *id).collect() };
        accumulator.frame_by_distance(&ids(objects), &ids(found), |object, track| {
            distance(&objects[object].1, &found[track].1)
        });
    }
    let summary = accumulator.summary();
    Ok(TracksReport { id_switches: summary.switches, summary })
}

/// Rows by frame. A row of the truth with confidence 0 is marked by its authors as not to be counted.
fn frames(path: &Path, is_truth: bool) -> anyhow::Result<Frames> {
    let mut frames = Frames::new();
    for (index, line) in read_text(path)?.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let row = numbers(path, index + 1, line)?;
        let bad = |problem: &str| BadInput(format!("{}, line {}: {problem}", path.display(), index + 1));
        if row.len() < CELLS_MIN {
            return Err(bad("fewer than six cells").into());
        }
        if row[..2].iter().any(|value| *value < 0.0 || value.fract() != 0.0) {
            return Err(bad("frame and id are whole numbers from 0").into());
        }
        if is_truth && row.get(CELLS_MIN) == Some(&0.0) {
            continue;
        }
        let rectangle = [row[2], row[3], row[4], row[5]];
        frames.entry(row[0] as u64).or_default().push((row[1] as u64, rectangle));
    }
    Ok(frames)
}

/// 1 − intersection over union; `None` beyond [`RECTANGLE_GATE`].
fn distance(a: &Rectangle, b: &Rectangle) -> Option<f64> {
    let overlap = |axis: usize| {
        let end = (a[axis] + a[axis + 2]).min(b[axis] + b[axis + 2]);
        (end - a[axis].max(b[axis])).max(0.0)
    };
    let intersection = overlap(0) * overlap(1);
    let union = a[2] * a[3] + b[2] * b[3] - intersection;
    let distance = 1.0 - intersection / union.max(f64::MIN_POSITIVE);
    (distance <= RECTANGLE_GATE).then_some(distance)
}
