//! A lidar of unknown height that stands: its first whole sweep shows how high above the floor.

use floorguard_perception::people::{FloorHeight, RingAngles, SweepContext};
use floorguard_types::geometry::{Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::Sweep;

use super::floor_below::floor_below_m;
use crate::recordings::arguments::Tilt;

/// Height assumed while no sweep has shown a floor, metres (the FLOBOT layout).
pub const ASSUMED_HEIGHT_M: f32 = 0.8;
/// A first sweep that saw less of the turn than this began in the middle of a revolution, hundredths of a degree; a later
/// one that saw less than the second is of no use.
const WHOLE_CDEG: u32 = 30_000;
const USEFUL_CDEG: u32 = 6_000;

/// How the lidar of a capture is mounted, as far as it is known.
pub struct StandingLidar {
    tilt: Tilt,
    height_m: Option<f32>,
    sweeps_seen: u32,
}

impl StandingLidar {
    /// Tilted like that, at an unknown height.
    pub const fn new(tilt: Tilt) -> Self {
        Self { tilt, height_m: None, sweeps_seen: 0 }
    }

    /// Looks for the floor until a whole sweep has shown it.
    pub fn look(&mut self, sweep: &Sweep, angles: &RingAngles) {
        self.sweeps_seen = self.sweeps_seen.saturating_add(1);
        let least_cdeg = if self.sweeps_seen == 1 { WHOLE_CDEG } else { USEFUL_CDEG };
        if self.height_m.is_some() || covered_cdeg(sweep) < least_cdeg {
            return;
        }
        self.height_m = if self.tilt == Tilt::UPRIGHT {
            FloorHeight::estimate_m(sweep, angles)
        } else {
            floor_below_m(sweep, angles, &self.mounting(0.0))
        };
        if let Some(height_m) = self.height_m {
            say!("the floor lies {height_m:.2} m below the lidar (estimated from the first whole sweep)");
        }
    }

    /// Where it stands.
    pub fn context(&self) -> SweepContext {
        SweepContext {
            sensor_in_base: self.mounting(self.height_m.unwrap_or(ASSUMED_HEIGHT_M)),
            twist: Twist2::ZERO,
            base_in_odom: Pose2::default(),
        }
    }

    fn mounting(&self, height_m: f32) -> Transform3 {
        let place = Point3::new(0.0, 0.0, height_m);
        let Tilt { roll_deg, pitch_deg } = self.tilt;
        Transform3::from_mounting(place, roll_deg.to_radians(), pitch_deg.to_radians(), 0.0)
    }

    /// Says so where no floor was found.
    pub fn say_height(&self) {
        if self.height_m.is_none() {
            say!(
                "no sweep has shown the floor: the lidar is taken to be {ASSUMED_HEIGHT_M:.2} m above it, and what was found may be wrong"
            );
        }
    }
}

/// How much of the turn was measured.
fn covered_cdeg(sweep: &Sweep) -> u32 {
    let measured = sweep.used_columns().iter().filter(|column| column.measured);
    let mut sectors = [false; 360];
    for column in measured {
        if let Some(sector) = sectors.get_mut(usize::from(column.azimuth_cdeg / 100)) {
            *sector = true;
        }
    }
    sectors.iter().filter(|seen| **seen).count() as u32 * 100
}
