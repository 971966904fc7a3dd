//! Where the lidar could have seen a person: a track behind something, or in a sector without data, is not missed.

use crate::geometry::Point2;

/// Sectors of 2°.
const SECTORS: usize = 180;

/// Horizontal distance up to which each sector is open.
#[derive(Clone, Debug)]
pub(super) struct Visibility {
    /// Second nearest obstacle of the sector, metres: one stray return hides nothing. 0 = not measured.
    nearest_m: [[f32; 2]; SECTORS],
    measured: [u16; SECTORS],
}

impl Visibility {
    pub(super) const fn new() -> Self {
        Self { nearest_m: [[f32::INFINITY; 2]; SECTORS], measured: [0; SECTORS] }
    }

    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }

    /// A column was measured.
    pub(super) fn column(&mut self, azimuth_cdeg: u16) {
        if let Some(count) = self.measured.get_mut(sector_of_cdeg(azimuth_cdeg)) {
            *count = count.saturating_add(1);
        }
    }

    /// An obstacle in a column.
    pub(super) fn obstacle(&mut self, azimuth_cdeg: u16, distance_m: f32) {
        if let Some([first, second]) = self.nearest_m.get_mut(sector_of_cdeg(azimuth_cdeg)) {
            if distance_m < *first {
                (*first, *second) = (distance_m, *first);
            } else if distance_m < *second {
                *second = distance_m;
            }
        }
    }

    /// A person at `point_in_sensor` (x forward, y left) could have been seen.
    pub(super) fn is_visible(&self, point_in_sensor: Point2) -> bool {
        let bearing_rad = libm::atan2f(-point_in_sensor.y_m, point_in_sensor.x_m);
        let cdeg = (bearing_rad * (18_000.0 / core::f32::consts::PI) + 36_000.0) as u32 % 36_000;
        let sector = sector_of_cdeg(cdeg as u16);
        let measured = self.measured.get(sector).copied().unwrap_or(0);
        let [_, nearest_m] = self.nearest_m.get(sector).copied().unwrap_or([0.0; 2]);
        measured > 2 && nearest_m > point_in_sensor.norm() - 0.6
    }
}

fn sector_of_cdeg(azimuth_cdeg: u16) -> usize {
    usize::from(azimuth_cdeg) / 200 % SECTORS
}

const _: () = assert!(SECTORS * 200 == 36_000);
