//! Tells the floor from what stands on it, column by column from the lowest ring upwards.
//!
//! A return is floor if it lies near the height that the floor had one ring before, with an allowance that grows with
//! the distance walked: ramps and a pitching robot pass, a shoe does not. The allowance is a slope; the height limit
//! keeps a low table from being called a ramp.

use super::projection::{RingAngles, SweepFrame};
use crate::capacities::{SWEEP_COLUMNS, SWEEP_RINGS};
use crate::geometry::{Transform3, Twist2};
use crate::sensing::Sweep;

/// Height that a floor return may differ at any distance, metres: range noise of ±3 cm at 15° and tile gaps.
const ROUGHNESS_M: f32 = 0.06;
/// Slope that still is a floor: 8.5°, more than any ramp that a scrubber climbs.
const SLOPE: f32 = 0.15;
/// The slope is only allowed for over this much floor, metres: between far rings lie several metres, and the foot of a
/// wall must not pass for a ramp. What goes on as steeply as before passes at any distance.
const SLOPE_RUN_M: f32 = 0.4;
/// Horizontal distance between a foot and the leg above it, metres: range noise of both.
const FOOT_M: f32 = 0.1;
/// Share of a new step in the slope that is expected to go on.
const SLOPE_GAIN: f32 = 0.5;
/// Highest floor at the robot, metres, and its growth with distance (half the slope: a ramp may begin later).
const HIGHEST_M: f32 = 0.15;
const HIGHEST_SLOPE: f32 = 0.07;

/// Which returns of a sweep are floor: one word per column, one bit per ring. 3.6 KiB.
#[derive(Clone, Debug)]
pub struct FloorMask {
    columns: [u16; SWEEP_COLUMNS],
}

impl Default for FloorMask {
    fn default() -> Self {
        Self::new()
    }
}

impl FloorMask {
    /// Nothing is floor.
    #[must_use]
    pub const fn new() -> Self {
        Self { columns: [0; SWEEP_COLUMNS] }
    }

    /// Marks the floor of a sweep. Linear in its cells, constant per column.
    pub fn find(&mut self, sweep: &Sweep, angles: &RingAngles, sensor_in_base: &Transform3) {
        self.columns.fill(0);
        // Where the robot drove meanwhile does not change a height.
        let frames = SweepFrame::new(sweep, sensor_in_base, Twist2::ZERO);
        for (marks, column) in self.columns.iter_mut().zip(sweep.used_columns()) {
            if column.measured {
                let profile = frames.still(column).profile(angles);
                let mut walk = FloorWalk::default();
                let cells = column.range_raw.iter().zip(&profile).enumerate();
                for (ring, (raw, (along, rise, height_m))) in cells.filter(|(_, (raw, _))| **raw != 0) {
                    let (bit, counts) = (1_u16.wrapping_shl(ring as u32), f32::from(*raw));
                    walk.step(bit, counts * along, counts * rise + height_m);
                }
                *marks = walk.floor();
            }
        }
    }

    /// The return of a cell is floor.
    #[must_use]
    pub fn is_floor(&self, column: usize, ring: usize) -> bool {
        self.columns.get(column).is_some_and(|marks| bit(*marks, ring))
    }
}

const _: () = assert!(SWEEP_RINGS <= 16);

/// The bit of a ring.
const fn bit(marks: u16, ring: usize) -> bool {
    ring < 16 && marks.wrapping_shr(ring as u32) & 1 != 0
}

/// Walks up one column, from the lowest ring on, and marks the returns that are floor.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FloorWalk {
    floor: u16,
    last_distance_m: f32,
    last_height_m: f32,
    slope: f32,
    /// Bit and distance of the newest floor return, until something follows it; no bit otherwise.
    newest: (u16, f32),
}

impl FloorWalk {
    /// The next return upwards: the bit of its ring, horizontal distance from the lidar and height above the robot's floor, metres.
    #[inline]
    pub(super) fn step(&mut self, bit: u16, distance_m: f32, height_m: f32) {
        let walked_m = (distance_m - self.last_distance_m).max(0.0);
        let rise_m = height_m - self.last_height_m;
        let near_the_last = || {
            let allowed_m = ROUGHNESS_M + SLOPE * walked_m.min(SLOPE_RUN_M);
            (rise_m - self.slope * walked_m).abs() <= allowed_m
        };
        // The cheap question first: most returns are walls.
        if height_m <= HIGHEST_M + HIGHEST_SLOPE * distance_m && near_the_last() {
            self.floor |= bit;
            let step = rise_m / walked_m.max(SLOPE_RUN_M);
            self.slope += SLOPE_GAIN * (step.clamp(-SLOPE, SLOPE) - self.slope);
            (self.last_distance_m, self.last_height_m) = (distance_m, height_m);
            self.newest = (bit, distance_m);
        } else {
            let (below, foot_m) = self.newest;
            if below != 0 && (distance_m - foot_m).abs() < FOOT_M {
                // Something upright begins right above: what looked like floor is its foot.
                self.floor &= !below;
            }
            self.newest.0 = 0;
        }
    }

    /// The returns that are floor, a bit each; complete after the last step.
    pub(super) fn floor(&self) -> u16 {
        self.floor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(cells: &[(f32, f32)]) -> u16 {
        let mut walk = FloorWalk::default();
        for (ring, (distance_m, height_m)) in cells.iter().enumerate() {
            walk.step(1 << ring, *distance_m, *height_m);
        }
        walk.floor()
    }

    #[test]
    fn a_flat_floor_ends_at_a_leg() {
        let leg = [(3.0, 0.01), (3.5, -0.02), (4.2, 0.0), (4.8, 0.18), (4.8, 0.35), (4.8, 1.0)];
        assert_eq!(marks(&leg), 0b00_0111);
    }

    #[test]
    fn the_foot_of_a_wall_belongs_to_the_wall() {
        assert_eq!(marks(&[(3.0, 0.0), (4.0, 0.02), (4.02, 0.15), (4.0, 0.3)]), 0b0001);
    }

    #[test]
    fn a_far_wall_is_no_ramp() {
        assert_eq!(marks(&[(6.5, 0.0), (9.1, 0.02), (13.0, 0.35), (13.0, 0.8)]), 0b0011);
    }

    #[test]
    fn a_ramp_is_floor_and_a_table_is_not() {
        assert_eq!(marks(&[(3.0, 0.0), (4.0, 0.08), (5.0, 0.16), (6.0, 0.24)]), 0b1111);
        assert_eq!(marks(&[(3.0, 0.0), (3.2, 0.7), (3.4, 0.7), (3.7, 0.7)]), 0b0001);
    }
}
