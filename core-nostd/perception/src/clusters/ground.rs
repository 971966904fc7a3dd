//! Tells the floor from what stands on it, column by column from the lowest ring upwards.
//!
//! A return is floor if it lies near the height that the floor had one ring before, with an allowance that grows with
//! the distance walked: ramps and a pitching robot pass, a shoe does not. The allowance is a slope; the height limit
//! keeps a low table from being called a ramp.

use super::projection::{RingAngles, RingProfile, SweepFrame};
use floorguard_types::capacities::{SWEEP_COLUMNS, SWEEP_RINGS};
use floorguard_types::geometry::{Transform3, Twist2};
use floorguard_types::number::count_u32;
use floorguard_types::profile::Profile;
use floorguard_types::sensing::{SweepColumnOf, SweepOf};

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
    pub fn find<P: Profile>(&mut self, sweep: &SweepOf<P>, angles: &RingAngles, sensor_in_base: &Transform3) {
        self.columns.fill(0);
        // Where the robot drove meanwhile does not change a height.
        let frames = SweepFrame::new(sweep, sensor_in_base, Twist2::ZERO);
        let mut profile = frames.still(&SweepColumnOf::<P>::UNKNOWN).profile(angles);
        let mut limits = FloorLimits::new(&profile);
        for (marks, column) in self.columns.iter_mut().zip(sweep.used_columns()) {
            if column.measured {
                if !frames.is_level() {
                    profile = frames.still(column).profile(angles);
                    limits = FloorLimits::new(&profile);
                }
                *marks = limits.floor_of(&column.range_raw, &profile);
            }
        }
    }

    /// The return of a cell is floor.
    #[must_use]
    pub fn is_floor(&self, column: usize, ring: usize) -> bool {
        self.columns.get(column).is_some_and(|marks| ring < SWEEP_RINGS && marks & bit(ring) != 0)
    }
}

/// The bit of a ring.
const fn bit(ring: usize) -> u16 {
    1_u16.wrapping_shl(count_u32(ring))
}

/// How high a return may lie: the cheap question, asked first, for most returns are walls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FloorLimits {
    /// Per ring: height of a count over the highest floor at its distance, metres, and the most that passes.
    excess: [(f32, f32); SWEEP_RINGS],
    /// Rings from the lowest on that can meet a floor; those above look over every ramp.
    rings: usize,
}

impl FloorLimits {
    pub(crate) fn new(profile: &RingProfile) -> Self {
        let excess =
            profile.map(|(along, rise, origin_m)| (rise - HIGHEST_SLOPE * along, HIGHEST_M - origin_m));
        let highest = excess.iter().rposition(|(rise, most_m)| *rise < 0.0 || *most_m >= 0.0);
        Self { excess, rings: highest.map_or(0, |ring| ring.saturating_add(1)) }
    }

    /// Walks up a column, from the lowest ring on; the returns that are floor, a bit each.
    #[inline]
    pub(crate) fn floor_of(&self, range_raw: &[u16; SWEEP_RINGS], profile: &RingProfile) -> u16 {
        let mut walk = FloorWalk::default();
        let (Some((lower, upper)), Some((below, above))) =
            (range_raw.split_at_checked(self.rings), profile.split_at_checked(self.rings))
        else {
            return 0;
        };
        let mut bit = 1;
        for ((raw, ring), (excess, excess_max_m)) in lower.iter().zip(below).zip(&self.excess) {
            if *raw != 0 {
                let counts = f32::from(*raw);
                walk.step(counts, ring, (counts * excess <= *excess_max_m, bit));
            }
            bit = bit.wrapping_shl(1);
        }
        // Something upright may begin above the last of them.
        if walk.newest.0 != 0
            && let Some((raw, (along, ..))) = upper.iter().zip(above).find(|(raw, _)| **raw != 0)
        {
            walk.end_at(f32::from(*raw) * along);
        }
        walk.floor
    }
}

/// Walks up one column, from the lowest ring on, and marks the returns that are floor.
#[derive(Clone, Copy, Debug, Default)]
struct FloorWalk {
    floor: u16,
    last_distance_m: f32,
    last_height_m: f32,
    slope: f32,
    /// Bit and distance of the newest floor return, until something follows it; no bit otherwise.
    newest: (u16, f32),
}

impl FloorWalk {
    /// The next return upwards: its range in counts, what a count means there, whether it is low enough for a floor, and the
    /// bit of its ring.
    #[inline]
    #[expect(clippy::manual_clamp, reason = "on the Cortex-M7 a clamp is six instructions, these are two")]
    fn step(&mut self, counts: f32, (along, rise, origin_m): &(f32, f32, f32), (low, bit): (bool, u16)) {
        let distance_m = counts * along;
        if low {
            let height_m = counts * rise + origin_m;
            let walked_m = (distance_m - self.last_distance_m).max(0.0);
            let rise_m = height_m - self.last_height_m;
            let allowed_m = ROUGHNESS_M + SLOPE * walked_m.min(SLOPE_RUN_M);
            if (rise_m - self.slope * walked_m).abs() <= allowed_m {
                self.floor |= bit;
                let step = rise_m / walked_m.max(SLOPE_RUN_M);
                self.slope += SLOPE_GAIN * (step.max(-SLOPE).min(SLOPE) - self.slope);
                (self.last_distance_m, self.last_height_m) = (distance_m, height_m);
                self.newest = (bit, distance_m);
                return;
            }
        }
        self.end_at(distance_m);
    }

    /// The next return upwards is no floor: if it stands right above the newest one, that was its foot.
    #[inline]
    fn end_at(&mut self, distance_m: f32) {
        let (below, foot_m) = self.newest;
        if below != 0 && (distance_m - foot_m).abs() < FOOT_M {
            self.floor &= !below;
        }
        self.newest.0 = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENSOR_M: f32 = 0.9;

    fn marks(cells: &[(f32, f32)]) -> u16 {
        let (mut range_raw, mut profile) = ([0; SWEEP_RINGS], [(0.0, 0.0, 0.0); SWEEP_RINGS]);
        for (ring, (distance_m, height_m)) in cells.iter().enumerate() {
            range_raw[ring] = 1_000;
            profile[ring] = (distance_m / 1_000.0, (height_m - SENSOR_M) / 1_000.0, SENSOR_M);
        }
        FloorLimits::new(&profile).floor_of(&range_raw, &profile)
    }

    #[test]
    fn a_flat_floor_ends_at_a_leg() {
        let leg = [(3.0, 0.01), (3.5, -0.02), (4.2, 0.0), (4.8, 0.18), (4.8, 0.35), (4.8, 1.0)];
        assert_eq!(marks(&leg), 0b00_0111);
    }

    #[test]
    fn foot_of_a_wall_belongs_to_it() {
        assert_eq!(marks(&[(3.0, 0.0), (4.0, 0.02), (4.02, 0.15), (4.0, 0.3)]), 0b0001);
    }

    #[test]
    fn a_far_wall_is_no_ramp() {
        assert_eq!(marks(&[(6.5, 0.0), (9.1, 0.02), (13.0, 0.35), (13.0, 0.8)]), 0b0011);
    }

    #[test]
    fn ramp_is_floor_and_table_is_not() {
        assert_eq!(marks(&[(3.0, 0.0), (4.0, 0.08), (5.0, 0.16), (6.0, 0.24)]), 0b1111);
        assert_eq!(marks(&[(3.0, 0.0), (3.2, 0.7), (3.4, 0.7), (3.7, 0.7)]), 0b0001);
    }

    /// A column of a lidar that stands upright, at a height; ranges in metres, 0 without a return.
    fn marks_of(sensor_m: f32, ranges_m: [f32; SWEEP_RINGS]) -> u16 {
        let profile =
            RingAngles::vlp16().rings.map(|(sin, cos, up_m)| (0.002 * cos, 0.002 * sin, up_m + sensor_m));
        FloorLimits::new(&profile).floor_of(&ranges_m.map(|range_m| (range_m * 500.0) as u16), &profile)
    }

    #[test]
    fn foot_is_recognised_above_the_floor_rings() {
        let mut ranges_m = [0.0; SWEEP_RINGS];
        // The floor 0.9 m below, as the ring at −5° meets it.
        ranges_m[5] = 0.9 / 0.0872;
        assert_eq!(marks_of(0.9, ranges_m), 1 << 5);
        // 10.3 m away, too, and up to the ring at 11°.
        ranges_m[13] = 10.26 / 0.9816;
        assert_eq!(marks_of(0.9, ranges_m), 0);
        ranges_m[13] += 0.3;
        assert_eq!(marks_of(0.9, ranges_m), 1 << 5, "a wall farther back");
    }

    #[test]
    fn low_lidar_sees_floor_with_upward_rings() {
        // Something 4 cm high at 3.4 m, before which the floor was seen.
        let mut ranges_m = [0.0; SWEEP_RINGS];
        (ranges_m[7], ranges_m[8]) = (2.8, 3.4);
        assert_eq!(marks_of(0.05, ranges_m), 0b1_1000_0000);
        let profile = [(0.002, 0.0001, 0.2); SWEEP_RINGS];
        assert_eq!(FloorLimits::new(&profile).rings, SWEEP_RINGS, "rises less than the highest floor");
        let profile = [(0.002, 0.001, 0.2); SWEEP_RINGS];
        assert_eq!(FloorLimits::new(&profile).rings, 0, "rises more, from above it");
    }

    /// What the limits are to say, ring by ring, from heights and distances.
    fn by_definition(range_raw: &[u16; SWEEP_RINGS], profile: &RingProfile) -> u16 {
        let mut walk = FloorWalk::default();
        for (ring, (raw, line)) in range_raw.iter().zip(profile).enumerate() {
            let counts = f32::from(*raw);
            let (distance_m, height_m) = (counts * line.0, counts * line.1 + line.2);
            if *raw != 0 {
                let low = height_m <= HIGHEST_M + HIGHEST_SLOPE * distance_m;
                walk.step(counts, line, (low, 1 << ring));
            }
        }
        walk.floor
    }

    #[test]
    fn quick_check_is_equal_for_every_mounting() {
        let mut random = floorguard_types::random::Pcg32::new(7, 1);
        let (mut columns, mut differ) = (0_u32, 0);
        for sensor_m in [0.05, 0.15, 0.6, 0.9, 2.4] {
            for _ in 0..4_000 {
                let (tilt, up) = (random.uniform() * 0.3 - 0.15, libm::sqrtf(0.9));
                let profile = RingAngles::vlp16()
                    .rings
                    .map(|(sin, cos, _)| (0.002 * cos, 0.002 * (sin * up + cos * tilt), sensor_m));
                let floor_raw = profile.map(|(_, rise, origin_m)| (-origin_m / rise.min(-1.0e-5)) as u16);
                let range_raw = floor_raw.map(|raw| match random.next_u32() % 8 {
                    0 => 0,
                    1 | 2 => (random.next_u32() % 10_000) as u16,
                    3 => (raw / 16).saturating_mul(15),
                    _ => raw.saturating_add((random.next_u32() % 20) as u16),
                });
                columns += 1;
                let floor = FloorLimits::new(&profile).floor_of(&range_raw, &profile);
                differ += u32::from(floor != by_definition(&range_raw, &profile));
            }
        }
        // A return within a rounding of the limit may fall on either side.
        assert!(differ * 1_000 < columns, "{differ} of {columns} columns");
    }
}
