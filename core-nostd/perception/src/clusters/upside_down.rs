//! A lidar on its head, turned over before its sweeps are used: rings from the lowest to the highest, azimuths
//! clockwise seen from above.
//!
//! Turned over about its forward axis, a point (x, y, z) of the sensor's frame becomes (x, −y, −z): azimuth a becomes −a,
//! elevation e becomes −e, and the lowest ring becomes the highest.

use super::projection::RingAngles;
use floorguard_types::geometry::Transform3;
use floorguard_types::profile::Profile;
use floorguard_types::sensing::SweepOf;

/// A rotation that is off by rounding alone is taken for none.
const ROUNDING: f32 = 1.0e-6;
const TURN_CDEG: u16 = 36_000;

/// The lidar's own up points down.
#[must_use]
pub fn hangs(sensor_in_base: &Transform3) -> bool {
    let [.., [_, _, up]] = sensor_in_base.rotation;
    up < 0.0
}

/// The mounting of the same lidar turned over.
///
/// ```
/// use floorguard_perception::people::{hangs, turned_over_mounting};
/// use floorguard_types::geometry::{Point3, Transform3};
///
/// let hanging = Transform3::from_mounting(Point3::new(0.0, 0.0, 2.2), core::f32::consts::PI, 0.0, 0.0);
/// assert!(hangs(&hanging));
/// let upright = turned_over_mounting(&hanging);
/// assert_eq!(upright.rotation, Transform3::IDENTITY.rotation);
/// ```
#[must_use]
pub fn turned_over_mounting(sensor_in_base: &Transform3) -> Transform3 {
    let exact = |value: f32| if value.abs() < ROUNDING { 0.0 } else { value };
    let rotation = sensor_in_base.rotation.map(|[x, y, z]| [exact(x), exact(-y), exact(-z)]);
    Transform3 { rotation, ..*sensor_in_base }
}

impl RingAngles {
    /// Of the same lidar turned over.
    #[must_use]
    pub fn turned_over(&self) -> Self {
        let mut turned = Self::NONE;
        for (to, (sin, cos, height_m)) in turned.rings.iter_mut().zip(self.rings.iter().rev()) {
            *to = (-sin, *cos, -height_m);
        }
        turned
    }
}

/// Turns a sweep over. The columns stay in the order of their time, so that their azimuth falls. Linear in the cells.
pub fn turn_over<P: Profile>(sweep: &mut SweepOf<P>) {
    let used = sweep.column_count;
    for column in sweep.columns.iter_mut().take(used) {
        column.azimuth_cdeg = TURN_CDEG.saturating_sub(column.azimuth_cdeg) % TURN_CDEG;
        let (ranges, reflectivities) = (column.range_raw, column.reflectivity);
        for (to, from) in column.range_raw.iter_mut().zip(ranges.iter().rev()) {
            *to = *from;
        }
        for (to, from) in column.reflectivity.as_mut().iter_mut().zip(reflectivities.as_ref().iter().rev()) {
            *to = *from;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::SweepFrame;
    use floorguard_types::geometry::{Point3, Twist2};
    use floorguard_types::sensing::Sweep;

    /// Every cell lies where it lay.
    #[test]
    fn turned_over_points_stay_in_their_places() {
        let mut sweep = std::boxed::Box::new(Sweep::EMPTY);
        sweep.column_count = 1_800;
        for (index, column) in sweep.columns.iter_mut().take(1_800).enumerate() {
            (column.azimuth_cdeg, column.measured) = ((20 * index) as u16, true);
            column.range_raw = core::array::from_fn(|ring| (1_000 + 100 * ring + index) as u16);
        }
        let (angles, place) = (RingAngles::vlp16(), Point3::new(0.3, -0.2, 2.2));
        let mounting = Transform3::from_mounting(place, core::f32::consts::PI, 0.1, 0.7);
        let before = sweep.clone();
        turn_over(&mut sweep);
        let (turned, upright) = (angles.turned_over(), turned_over_mounting(&mounting));
        let frames = [
            SweepFrame::new(&before, &mounting, Twist2::ZERO),
            SweepFrame::new(&sweep, &upright, Twist2::ZERO),
        ];
        for (was, is) in before.used_columns().iter().zip(sweep.used_columns()).step_by(37) {
            let columns = [frames[0].column(was), frames[1].column(is)];
            for ring in 0..16 {
                let a = columns[0].point(was.range_raw[ring], angles.rings[ring]);
                let b = columns[1].point(is.range_raw[15 - ring], turned.rings[15 - ring]);
                let apart_m = (a.x_m - b.x_m).abs() + (a.y_m - b.y_m).abs() + (a.z_m - b.z_m).abs();
                assert!(apart_m < 1.0e-3, "{a:?} {b:?}");
            }
        }
    }
}
