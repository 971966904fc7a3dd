//! The nearest returns of a sweep, ring by ring and by cells of azimuth: fewer rays than returns, and none is farther than
//! what stands beside it.

use floorguard_types::geometry::Point3;
use floorguard_types::number::{count_f32, saturating_usize};

/// A return of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FanReturn {
    /// Ring, lowest first.
    pub ring: usize,
    /// The return in the sensor's frame.
    pub point_in_sensor: Point3,
    /// The return in the map.
    pub point_in_map: Point3,
    /// The sensor at the time of this return, in the map.
    pub sensor_in_map: Point3,
}

/// Nearest return of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FanCell {
    /// Distance, metres; 0 where nothing came back: unknown.
    pub range_m: f32,
    pub point_in_map: Point3,
    pub sensor_in_map: Point3,
}

impl FanCell {
    pub(super) const UNKNOWN: Self = Self {
        range_m: 0.0,
        point_in_map: Point3::new(0.0, 0.0, 0.0),
        sensor_in_map: Point3::new(0.0, 0.0, 0.0),
    };
}

/// One revolution: `RINGS` rings by `CELLS` cells of azimuth. 28 B a cell: 161 KiB for 16 × 360.
#[derive(Clone, Debug)]
pub struct SweepFan<const RINGS: usize, const CELLS: usize> {
    /// Elevation of each ring, ascending, radians.
    pub(super) elevations_rad: [f32; RINGS],
    pub(super) cells: [[FanCell; CELLS]; RINGS],
    /// Sweeps so far: says which of the rays are cast.
    pub(super) turns: u32,
    refused: u32,
}

impl<const RINGS: usize, const CELLS: usize> SweepFan<RINGS, CELLS> {
    /// An empty fan of a lidar whose rings have these elevations, lowest first, radians.
    #[must_use]
    pub const fn new(elevations_rad: [f32; RINGS]) -> Self {
        Self { elevations_rad, cells: [[FanCell::UNKNOWN; CELLS]; RINGS], turns: 0, refused: 0 }
    }

    /// Begins another sweep.
    pub fn clear(&mut self) {
        self.cells.iter_mut().for_each(|ring| ring.fill(FanCell::UNKNOWN));
        self.turns = self.turns.wrapping_add(1);
    }

    /// Enters a return; the nearest one of a cell stays. Another ring than there are, a distance ≤ 0 or one that is not
    /// finite is refused and counted.
    #[inline]
    pub fn enter(&mut self, each: FanReturn) {
        let Point3 { x_m, y_m, z_m } = each.point_in_sensor;
        let range_m = libm::sqrtf(x_m * x_m + y_m * y_m + z_m * z_m);
        let index = saturating_usize(turn_share(x_m, y_m) * count_f32(CELLS)).min(CELLS.saturating_sub(1));
        match self.cells.get_mut(each.ring).and_then(|ring| ring.get_mut(index)) {
            Some(cell) if range_m > 0.0 && range_m.is_finite() => {
                if cell.range_m <= 0.0 || range_m < cell.range_m {
                    let (point_in_map, sensor_in_map) = (each.point_in_map, each.sensor_in_map);
                    *cell = FanCell { range_m, point_in_map, sensor_in_map };
                }
            }
            _ => self.refused = self.refused.saturating_add(1),
        }
    }

    /// Returns that were refused.
    #[must_use]
    pub const fn refused(&self) -> u32 {
        self.refused
    }

    /// Width of a cell, radians.
    pub(super) fn cell_rad() -> f32 {
        core::f32::consts::TAU / count_f32(CELLS.max(1))
    }
}

/// Direction of a point as a share of a turn, 0 to 1, counter-clockwise from x; 10⁻⁵ rad exact (Abramowitz and Stegun 1964,
/// 4.4.49), which a cell of a degree does not notice and `atan2f` takes four times as long for.
#[inline]
pub(super) fn turn_share(x: f32, y: f32) -> f32 {
    let (across, along) = (libm::fabsf(y), libm::fabsf(x));
    let ratio = across.min(along) / across.max(along).max(f32::MIN_POSITIVE);
    let s = ratio * ratio;
    let angle =
        ratio * (0.999_866 + s * (-0.330_299_5 + s * (0.180_141 + s * (-0.085_133 + s * 0.020_835_1))));
    let share = angle * (1.0 / core::f32::consts::TAU);
    let eighth = if across > along { 0.25 - share } else { share };
    let half = if x < 0.0 { 0.5 - eighth } else { eighth };
    if y < 0.0 { 1.0 - half } else { half }
}

#[cfg(test)]
mod tests {
    use super::turn_share;

    #[test]
    fn shares_of_a_turn_agree_with_atan2() {
        for step in 0..3_600_u16 {
            let angle = f64::from(step) * std::f64::consts::TAU / 3_600.0;
            let share = turn_share(angle.cos() as f32 * 3.0, angle.sin() as f32 * 3.0);
            let away = (f64::from(share) - angle / std::f64::consts::TAU).abs();
            // 1 and 0 are the same direction.
            let is_near = !(1.0e-5..=1.0 - 1.0e-5).contains(&away);
            assert!(is_near, "{step}: {share}");
        }
    }
}
