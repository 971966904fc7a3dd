//! The returns of a sweep as points, for stages that need more than clusters of them.

use floorguard_types::geometry::{Point3, Transform3, Twist2};
use floorguard_types::profile::Profile;
use floorguard_types::sensing::SweepOf;

use super::projection::{RingAngles, SweepFrame};

/// A return with the place of the lidar when it was measured, in the robot's frame at the end of the sweep, z above the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenReturn {
    /// The lidar.
    pub sensor_in_base: Point3,
    /// The return.
    pub end_in_base: Point3,
}

/// The returns of one column in `interval`, in the order of measurement, with the motion during the sweep taken out.
pub fn returns_in_base<'a, P: Profile>(
    sweep: &'a SweepOf<P>,
    (sensor_in_base, twist): (&Transform3, Twist2),
    angles: &'a RingAngles,
    interval: usize,
) -> impl Iterator<Item = SeenReturn> + 'a {
    let frames = SweepFrame::new(sweep, sensor_in_base, twist);
    sweep.used_columns().iter().step_by(interval.max(1)).flat_map(move |column| {
        let frame = frames.column(column);
        let rings = column.range_raw.iter().zip(&angles.rings);
        rings.filter(|(raw, _)| **raw != 0).map(move |(raw, angles)| SeenReturn {
            sensor_in_base: frame.sensor(),
            end_in_base: frame.point(*raw, *angles),
        })
    })
}
