//! CLEAR-MOT figures of two files in the MOT15 format: the truth, and a tracker's output.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use crate::metrics::{MotAccumulator, MotSummary};
use floorguard_host::outcome::BadInput;
use floorguard_robot::picture_files::{number, read_text};

/// Largest distance of a pair: 1 − intersection over union, the usual gate of that format.
pub const RECTANGLE_GATE: f64 = 0.5;
/// For messages.
const FORM: &str = "rows are frame,id,left,top,width,height[,confidence,…]";
/// Larger numbers are not whole in a number of 64 bits.
const WHOLE_MAX: f64 = 9.0e15;
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
    for (path, rows) in [(truth, &objects), (result, &found)] {
        if rows.is_empty() {
            return Err(BadInput(format!("{}: no rows that count; {FORM}", path.display())).into());
        }
    }
    if !objects.keys().any(|frame| found.contains_key(frame)) {
        let span = |frames: &Frames| {
            let (first, last) = (frames.keys().next(), frames.keys().next_back());
            format!("{} to {}", first.copied().unwrap_or(0), last.copied().unwrap_or(0))
        };
        return Err(BadInput(format!(
            "{} has frames {}, {} has {}: not one in common; number the frames of both alike",
            result.display(),
            span(&found),
            truth.display(),
            span(&objects)
        ))
        .into());
    }
    let mut numbers: Vec<u64> = objects.keys().chain(found.keys()).copied().collect();
    numbers.sort_unstable();
    numbers.dedup();
    let mut accumulator = MotAccumulator::new();
    let empty = Vec::new();
    for number in numbers {
        let (objects, found) = (objects.get(&number).unwrap_or(&empty), found.get(&number).unwrap_or(&empty));
        let ids = |list: &[(u64, Rectangle)]| -> Vec<u64> { list.iter().map(|(id, _)| *id).collect() };
        accumulator.frame_by_distance(&ids(objects), &ids(found), |object, track| {
            distance(&objects[object].1, &found[track].1)
        });
    }
    let summary = accumulator.summary();
    Ok(TracksReport { id_switches: summary.switches, summary })
}

/// Rows by frame, cells apart by commas or blanks. A row of the truth with confidence 0 is marked by its authors as not to be
/// counted.
fn frames(path: &Path, is_truth: bool) -> anyhow::Result<Frames> {
    let mut frames = Frames::new();
    let mut lines: BTreeMap<(u64, u64), usize> = BTreeMap::new();
    for (index, line) in read_text(path)?.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let bad = |problem: &str| BadInput(format!("{}, line {}: {problem}", path.display(), index + 1));
        let cells = line.trim().split(|letter: char| letter == ',' || letter.is_whitespace());
        let cells = cells.filter(|cell| !cell.is_empty());
        let row: Vec<f64> = cells
            .map(|cell| number(path, index + 1, cell))
            .collect::<anyhow::Result<_>>()
            .map_err(|error| {
                if index == 0 {
                    BadInput(format!("{error:#}; {FORM}, without a line of names"))
                } else {
                    BadInput(format!("{error:#}"))
                }
            })?;
        if row.len() < CELLS_MIN {
            return Err(bad(&format!("{} cells; {FORM}; is the file cut off?", row.len())).into());
        }
        if row[..2].iter().any(|value| !(0.0..WHOLE_MAX).contains(value) || value.fract() != 0.0) {
            return Err(
                bad(&format!("frame {} and id {}: whole numbers from 0; {FORM}", row[0], row[1])).into()
            );
        }
        if row[4..CELLS_MIN].iter().any(|side| *side < 0.0) {
            return Err(bad(&format!("a rectangle of {} × {}; {FORM}", row[4], row[5])).into());
        }
        let (frame, id) = (row[0] as u64, row[1] as u64);
        if let Some(known) = lines.insert((frame, id), index + 1) {
            return Err(bad(&format!(
                "frame {frame} has id {id} for the second time, first in line {known}; each may be there once"
            ))
            .into());
        }
        if is_truth && row.get(CELLS_MIN) == Some(&0.0) {
            continue;
        }
        frames.entry(frame).or_default().push((id, [row[2], row[3], row[4], row[5]]));
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
    // Rounding must not make equal rectangles better than equal.
    let distance = (1.0 - intersection / union.max(f64::MIN_POSITIVE)).max(0.0);
    (distance <= RECTANGLE_GATE).then_some(distance)
}
