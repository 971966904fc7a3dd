//! What wheels and gyroscope of a recording say about the motion of its lidar.

use floorguard_mapping::lidar_odometry::{Gaussian3, MotionAid, Pose3, WheelSpeed};
use nalgebra::{Matrix3, Vector3};

use crate::recordings::FrameTree;
use floorguard_mapping_host::input::OdometryTrack;

/// Deviation of the speed by the wheels: so much, and this share of it, m/s.
const WHEELS_MPS: [f64; 2] = [0.02, 0.03];
/// Deviation of the turning rate by the wheels, of roll and pitch too, rad/s.
const WHEELS_RADPS: f64 = 0.05;
/// Deviation of a gyroscope whose bias was seen at rest, and of one whose bias was not, rad/s.
const GYROSCOPE_RADPS: [f64; 2] = [0.003, 0.01];
/// The robot stands below this speed, m/s and rad/s...
const STANDS: f64 = 1.0e-3;
/// ... and its bias is believed after so many samples.
const STANDING_SAMPLES: usize = 50;
/// Fewer samples during a sweep say too little.
const SAMPLES_LEAST: usize = 3;

/// A sample of a gyroscope in its own axes.
#[derive(Clone, Copy, Debug)]
pub struct GyroscopeSample {
    /// On the clock of the recording.
    pub time_s: f64,
    /// About its axes, rad/s.
    pub rate_radps: Vector3<f64>,
}

/// Wheels and gyroscope over time, with where they are mounted.
#[derive(Debug, Default)]
pub struct Aids {
    odometry: OdometryTrack,
    gyroscope: Vec<GyroscopeSample>,
    bias_radps: Option<Vector3<f64>>,
    lidar_in_robot: Option<Pose3>,
    gyroscope_in_lidar: Option<Matrix3<f64>>,
}

/// What was found of them.
#[derive(Debug, Default)]
pub struct AidsFound {
    /// Poses of the robot by its wheels.
    pub odometry: OdometryTrack,
    /// In order of time.
    pub gyroscope: Vec<GyroscopeSample>,
    /// Frames of the recording.
    pub frames: FrameTree,
    /// Frame of the gyroscope.
    pub gyroscope_frame: String,
}

impl Aids {
    /// For the lidar whose returns are in this frame. What cannot be placed is left out, and `notes` says so.
    pub fn new(found: AidsFound, lidar_frame: &str, notes: &mut Vec<String>) -> Self {
        let mounted = |frame: &str| found.frames.mounting(frame).map(|mounting| pose(&mounting));
        let lidar_in_robot = mounted(lidar_frame);
        let gyroscope = mounted(&found.gyroscope_frame);
        if lidar_in_robot.is_none() && !found.odometry.is_empty() {
            notes.push(format!("no frame tells where {lidar_frame} is mounted: the wheels are not used"));
        }
        let gyroscope_in_lidar = lidar_in_robot
            .zip(gyroscope)
            .map(|(lidar, gyroscope)| lidar.rotation.transpose() * gyroscope.rotation);
        if gyroscope_in_lidar.is_none() && !found.gyroscope.is_empty() {
            notes.push("no frame tells where the gyroscope is mounted: it is not used".to_owned());
        }
        let mut aids = Self {
            odometry: found.odometry,
            gyroscope: found.gyroscope,
            bias_radps: None,
            lidar_in_robot,
            gyroscope_in_lidar,
        };
        aids.bias_radps = aids.bias();
        aids
    }

    /// Whether wheels, and whether a gyroscope, can help.
    pub fn are_there(&self) -> [bool; 2] {
        [
            self.lidar_in_robot.is_some() && !self.odometry.is_empty(),
            self.gyroscope_in_lidar.is_some() && !self.gyroscope.is_empty(),
        ]
    }

    /// The mean rate while the wheels stood.
    fn bias(&self) -> Option<Vector3<f64>> {
        let stood = |sample: &&GyroscopeSample| {
            let speed = self.odometry.speed_at(sample.time_s);
            speed.is_some_and(|[linear, angular]| linear < STANDS && angular < STANDS)
        };
        let standing: Vec<_> = self.gyroscope.iter().filter(stood).collect();
        let sum: Vector3<f64> = standing.iter().map(|sample| sample.rate_radps).sum();
        (standing.len() >= STANDING_SAMPLES).then(|| sum / standing.len() as f64)
    }

    /// What they say about the time between two instants.
    pub fn during(&self, start_s: f64, end_s: f64) -> MotionAid {
        MotionAid { wheels: self.wheels(start_s, end_s), gyroscope: self.rate(start_s, end_s) }
    }

    fn wheels(&self, start_s: f64, end_s: f64) -> Option<WheelSpeed> {
        let mounting = self.lidar_in_robot?;
        let motion = self.odometry.at(start_s)?.between(self.odometry.at(end_s)?);
        let duration_s = (end_s - start_s).max(1.0e-3);
        // The motion is an arc: seen from its middle it is straight.
        let (sin, cos) = libm::sincos(-0.5 * motion.heading_rad);
        let ahead =
            Vector3::new(cos * motion.x_m - sin * motion.y_m, sin * motion.x_m + cos * motion.y_m, 0.0);
        let turn = Vector3::new(0.0, 0.0, motion.heading_rad / duration_s);
        let back = mounting.rotation.transpose();
        let linear = back * (ahead / duration_s + turn.cross(&mounting.place_m));
        let [least, share] = WHEELS_MPS;
        let deviation = least + share * linear.norm();
        Some(WheelSpeed {
            linear_mps: Gaussian3 { mean: linear, deviation: Vector3::repeat(deviation) },
            angular_radps: Gaussian3 { mean: back * turn, deviation: Vector3::repeat(WHEELS_RADPS) },
        })
    }

    fn rate(&self, start_s: f64, end_s: f64) -> Option<Gaussian3> {
        let turn = self.gyroscope_in_lidar?;
        let first = self.gyroscope.partition_point(|sample| sample.time_s < start_s);
        let last = self.gyroscope.partition_point(|sample| sample.time_s <= end_s);
        let during = self.gyroscope.get(first..last)?;
        if during.len() < SAMPLES_LEAST {
            return None;
        }
        let sum: Vector3<f64> = during.iter().map(|sample| sample.rate_radps).sum();
        let [known, unknown] = GYROSCOPE_RADPS;
        let deviation = if self.bias_radps.is_some() { known } else { unknown };
        let mean = turn * (sum / during.len() as f64 - self.bias_radps.unwrap_or_default());
        Some(Gaussian3 { mean, deviation: Vector3::repeat(deviation) })
    }
}

fn pose(mounting: &floorguard_types::geometry::Transform3) -> Pose3 {
    let r = mounting.rotation.map(|row| row.map(f64::from));
    let t = mounting.translation;
    Pose3 {
        rotation: Matrix3::from_fn(|row, column| r[row][column]),
        place_m: Vector3::new(t.x_m, t.y_m, t.z_m).map(f64::from),
    }
}

#[cfg(test)]
mod tests {
    use floorguard_mapping_host::Se2;
    use floorguard_recording::decode::{Frame, Header};
    use floorguard_types::geometry::{Point3, Transform3};
    use floorguard_types::time::Stamp;

    use super::*;

    /// A robot that turns left about its middle; its lidar is 0.5 m ahead and looks to the left.
    #[test]
    fn speeds_are_those_of_the_lidar() {
        let rotation = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let mut found = AidsFound { gyroscope_frame: "imu".to_owned(), ..AidsFound::default() };
        for (child, rotation) in [("lidar", rotation), ("imu", Transform3::IDENTITY.rotation)] {
            let translation = Point3::new(0.5, 0.0, 0.8);
            let header = Header { stamp: Stamp::from_micros(0), frame: "base_link".to_owned() };
            let transform = Transform3 { translation, rotation };
            found.frames.enter(&Frame { header, child: child.to_owned(), transform });
        }
        for step in 0..200 {
            let time_s = 0.01 * f64::from(step);
            let turned = (time_s - 1.0).max(0.0);
            found.odometry.push(time_s, Se2::new(0.0, 0.0, 0.8 * turned));
            let rate = Vector3::new(0.01, 0.02, 0.03 + if turned > 0.0 { 0.8 } else { 0.0 });
            found.gyroscope.push(GyroscopeSample { time_s, rate_radps: rate });
        }
        let mut notes = Vec::new();
        let aids = Aids::new(found, "lidar", &mut notes);
        assert_eq!((aids.are_there(), notes.len()), ([true, true], 0));
        let aid = aids.during(1.2, 1.3);
        let wheels = aid.wheels.unwrap();
        // 0.8 rad/s at 0.5 m: 0.4 m/s to the left of the robot, which is ahead for the lidar.
        assert!((wheels.linear_mps.mean - Vector3::new(0.4, 0.0, 0.0)).norm() < 1.0e-3, "{wheels:?}");
        assert!((wheels.angular_radps.mean - Vector3::new(0.0, 0.0, 0.8)).norm() < 1.0e-6);
        let rate = aid.gyroscope.unwrap();
        assert!((rate.mean - Vector3::new(0.0, 0.0, 0.8)).norm() < 1.0e-6, "without its bias: {rate:?}");
        let unknown = Aids::new(AidsFound::default(), "lidar", &mut notes).during(1.2, 1.3);
        assert!(unknown.wheels.is_none() && unknown.gyroscope.is_none());
    }
}
