//! Where the robot was at the time of a picture: between two poses, not the most recent one.

use floorguard_types::geometry::{Pose2, wrap_angle};
use floorguard_types::time::{Age, Stamp};

/// A pose with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedPose {
    /// When.
    pub stamp: Stamp,
    /// Where, in the map.
    pub pose_in_map: Pose2,
}

/// Poses farther apart say nothing about the time between, microseconds.
const GAP_MAX_US: u64 = 500_000;

/// The pose at a time between two others (both ends count), along the chord and with the shorter turn. `None` outside, and
/// where the poses lie more than half a second apart.
///
/// ```
/// use floorguard_mapping::people_removal::{StampedPose, pose_at};
/// use floorguard_types::geometry::Pose2;
/// use floorguard_types::time::Stamp;
///
/// let at = |micros, x_m, heading_rad| StampedPose {
///     stamp: Stamp::from_micros(micros),
///     pose_in_map: Pose2::new(x_m, 0.0, heading_rad),
/// };
/// // Turning over the back: from 3.1 rad to −3.1 rad is 0.083 rad, not 6.2.
/// let between = pose_at([at(0, 1.0, 3.1), at(100_000, 2.0, -3.1)], Stamp::from_micros(50_000)).unwrap();
/// assert!((between.x_m - 1.5).abs() < 1.0e-6 && between.heading_rad.abs() > 3.14);
/// assert_eq!(pose_at([at(0, 1.0, 0.0), at(100_000, 2.0, 0.0)], Stamp::from_micros(100_001)), None);
/// ```
#[must_use]
pub fn pose_at(around: [StampedPose; 2], at: Stamp) -> Option<Pose2> {
    let [before, after] = around;
    let (Age::Past(gap_us), Age::Past(_), Age::Past(_)) =
        (before.stamp.age(after.stamp), before.stamp.age(at), at.age(after.stamp))
    else {
        return None;
    };
    if gap_us > GAP_MAX_US {
        return None;
    }
    let gap_s = after.stamp.seconds_since(before.stamp);
    let share = if gap_us == 0 { 0.0 } else { at.seconds_since(before.stamp) / gap_s };
    let (from, to) = (before.pose_in_map, after.pose_in_map);
    let turn_rad = wrap_angle(to.heading_rad - from.heading_rad);
    Some(Pose2::new(
        from.x_m + share * (to.x_m - from.x_m),
        from.y_m + share * (to.y_m - from.y_m),
        from.heading_rad + share * turn_rad,
    ))
}
