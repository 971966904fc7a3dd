//! Where the lidar could have seen a person: a track behind something, or in a sector without data, is not missed.

use super::clusters::{Obstacles, rings_of};
use crate::geometry::Point2;

/// Sectors of 2°.
const SECTORS: usize = 180;

/// Horizontal distance up to which each sector is open.
#[derive(Clone, Debug)]
pub(super) struct Visibility {
    /// Nearest and second nearest obstacle of the sector, counts of 2 mm: one stray return hides nothing.
    nearest: [[u16; 2]; SECTORS],
    measured: [u16; SECTORS],
}

impl Visibility {
    pub(super) const fn new() -> Self {
        Self { nearest: [[u16::MAX; 2]; SECTORS], measured: [0; SECTORS] }
    }

    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }

    /// A column was measured, with its obstacles.
    pub(super) fn column(&mut self, azimuth_cdeg: u16, obstacles: &Obstacles) {
        let sector = sector_of_cdeg(azimuth_cdeg);
        let (Some(count), Some(nearest)) = (self.measured.get_mut(sector), self.nearest.get_mut(sector))
        else {
            return;
        };
        *count = count.saturating_add(1);
        let [mut first, mut second] = *nearest;
        for ring in rings_of(obstacles.present) {
            let distance = obstacles.counts.get(ring).copied().unwrap_or(u16::MAX);
            second = second.min(first.max(distance));
            first = first.min(distance);
        }
        *nearest = [first, second];
    }

    /// A person at `point_in_sensor` (x forward, y left) could have been seen.
    pub(super) fn is_visible(&self, point_in_sensor: Point2) -> bool {
        let bearing_rad = libm::atan2f(-point_in_sensor.y_m, point_in_sensor.x_m);
        let cdeg = (bearing_rad * (18_000.0 / core::f32::consts::PI) + 36_000.0) as u32 % 36_000;
        let sector = sector_of_cdeg(cdeg as u16);
        let measured = self.measured.get(sector).copied().unwrap_or(0);
        let [_, nearest] = self.nearest.get(sector).copied().unwrap_or([0; 2]);
        // Farther than people are looked for is open.
        let open = nearest == u16::MAX || f32::from(nearest) * 0.002 > point_in_sensor.norm() - 0.6;
        measured > 2 && open
    }
}

fn sector_of_cdeg(azimuth_cdeg: u16) -> usize {
    usize::from(azimuth_cdeg) / 200 % SECTORS
}

const _: () = assert!(SECTORS * 200 == 36_000);
