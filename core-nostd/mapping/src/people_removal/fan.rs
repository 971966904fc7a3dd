//! The nearest returns of a sweep, ring by ring and by cells of azimuth: fewer rays than returns, and none is farther than
//! what stands beside it.

use floorguard_types::geometry::Point3;
use floorguard_types::number::{count_f32, nearest_f32, saturating_usize};

/// A return of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FanReturn {
    /// Ring, lowest first.
    pub ring: usize,
    /// Direction in the sensor's frame, counter-clockwise, radians.
    pub azimuth_rad: f32,
    /// Distance from the sensor, metres.
    pub range_m: f32,
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
    refused: u32,
}

impl<const RINGS: usize, const CELLS: usize> SweepFan<RINGS, CELLS> {
    /// An empty fan of a lidar whose rings have these elevations, lowest first, radians.
    #[must_use]
    pub const fn new(elevations_rad: [f32; RINGS]) -> Self {
        Self { elevations_rad, cells: [[FanCell::UNKNOWN; CELLS]; RINGS], refused: 0 }
    }

    /// Begins another sweep.
    pub fn clear(&mut self) {
        self.cells.iter_mut().for_each(|ring| ring.fill(FanCell::UNKNOWN));
    }

    /// Enters a return; the nearest one of a cell stays. Another ring than there are, a distance ≤ 0 or one that is not
    /// finite is refused and counted.
    #[inline]
    pub fn enter(&mut self, each: FanReturn) {
        let cell = self.cells.get_mut(each.ring).and_then(|ring| ring.get_mut(cell_of::<CELLS>(each.azimuth_rad)));
        match cell {
            Some(cell) if each.range_m > 0.0 && each.range_m.is_finite() => {
                if cell.range_m <= 0.0 || each.range_m < cell.range_m {
                    *cell = FanCell {
                        range_m: each.range_m,
                        point_in_map: each.point_in_map,
                        sensor_in_map: each.sensor_in_map,
                    };
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

/// The cell of an azimuth; turns are taken off.
#[inline]
fn cell_of<const CELLS: usize>(azimuth_rad: f32) -> usize {
    let turns = azimuth_rad * (1.0 / core::f32::consts::TAU);
    let within = turns - nearest_f32(super::free_space::floor(turns));
    // `within` may be rounded up to 1.
    saturating_usize(within * count_f32(CELLS)).min(CELLS.saturating_sub(1))
}
