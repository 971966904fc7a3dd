//! How high a sensor of unknown mounting stands above the floor: for recordings without a description.

use floorguard_types::number::{nearest_f32, saturating_usize};
use floorguard_types::profile::Profile;
use floorguard_types::sensing::SweepOf;

use super::projection::RingAngles;

const BIN_M: f32 = 0.04;
/// Heights from 0.2 m to 2.76 m.
const BINS: usize = 64;
const LOWEST_M: f32 = 0.2;
/// Rings that look at the floor near a robot: below −3°.
const RINGS: usize = 6;

/// Estimates the height from the returns below the horizon.
#[derive(Clone, Copy, Debug)]
pub struct FloorHeight;

impl FloorHeight {
    /// Metres from the floor to the sensor: the lowest of the fullest layers. `None` if fewer than 200 returns look
    /// like a floor. Assumes that the sensor stands upright.
    #[must_use]
    pub fn estimate_m<P: Profile>(sweep: &SweepOf<P>, angles: &RingAngles) -> Option<f32> {
        let mut counts = [0_u32; BINS];
        let metres_per_count = f32::from(sweep.range_unit_mm) * 1.0e-3;
        for column in sweep.used_columns().iter().filter(|column| column.measured) {
            for (raw, (sin, _, _)) in column.range_raw.iter().zip(&angles.rings).take(RINGS) {
                let depth_m = -f32::from(*raw) * metres_per_count * sin;
                let bin = libm::floorf((depth_m - LOWEST_M) / BIN_M);
                if bin >= 0.0
                    && let Some(count) = counts.get_mut(saturating_usize(bin))
                {
                    *count = count.saturating_add(1);
                }
            }
        }
        let fullest = counts.iter().copied().max().unwrap_or(0);
        if fullest < 200 {
            return None;
        }
        // The floor is the deepest layer that is nearly as full as the fullest: a shelf may be fuller, not deeper.
        let bin = counts.iter().rposition(|count| *count >= fullest / 2)?;
        Some(LOWEST_M + (nearest_f32(bin) + 0.5) * BIN_M)
    }
}
