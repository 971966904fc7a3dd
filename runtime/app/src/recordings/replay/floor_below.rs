//! How high a lidar stands above the floor, whatever its tilt: by the layer of returns below it.

use floorguard_perception::people::RingAngles;
use floorguard_types::geometry::{Point3, Transform3};
use floorguard_types::sensing::Sweep;
use floorguard_types::units::centidegrees_to_radians;

const LAYER_M: f32 = 0.04;
const LOWEST_M: f32 = 0.2;
/// Heights from 0.2 m to 3.4 m.
const LAYERS: usize = 80;
/// Returns farther away than this, along the floor, say little: a degree of tilt is 0.3 m there.
const FAR_M: f32 = 15.0;
/// Fewer returns are no floor.
const RETURNS_MIN: u32 = 200;

/// Metres from the floor up to the sensor, by the rotation of its mounting: the lowest of the fullest layers. `None` if
/// too few returns lie below it.
pub fn floor_below_m(sweep: &Sweep, angles: &RingAngles, mounting: &Transform3) -> Option<f32> {
    let upright = Transform3 { translation: Point3::new(0.0, 0.0, 0.0), ..*mounting };
    let metres_per_count = f32::from(sweep.range_unit_mm) * 1.0e-3;
    let mut counts = [0_u32; LAYERS];
    for column in sweep.used_columns().iter().filter(|column| column.measured) {
        let (sin, cos) = libm::sincosf(centidegrees_to_radians(column.azimuth_cdeg));
        for (raw, (up, level, _)) in column.range_raw.iter().zip(&angles.rings) {
            let range_m = f32::from(*raw) * metres_per_count;
            let level_m = range_m * level;
            let point = upright.transform(Point3::new(level_m * cos, -level_m * sin, range_m * up));
            let layer = libm::floorf((-point.z_m - LOWEST_M) / LAYER_M);
            if *raw > 0
                && level_m < FAR_M
                && layer >= 0.0
                && let Some(count) = counts.get_mut(layer as usize)
            {
                *count += 1;
            }
        }
    }
    // A floor that falls between two layers counts in both.
    let pairs = counts.windows(2).map(|pair| pair.iter().sum::<u32>());
    let fullest = pairs.clone().max().filter(|fullest| *fullest >= RETURNS_MIN)?;
    let from = pairs.collect::<Vec<_>>().iter().rposition(|count| *count >= fullest * 3 / 4)?;
    let (low, high) = (counts.get(from)?, counts.get(from + 1)?);
    let share = *high as f32 / (*low + *high).max(1) as f32;
    Some(LOWEST_M + (from as f32 + 0.5 + share) * LAYER_M)
}
