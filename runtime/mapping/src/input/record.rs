//! A scan with its odometry.

use floorguard_types::geometry::Point2;

use crate::se2::Se2;

/// A scan of a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScanRecord {
    /// When its middle beam was measured, seconds on the clock of the log.
    pub time_s: f64,
    /// Scanner in the frame of the odometry; `None` without odometry.
    pub odometry: Option<Se2>,
    /// Angle of beam 0 in the scanner's frame, radians.
    pub first_angle_rad: f32,
    /// From beam to beam, radians, > 0.
    pub step_rad: f32,
    /// Metres; what is not finite or beyond the scanner's range says nothing.
    pub ranges_m: Vec<f32>,
    /// From beam to beam, seconds; 0 where it is not known, negative where beams run against the turning.
    pub between_s: f32,
    /// Motion of the scanner by odometry at that time, in its own frame, metres and radians a second; zero where it is not known.
    pub motion: Se2,
}

impl ScanRecord {
    /// The believed returns as points in the scanner's frame at its time, in the order of the beams: each is moved by the motion
    /// since its own.
    #[must_use]
    pub fn points(&self, least_m: f32, most_m: f32) -> Vec<Point2> {
        self.points_in_motion(least_m, most_m, self.motion)
    }

    /// The same with a motion that is known otherwise.
    #[must_use]
    pub fn points_in_motion(&self, least_m: f32, most_m: f32, motion: Se2) -> Vec<Point2> {
        let middle = 0.5 * self.ranges_m.len().saturating_sub(1) as f32;
        let motion = motion.single();
        // Within a scan a motion is straight to less than a millimetre: 30 ms at 1 m/s and 1 rad/s bend by 0.5 mm.
        let beam = |(index, range): (usize, &f32)| {
            let later_s = (index as f32 - middle) * self.between_s;
            let turned_rad = later_s * motion.heading_rad;
            let (sin, cos) = libm::sincosf(self.first_angle_rad + index as f32 * self.step_rad + turned_rad);
            Point2::new(range * cos + later_s * motion.x_m, range * sin + later_s * motion.y_m)
        };
        let believed = |item: &(usize, &f32)| (least_m..=most_m).contains(item.1);
        self.ranges_m.iter().enumerate().filter(believed).map(beam).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scanner that drives and turns within a round room sees it crooked; seen from where it was in the middle it is round.
    #[test]
    fn scan_in_motion_is_straightened() {
        const BEAMS: usize = 541;
        const BETWEEN_S: f64 = 55.5e-6;
        const ROOM_M: f64 = 4.0;
        let motion = Se2::new(1.2, -0.3, 1.5);
        let (first_angle_rad, step_rad) = (-2.356_194_5_f32, 0.008_726_646_f32);
        let range = |index: usize| {
            // Exactly, along the arc: the scanner's pose at the beam, seen from the pose of the middle.
            let later_s = (index as f64 - 270.0) * BETWEEN_S;
            let turned = motion.heading_rad * later_s;
            let along = [turned.sin() / motion.heading_rad, (1.0 - turned.cos()) / motion.heading_rad];
            let x_m = motion.x_m * along[0] - motion.y_m * along[1];
            let y_m = motion.x_m * along[1] + motion.y_m * along[0];
            let angle = f64::from(first_angle_rad) + index as f64 * f64::from(step_rad) + turned;
            let ahead = x_m * angle.cos() + y_m * angle.sin();
            ((ahead * ahead - x_m * x_m - y_m * y_m + ROOM_M * ROOM_M).sqrt() - ahead) as f32
        };
        let scan = ScanRecord {
            first_angle_rad,
            step_rad,
            ranges_m: (0..BEAMS).map(range).collect(),
            between_s: BETWEEN_S as f32,
            motion,
            ..ScanRecord::default()
        };
        let worst_m = |points: Vec<Point2>| {
            let off = |point: &Point2| (f64::from(point.x_m).hypot(f64::from(point.y_m)) - ROOM_M).abs();
            assert_eq!(points.len(), BEAMS);
            points.iter().map(off).fold(0.0, f64::max)
        };
        assert!(worst_m(scan.points(0.1, 30.0)) < 0.000_2);
        assert!(worst_m(scan.points_in_motion(0.1, 30.0, Se2::default())) > 0.015);
    }
}
