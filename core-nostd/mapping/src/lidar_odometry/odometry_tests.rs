//! Drives through worlds of boxes, whose poses are exact.

use std::boxed::Box;
use std::vec::Vec;

use nalgebra::Vector3;

use super::super::filter::{Gaussian3, WheelSpeed};
use super::super::motion::{Pose3, Twist3};
use super::super::world::{Noise, PERIOD_S, World};
use super::*;

type Odometry = LidarOdometry<Box<[Bucket]>, 4096>;

fn odometry(config: OdometryConfig) -> Odometry {
    LidarOdometry::new(std::vec![Bucket::EMPTY; 1 << 10].into_boxed_slice(), config)
}

const TIMES: SweepTimes = SweepTimes { since_last_s: PERIOD_S, duration_s: PERIOD_S };

fn twist(forward_mps: f64, yaw_radps: f64) -> Twist3 {
    Twist3 {
        angular_radps: Vector3::new(0.0, 0.0, yaw_radps),
        linear_mps: Vector3::new(forward_mps, 0.0, 0.0),
    }
}

/// A drive: a velocity for each sweep, and what the odometry made of it.
struct Drive {
    truth: Vec<Pose3>,
    outcomes: Vec<SweepOutcome>,
}

impl Drive {
    fn run(
        world: &World,
        odometry: &mut Odometry,
        twists: &[Twist3],
        aid: &dyn Fn(&Twist3) -> MotionAid,
    ) -> Self {
        let mut noise = Noise::new(7);
        let mut pose = Pose3::identity();
        let mut drive = Self { truth: Vec::new(), outcomes: Vec::new() };
        for (index, twist) in twists.iter().enumerate() {
            if index > 0 {
                pose = pose.compose(&twist.over(PERIOD_S));
            }
            let sweep = world.sweep(&pose, twist, &mut noise);
            drive.truth.push(pose);
            drive.outcomes.push(odometry.push(&sweep, TIMES, &aid(twist)));
        }
        drive
    }

    /// Largest error of the place, metres.
    fn error_m(&self) -> f64 {
        let pairs = self.truth.iter().zip(&self.outcomes);
        pairs.map(|(truth, outcome)| (truth.place_m - outcome.state.pose.place_m).norm()).fold(0.0, f64::max)
    }
}

fn alone(_: &Twist3) -> MotionAid {
    MotionAid::default()
}

/// Starts in motion, speeds up, turns, and stops.
fn round_trip() -> Vec<Twist3> {
    let at = |index: u32| match index {
        0..10 => twist(0.5, 0.0),
        10..20 => twist(0.8, 0.6),
        20..30 => twist(0.4, -0.9),
        _ => twist(0.0, 0.0),
    };
    (0..36).map(at).collect()
}

#[test]
fn follows_a_drive_through_a_room() {
    let drive =
        Drive::run(&World::furnished(), &mut odometry(OdometryConfig::default()), &round_trip(), &alone);
    assert!(drive.error_m() < 0.012, "{}", drive.error_m());
    assert!(drive.outcomes.iter().skip(1).all(|outcome| !outcome.is_blind && outcome.misfit < 1.5));
    // The same with a constant velocity instead of returns: the error shows what the returns are worth.
    let mut config = OdometryConfig::default();
    config.align.matched_least = u32::MAX;
    let blind = Drive::run(&World::furnished(), &mut odometry(config), &round_trip(), &alone);
    assert!(blind.error_m() > 0.5, "{}", blind.error_m());
    assert!(blind.outcomes.iter().skip(1).all(|outcome| outcome.is_blind));
}

#[test]
fn the_same_sweeps_give_the_same_bits() {
    let poses = || {
        let mut odometry = odometry(OdometryConfig::default());
        let drive = Drive::run(&World::furnished(), &mut odometry, &round_trip()[..14], &alone);
        drive.outcomes.iter().map(|outcome| outcome.state).collect::<Vec<_>>()
    };
    assert_eq!(poses(), poses());
}

#[test]
fn standing_does_not_drift_and_creeping_is_followed() {
    let mut twists = std::vec![twist(0.0, 0.0); 20];
    twists.extend([twist(0.02, 0.0); 50]);
    let drive = Drive::run(&World::furnished(), &mut odometry(OdometryConfig::default()), &twists, &alone);
    let place = |index: usize| drive.outcomes[index].state.pose.place_m;
    assert!((place(19) - place(2)).norm() < 5.0e-4, "{}", place(19) - place(2));
    // Ten centimetres at two centimetres a second.
    let error = place(69) - drive.truth[69].place_m;
    assert!(error.norm() < 0.006, "{error}");
}

#[test]
fn doubt_grows_along_a_corridor_without_features() {
    let twists = std::vec![twist(0.6, 0.0); 40];
    let world = World::corridor();
    let config = OdometryConfig { floor: Some(FloorPrior::default()), ..OdometryConfig::default() };
    let drive = Drive::run(&world, &mut odometry(config), &twists, &alone);
    let along_m = |drive: &Drive, index: usize| {
        let outcome = &drive.outcomes[index];
        (outcome.drift.m44 + outcome.state.covariance.fixed_view::<1, 1>(3, 3).x).sqrt()
    };
    let held = drive.outcomes.iter().filter(|outcome| outcome.weak.is_held_by_prediction).count();
    let (early, late) = (along_m(&drive, 10), along_m(&drive, 39));
    assert!(held > 36 && late > 1.3 * early && late > 0.05, "{held} {early} {late}");
    let error = drive.outcomes[39].state.pose.place_m - drive.truth[39].place_m;
    assert!(error.x.abs() < 3.0 * late, "{error} {late}");
    assert!(error.y.abs() < 0.01 && error.z.abs() < 0.02, "{error}");
    // Wheels know how far it is.
    let narrow =
        |value: f64| Gaussian3 { mean: Vector3::new(value, 0.0, 0.0), deviation: Vector3::repeat(0.01) };
    let wheels = move |twist: &Twist3| MotionAid {
        wheels: Some(WheelSpeed { linear_mps: narrow(twist.linear_mps.x), angular_radps: narrow(0.0) }),
        gyroscope: None,
    };
    let drive = Drive::run(&world, &mut odometry(config), &twists, &wheels);
    assert!(drive.error_m() < 0.05, "{}", drive.error_m());
    assert!(along_m(&drive, 39) < 0.5 * late, "{} {late}", along_m(&drive, 39));
}

#[test]
fn sweep_without_returns_is_a_doubtful_prediction() {
    let world = World::furnished();
    let mut odometry = odometry(OdometryConfig::default());
    let twists = std::vec![twist(0.5, 0.0); 6];
    let before = *Drive::run(&world, &mut odometry, &twists, &alone).outcomes.last().unwrap();
    let blind = odometry.push(&[], TIMES, &MotionAid::default());
    assert!(blind.is_blind && !blind.is_mapped && blind.returns == 0);
    assert!(blind.weak.deviation_m > 2.0 * before.weak.deviation_m);
    let ahead = blind.state.pose.place_m - before.state.pose.place_m;
    assert!((ahead.x - 0.05).abs() < 0.005, "{ahead}");
}

#[test]
fn a_level_floor_holds_height_and_tilt() {
    let config = OdometryConfig { floor: Some(FloorPrior::default()), ..OdometryConfig::default() };
    let mut odometry = odometry(config);
    // Between two walls without floor and ceiling nothing else says how high the sensor is.
    let mut world = World::corridor();
    world.room[0].z = -100.0;
    world.room[1].z = 100.0;
    let drive = Drive::run(&world, &mut odometry, &std::vec![twist(0.3, 0.0); 30], &alone);
    let end = drive.outcomes[29].state;
    assert!(end.pose.place_m.z.abs() < 0.02, "{:?}", end.pose.place_m);
    let deviation = end.covariance.fixed_view::<1, 1>(5, 5).x.sqrt();
    assert!(deviation < 0.021, "{deviation}");
}

/// One packet of each revolution is lost, each time another one.
#[test]
fn lost_packets_change_the_pose_by_millimetres() {
    let world = World::furnished();
    let (mut whole, mut holed) = (odometry(OdometryConfig::default()), odometry(OdometryConfig::default()));
    let mut noise = Noise::new(3);
    let mut pose = Pose3::identity();
    for (index, twist) in (0_u16..).zip(round_trip()) {
        if index > 0 {
            pose = pose.compose(&twist.over(PERIOD_S));
        }
        let sweep = world.sweep(&pose, &twist, &mut noise);
        let lost = f32::from(index * 37 % 75);
        let kept = sweep.iter().filter(|each| libm::floorf(each.time_share * 75.0) != lost).copied();
        let kept: Vec<_> = kept.collect();
        assert!(kept.len() < sweep.len());
        let without = holed.push(&kept, TIMES, &MotionAid::default()).state.pose.place_m;
        let with = whole.push(&sweep, TIMES, &MotionAid::default()).state.pose.place_m;
        assert!((with - without).norm() < 0.005, "{index}: {with} {without}");
    }
}
