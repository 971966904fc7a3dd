//! A robot of plain geometry that answers late, rolls on and slips is brought onto a place.

use std::vec::Vec;

use super::*;
use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::random::Pcg32;

/// From command to command, seconds.
const PERIOD_S: f32 = 0.1;

/// A robot whose speeds follow its commands late, and whose wheels slip.
struct Rolling {
    pose: Pose2,
    twist: Twist2,
    random: Pcg32,
    /// Share by which it turns more than it should.
    pull: f32,
}

impl Rolling {
    fn drive(&mut self, wanted: Twist2) {
        for _ in 0..10 {
            let share = 0.1 * PERIOD_S / 0.15;
            self.twist.linear_mps += share * (wanted.linear_mps - self.twist.linear_mps);
            self.twist.angular_radps += share * (wanted.angular_radps - self.twist.angular_radps);
            let slip = 1.0 + 0.05 * (self.random.uniform() - 0.5);
            let turn_radps = self.twist.angular_radps * slip + self.pull * self.twist.linear_mps;
            self.pose = self.pose.after(Twist2 { angular_radps: turn_radps, ..self.twist }, 0.1 * PERIOD_S);
        }
    }
}

/// How it ends from a start, with the tries that failed.
fn docked(start: Pose2, (pull, bias_m): (f32, f32)) -> (DockStep, Pose2, u8) {
    let mut robot = Rolling { pose: start, twist: Twist2::ZERO, random: Pcg32::new(7, 1), pull };
    let mut approach = DockApproach::new(DockingConfig::DEFAULT);
    for period in 0..3_000 {
        // A sensor that is wrong by a millimetre, and at times by something else.
        let noise_m = 0.002 * (robot.random.uniform() - 0.5);
        let wrong_m = if period < 80 { bias_m } else { 0.0 };
        let seen =
            Pose2::new(robot.pose.x_m + noise_m, robot.pose.y_m - noise_m + wrong_m, robot.pose.heading_rad);
        match approach.step(seen) {
            DockStep::Drive(twist) => robot.drive(twist),
            end => return (end, robot.pose, approach.tries()),
        }
    }
    (DockStep::Drive(Twist2::ZERO), robot.pose, approach.tries())
}

fn is_met(pose: Pose2) -> bool {
    pose.x_m.abs() < 0.01 && pose.y_m.abs() < 0.01 && pose.heading_rad.abs() < 0.0175
}

#[test]
fn place_is_met_from_all_around() {
    let starts: Vec<Pose2> = (0..5_u8)
        .flat_map(|aside| (0..5_u8).map(move |turn| (f32::from(aside) - 2.0, f32::from(turn) - 2.0)))
        .map(|(aside, turn)| Pose2::new(-1.0, 0.05 * aside, 0.1 * turn))
        .collect();
    for start in starts {
        let (end, pose, tries) = docked(start, (0.02, 0.0));
        assert!(end == DockStep::Docked && is_met(pose) && tries <= 1, "{start:?}: {end:?} {pose:?} {tries}");
    }
}

/// What looked right from afar is 4 cm aside from near: the robot goes back and comes again.
#[test]
fn wrong_first_try_is_repeated() {
    let (end, pose, tries) = docked(Pose2::new(-0.9, 0.0, 0.0), (0.0, 0.04));
    assert!(end == DockStep::Docked && is_met(pose) && tries >= 1, "{end:?} {pose:?} {tries}");
}

/// Too far aside for the bends that it may make, from too near: it goes back first.
#[test]
fn start_beside_the_place_goes_back() {
    let (end, pose, tries) = docked(Pose2::new(-0.05, 0.2, 0.0), (0.0, 0.0));
    assert!(end == DockStep::Docked && is_met(pose) && tries >= 1, "{end:?} {pose:?} {tries}");
}

/// A place that moves away is not met: the tries end.
#[test]
fn tries_end() {
    let mut approach = DockApproach::new(DockingConfig::DEFAULT);
    let mut count = 0;
    loop {
        // Never where it should be, neither near nor far.
        let seen = Pose2::new(if count % 40 < 20 { 0.0 } else { -2.0 }, 0.05, 0.0);
        match approach.step(seen) {
            DockStep::Failed => break,
            DockStep::Docked => panic!("5 cm aside"),
            DockStep::Drive(_) => count += 1,
        }
        assert!(count < 5_000);
    }
    assert_eq!(approach.tries(), DockingConfig::DEFAULT.tries);
}

#[test]
fn nothing_moves_while_it_judges() {
    let mut approach = DockApproach::new(DockingConfig::DEFAULT);
    let mut stands = 0;
    loop {
        match approach.step(Pose2::new(0.0, 0.001, -0.004)) {
            DockStep::Drive(twist) => {
                assert_eq!(twist, Twist2::ZERO);
                stands += 1;
            }
            end => {
                assert_eq!(end, DockStep::Docked);
                break;
            }
        }
    }
    assert_eq!(stands, DockingConfig::DEFAULT.stands);
}
