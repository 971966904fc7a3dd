//! Tells the floor from what stands on it, column by column from the lowest ring upwards.
//!
//! A return is floor if it lies near the height that the floor had one ring before, with an allowance that grows with
//! the distance walked: ramps and a pitching robot pass, a shoe does not. The allowance is a slope; the height limit
//! keeps a low table from being called a ramp.

use crate::capacities::SWEEP_RINGS;

/// Height that a floor return may differ at any distance, metres: range noise of ±3 cm at 15° and tile gaps.
const ROUGHNESS_M: f32 = 0.06;
/// Slope that still is a floor: 8.5°, more than any ramp that a scrubber climbs.
const SLOPE: f32 = 0.15;
/// Highest floor at the robot, metres, and its growth with distance (half the slope: a ramp may begin later).
const HIGHEST_M: f32 = 0.15;
const HIGHEST_SLOPE: f32 = 0.07;

/// One return of a column: horizontal distance from the robot's lidar and height above its floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Profile {
    pub(super) distance_m: f32,
    pub(super) height_m: f32,
    /// There is a return.
    pub(super) present: bool,
}

/// Marks the returns of one column that are floor.
pub(super) fn classify(column: &[Profile; SWEEP_RINGS]) -> [bool; SWEEP_RINGS] {
    let mut floor = [false; SWEEP_RINGS];
    let (mut last_distance_m, mut last_height_m) = (0.0_f32, 0.0_f32);
    for (is_floor, cell) in floor.iter_mut().zip(column) {
        if !cell.present {
            continue;
        }
        let walked_m = (cell.distance_m - last_distance_m).max(0.0);
        let near_the_last = (cell.height_m - last_height_m).abs() <= ROUGHNESS_M + SLOPE * walked_m;
        let low_enough = cell.height_m <= HIGHEST_M + HIGHEST_SLOPE * cell.distance_m;
        if near_the_last && low_enough {
            *is_floor = true;
            (last_distance_m, last_height_m) = (cell.distance_m, cell.height_m);
        }
    }
    floor
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(cells: &[(f32, f32)]) -> [Profile; SWEEP_RINGS] {
        let mut column = [Profile::default(); SWEEP_RINGS];
        for (cell, (distance_m, height_m)) in column.iter_mut().zip(cells) {
            *cell = Profile { distance_m: *distance_m, height_m: *height_m, present: true };
        }
        column
    }

    #[test]
    fn a_flat_floor_ends_at_a_leg() {
        let marks =
            classify(&column(&[(3.0, 0.01), (3.5, -0.02), (4.2, 0.0), (4.3, 0.18), (4.3, 0.35), (4.3, 1.0)]));
        assert_eq!(marks[..6], [true, true, true, false, false, false]);
    }

    #[test]
    fn a_ramp_is_floor_and_a_table_is_not() {
        let ramp = classify(&column(&[(3.0, 0.0), (4.0, 0.08), (5.0, 0.16), (6.0, 0.24)]));
        assert_eq!(ramp[..4], [true; 4]);
        let table = classify(&column(&[(3.0, 0.0), (3.2, 0.7), (3.4, 0.7), (3.7, 0.7)]));
        assert_eq!(table[..4], [true, false, false, false]);
    }
}
