//! A scan with its odometry.

use floorguard_types::geometry::Point2;

use crate::se2::Se2;

/// A scan of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanRecord {
    /// Seconds, on the clock of the log.
    pub time_s: f64,
    /// Scanner in the frame of the odometry; `None` without odometry.
    pub odometry: Option<Se2>,
    /// Angle of beam 0 in the scanner's frame, radians.
    pub first_angle_rad: f32,
    /// From beam to beam, radians, > 0.
    pub step_rad: f32,
    /// Metres; what is not finite or beyond the scanner's range says nothing.
    pub ranges_m: Vec<f32>,
}

impl ScanRecord {
    /// The believed returns as points in the scanner's frame, in the order of the beams.
    #[must_use]
    pub fn points(&self, least_m: f32, most_m: f32) -> Vec<Point2> {
        let beam = |(index, range): (usize, &f32)| {
            let (sin, cos) = libm::sincosf(self.first_angle_rad + index as f32 * self.step_rad);
            Point2::new(range * cos, range * sin)
        };
        let believed = |item: &(usize, &f32)| (least_m..=most_m).contains(item.1);
        self.ranges_m.iter().enumerate().filter(believed).map(beam).collect()
    }
}
