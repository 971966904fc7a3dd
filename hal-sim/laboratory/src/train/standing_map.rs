//! What stands still around a scanner that stands still: a map of its own recording, without looking at any label.
//!
//! The leg detector is meant to run where the map of the place is known (book, Legs: Static map). The recordings come
//! without a map, so it is made from all their scans: a place that returns in an eighth of them is furniture.

use std::f32::consts::TAU;

use floorguard_types::geometry::Point2;
use floorguard_types::sensing::{BeamReturn, Scan};

use super::leg_scans::LabelledScan;

/// Cells of the range, metres.
const CELL_M: f32 = 0.05;
const CELLS: usize = 240;
/// Share of the scans that makes a place furniture. People rarely stand that long.
const FURNITURE_SHARE: f32 = 0.12;
/// Share that only what never moves reaches, and the share of all returns that must lie there: the scanner stands.
const FIXED_SHARE: f32 = 0.3;
const STANDING_SHARE: f32 = 0.4;
/// A point within this many beams and metres of furniture belongs to it.
const BEAMS_BESIDE: isize = 2;
const NEAR_M: f32 = 0.1;

/// In fewer scans somebody who was seen once or twice would be furniture.
const SCANS_MIN: u32 = 32;

/// Furniture by beam and range.
#[derive(Clone, Debug)]
pub struct StandingMap {
    first_angle_rad: f32,
    step_rad: f32,
    furniture: Vec<[bool; CELLS]>,
}

impl StandingMap {
    /// From the scans of one recording; `None` where the scanner moved, nothing was seen, or there are too few of
    /// them to tell.
    #[must_use]
    pub fn new<'a>(scans: impl Iterator<Item = &'a LabelledScan> + Clone) -> Option<Self> {
        let Scan { first_angle_rad, step_rad, .. } = scans.clone().next()?.scan;
        let mut counts: Vec<[u32; CELLS]> = Vec::new();
        let mut total = 0_u32;
        for labelled in scans {
            total += 1;
            counts.resize(counts.len().max(labelled.scan.beams.len()), [0; CELLS]);
            for (count, beam) in counts.iter_mut().zip(&labelled.scan.beams) {
                let BeamReturn::Hit(range_mm) = beam else { continue };
                if let Some(cell) = count.get_mut((f32::from(*range_mm) * 1.0e-3 / CELL_M) as usize) {
                    *cell += 1;
                }
            }
        }
        if total < SCANS_MIN {
            return None;
        }
        let returns: u32 = counts.iter().flatten().sum();
        let on_fixed: u32 = counts
            .iter()
            .map(|beam| {
                beam.iter()
                    .enumerate()
                    .filter(|(cell, _)| share(beam, *cell, total) >= FIXED_SHARE)
                    .map(|(_, n)| n)
                    .sum::<u32>()
            })
            .sum();
        if (on_fixed as f32) < STANDING_SHARE * returns.max(1) as f32 {
            return None;
        }
        let furniture = counts
            .iter()
            .map(|beam| core::array::from_fn(|cell| share(beam, cell, total) >= FURNITURE_SHARE))
            .collect();
        Some(Self { first_angle_rad, step_rad, furniture })
    }

    /// Furniture stands at a point of the scanner's frame.
    #[must_use]
    pub fn knows(&self, point: Point2) -> bool {
        let bearing_rad = (libm::atan2f(point.y_m, point.x_m) - self.first_angle_rad).rem_euclid(TAU);
        let beam = (bearing_rad / self.step_rad).round() as isize;
        let range_m = point.norm();
        let cells = ((range_m - NEAR_M).max(0.0) / CELL_M) as usize..=((range_m + NEAR_M) / CELL_M) as usize;
        (beam - BEAMS_BESIDE..=beam + BEAMS_BESIDE).any(|beam| {
            let furniture = usize::try_from(beam).ok().and_then(|beam| self.furniture.get(beam));
            furniture.is_some_and(|beam| cells.clone().any(|cell| beam.get(cell).copied().unwrap_or(false)))
        })
    }
}

/// Share of the scans with a return in a cell or beside it: a range on a border falls into either.
fn share(beam: &[u32; CELLS], cell: usize, total: u32) -> f32 {
    let from = cell.saturating_sub(1);
    let count: u32 = beam.iter().skip(from).take(cell + 2 - from).sum();
    count as f32 / total.max(1) as f32
}
