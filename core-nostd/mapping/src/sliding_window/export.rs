//! The plan as an occupancy grid, as `grid_map` converts a layer.
//!
//! `grid_map` (`GridMapRosConverter::toOccupancyGrid`): (v − lower) / (upper − lower) as percent, cut at both ends, towards
//! zero; −1 where nothing is known. Its own cells begin at the largest coordinates and run along decreasing x first, and
//! the conversion reverses them. Our cells begin at the smallest coordinates, so the order of the message is ours.

use floorguard_types::number::saturating_i8;
use floorguard_types::time::Stamp;

use super::plan::{Plan, PlanCell};
use crate::GRID_CELLS_MAX;

/// Occupied and free, percent; unknown is −1.
const OCCUPIED: i8 = 100;
const FREE: i8 = 0;
const UNKNOWN: i8 = -1;

/// How a height becomes a percentage.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OccupancyScale {
    /// From 0 at `lower_m` to 100 at `upper_m`. Where both are equal: 100 above 0 m, else 0.
    Scaled {
        /// Metres.
        lower_m: f32,
        /// Metres.
        upper_m: f32,
    },
    /// 100 above a step that the robot cannot climb, else 0 (Dalmedico et al. 2019: maximum elevation step).
    Step {
        /// Metres.
        step_m: f32,
    },
}

impl OccupancyScale {
    /// A step of 5 cm.
    pub const PUBLISHED: Self = Self::Step { step_m: 0.05 };

    /// Percent of a height; −1 for a height that is not known or not a number.
    ///
    /// ```
    /// use floorguard_mapping::sliding_window::OccupancyScale;
    ///
    /// let scale = OccupancyScale::Scaled { lower_m: 0.0, upper_m: 0.5 };
    /// assert_eq!([Some(0.25), Some(9.0), Some(-1.0), None].map(|height| scale.percent(height)), [50, 100, 0, -1]);
    /// assert_eq!(OccupancyScale::PUBLISHED.percent(Some(0.06)), 100);
    /// ```
    #[must_use]
    pub fn percent(&self, height_m: Option<f32>) -> i8 {
        let Some(height_m) = height_m.filter(|height_m| !height_m.is_nan()) else { return UNKNOWN };
        match *self {
            Self::Scaled { lower_m, upper_m } => {
                let range_m = upper_m - lower_m;
                if libm::fabsf(range_m) > f32::EPSILON {
                    saturating_i8(((height_m - lower_m) / range_m).clamp(0.0, 1.0) * f32::from(OCCUPIED))
                } else if height_m > 0.0 {
                    OCCUPIED
                } else {
                    FREE
                }
            }
            Self::Step { step_m } => {
                if height_m > step_m {
                    OCCUPIED
                } else {
                    FREE
                }
            }
        }
    }
}

impl<S: AsRef<[PlanCell]> + AsMut<[PlanCell]>> Plan<S> {
    /// Writes the floor as an occupancy grid (ROS `nav_msgs/OccupancyGrid`: x first, from the smallest coordinates), places
    /// of people as occupied. Returns how many cells were written: fewer than the plan has if `out` is shorter.
    pub fn export(&self, scale: OccupancyScale, now: Stamp, out: &mut [i8]) -> usize {
        let mut written = 0_usize;
        for (cell, percent) in self.grid().values().iter().zip(out).take(GRID_CELLS_MAX) {
            *percent = if cell.is_person(now) { OCCUPIED } else { scale.percent(cell.floor_m()) };
            written = written.saturating_add(1);
        }
        written
    }
}
