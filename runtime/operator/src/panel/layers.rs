//! The floor of a cleaning mission for the browsers: what is claimed clean and where dirt is expected. It changes once a
//! second at most and is fetched apart from the pictures.

use floorguard_mapping::Occupancy;
use floorguard_types::geometry::Pose2;
use serde::Serialize;

use super::frame::{Place, place, round};
use floorguard_recording::mission::{area_m2, dirt_cells, remains};
use floorguard_robot::cleaner::{CellState, MissionProgress};
use floorguard_robot::site::ros_map::OccupancyMap;

/// How far a mission is, in every picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MissionFrame {
    /// What it is doing, in a word.
    pub phase: &'static str,
    /// Of the dirty floor that can be reached, claimed clean, percent.
    pub completion_percent: f32,
    /// Of all floor that the mission answers for, claimed clean, percent.
    pub claimed_percent: f32,
    /// Claimed clean and cleaned in this mission, m².
    pub cleaned_m2: f32,
    /// Claimed clean because no dirt was expected there, m².
    pub assumed_m2: f32,
    /// Still to be cleaned, m².
    pub remaining_m2: f32,
    /// Cells that are not claimed though visited, and dirty ones out of reach.
    pub uncertain_cells: usize,
    /// See `uncertain_cells`.
    pub unreachable_cells: usize,
    /// Expected dirt now, percent of that before.
    pub dirt_percent: f32,
    /// Time lost to people and other obstacles, seconds.
    pub waited_s: f32,
    /// Where the odometry frame lies in the map of the mission: x, y, heading.
    pub odometry_in_map: [f32; 3],
    /// Number of the floor's newest state, see [`Layers`].
    pub layers: u64,
}

/// The map of the mission: walls and floor, once for a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapFrame {
    /// Pixels in a row.
    pub width: u16,
    /// Rows.
    pub height: u16,
    /// Edge of a pixel, metres.
    pub resolution_m: f32,
    /// Lower left corner.
    pub corner: Place,
    /// Row by row from below: `f` free, `w` wall, `.` unknown; each behind its count.
    pub pixels: String,
}

/// The map of a plan.
pub fn map_frame(map: &OccupancyMap) -> MapFrame {
    let geometry = map.geometry();
    let letters = map.values().iter().map(|pixel| match pixel {
        Occupancy::Free => 'f',
        Occupancy::Occupied => 'w',
        Occupancy::Unknown => '.',
    });
    MapFrame {
        width: geometry.width(),
        height: geometry.height(),
        resolution_m: geometry.resolution_m(),
        corner: place(geometry.origin_in_map()),
        pixels: run_lengths(letters),
    }
}

/// The floor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Layers {
    /// Counts states of the floor.
    pub number: u64,
    /// Cells in a row.
    pub width: u16,
    /// Rows.
    pub height: u16,
    /// Edge of a cell, metres.
    pub resolution_m: f32,
    /// Lower left corner in the map of the mission.
    pub corner: Place,
    /// Row by row: `.` is none of ours, `d` dirty, `u` uncertain, `a` assumed clean, `c` cleaned in this mission; each behind its
    /// count.
    pub claimed: String,
    /// Row by row: `.` is none of ours, `0` no dirt expected … `9` most; each behind its count.
    pub dirt: String,
    /// Centres of the cells to be visited next, in order, in the map of the mission.
    pub tour: Vec<Place>,
}

/// Places of a tour that are drawn.
const TOUR_SHOWN: usize = 200;

/// A mission at a moment.
pub fn mission_frame(progress: &MissionProgress, first: &MissionProgress, layers: u64) -> MissionFrame {
    let cleaned: Vec<usize> =
        (0..progress.cells.len()).filter(|cell| is_cleaned(progress, first, *cell)).collect();
    let cell_m2 = progress.geometry.resolution_m() * progress.geometry.resolution_m();
    let total = |units: &[f32]| units.iter().sum::<f32>();
    let before = total(&progress.expected_before).max(1.0e-6);
    let Pose2 { x_m, y_m, heading_rad } = progress.odometry_in_map;
    MissionFrame {
        phase: progress.phase.name(),
        completion_percent: round(progress.completion * 100.0),
        claimed_percent: round(progress.claimed_fraction * 100.0),
        cleaned_m2: round(cleaned.len() as f32 * cell_m2),
        assumed_m2: round(
            area_m2(progress, |state| state == CellState::Clean) - cleaned.len() as f32 * cell_m2,
        ),
        remaining_m2: round(area_m2(progress, remains)),
        uncertain_cells: progress.uncertain.len(),
        unreachable_cells: progress.unreachable_cells,
        dirt_percent: round(total(&progress.expected_now) / before * 100.0),
        waited_s: round(progress.waited_s),
        odometry_in_map: [x_m, y_m, heading_rad],
        layers,
    }
}

/// A cell that is claimed clean was cleaned in this mission if it was not claimed at its beginning, or if there is less dirt
/// now than was expected before; else it is only assumed to be clean.
fn is_cleaned(progress: &MissionProgress, first: &MissionProgress, cell: usize) -> bool {
    /// Dirt that grows or decays by itself changes the expectation by less than this share.
    const LESS: f32 = 0.9;
    let is_clean = progress.cells.get(cell) == Some(&CellState::Clean);
    let was_clean = first.cells.get(cell) == Some(&CellState::Clean);
    let units = |expected: &[f32]| expected.get(cell).copied().unwrap_or(0.0);
    let before = units(&progress.expected_before);
    is_clean && (!was_clean || (before > 0.0 && units(&progress.expected_now) < LESS * before))
}

/// The floor at a moment; `first` is the first that the mission has reported.
pub fn layers(progress: &MissionProgress, first: &MissionProgress, number: u64) -> Layers {
    let claimed = progress.cells.iter().enumerate().map(|(cell, state)| match state {
        CellState::OffLimits => '.',
        CellState::Dirty => 'd',
        CellState::Active | CellState::Uncertain => 'u',
        CellState::Clean if is_cleaned(progress, first, cell) => 'c',
        CellState::Clean => 'a',
    });
    let dirt = dirt_cells(progress, &progress.expected_now);
    let digit =
        |percent: &i8| u8::try_from(*percent).map_or('.', |percent| char::from(b'0' + percent.min(99) / 10));
    Layers {
        number,
        width: progress.geometry.width(),
        height: progress.geometry.height(),
        resolution_m: progress.geometry.resolution_m(),
        corner: place(progress.geometry.origin_in_map()),
        claimed: run_lengths(claimed),
        dirt: run_lengths(dirt.iter().map(digit)),
        tour: progress.tour.iter().take(TOUR_SHOWN).copied().map(place).collect(),
    }
}

/// `3.2d1.`: each letter behind the times that it comes.
fn run_lengths(letters: impl Iterator<Item = char>) -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    let mut letters = letters.peekable();
    while let Some(letter) = letters.next() {
        let mut count = 1_u32;
        while letters.next_if_eq(&letter).is_some() {
            count += 1;
        }
        // Digits stand for themselves: a separator keeps them apart from the counts.
        let _ = write!(text, "{count}:{letter}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_come_back_from_their_counts() {
        assert_eq!(run_lengths("...dd.9".chars()), "3:.2:d1:.1:9");
        assert_eq!(run_lengths("".chars()), "");
    }
}
