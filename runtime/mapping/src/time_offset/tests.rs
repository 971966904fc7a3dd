//! Made drives whose offset is known.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::*;
use crate::input::OdometryTrack;
use crate::localise::campaign::Random;
use crate::se2::Se2;

const DRIVE_S: f64 = 120.0;

/// The robot's heading over time: every five seconds it turns by a quarter, to the left and back, within 1.6 s.
fn turning(time_s: f64) -> f64 {
    let (turns, since_s) = ((time_s / 5.0).floor(), time_s.rem_euclid(5.0));
    let done = ((since_s - 2.0) / 1.6).clamp(0.0, 1.0);
    let share = done - (TAU * done).sin() / TAU;
    FRAC_PI_2 * if turns % 2.0 == 0.0 { share } else { 1.0 - share }
}

/// Wheels that turn 3 % too much and drift by a tenth of a degree a second, fifty times a second; set anew after a minute.
fn odometry(heading_rad: fn(f64) -> f64) -> OdometryTrack {
    let mut track = OdometryTrack::default();
    for step in -10..=(50.0 * DRIVE_S) as i32 + 10 {
        let time_s = 0.02 * f64::from(step);
        let anew = if time_s > 60.0 { 1.0 } else { 0.0 };
        let turned = 1.03 * heading_rad(time_s) + 0.1_f64.to_radians() * time_s + anew;
        track.push(time_s, Se2::new(0.5 * time_s, anew, turned));
    }
    track
}

/// Mapped scans, 25 a second, whose stamps are early by so much; 0.05° of noise. In every tenth piece of 4 s the map is bent.
fn scans(heading_rad: fn(f64) -> f64, early_s: f64) -> Vec<(f64, Se2)> {
    let mut random = Random::new(5);
    let scan = |number: i32| {
        let time_s = 0.04 * f64::from(number) + 0.003;
        let bent = if (time_s / 4.0) as i32 % 10 == 3 { 0.05 * (7.0 * time_s).sin() } else { 0.0 };
        let seen = heading_rad(time_s + early_s) + bent + 0.05_f64.to_radians() * random.normal();
        (time_s, Se2::new(0.5 * time_s, 3.0, seen + 2.0))
    };
    (0..(25.0 * DRIVE_S) as i32).map(scan).collect()
}

#[test]
fn early_and_late_stamps_are_found() {
    for early_s in [-0.03, 0.0127, 0.05] {
        let found = estimate_time_offset(&scans(turning, early_s), &odometry(turning)).unwrap();
        let off_s = (found.younger_s - early_s).abs();
        assert!(found.is_believed() && found.deviation_s < 0.5e-3, "{found:?}");
        assert!(off_s < 4.0 * found.deviation_s, "{early_s} s: {found:?}");
    }
}

#[test]
fn right_stamps_are_left_alone() {
    let found = estimate_time_offset(&scans(turning, 0.0), &odometry(turning)).unwrap();
    assert!(!found.is_believed() && found.younger_s.abs() < 0.5e-3, "{found:?}");
}

#[test]
fn straight_drive_says_nothing() {
    let straight = |time_s: f64| 0.01 * (0.3 * time_s).sin();
    assert_eq!(estimate_time_offset(&scans(straight, 0.0127), &odometry(straight)), None);
    let even = |time_s: f64| 0.4 * time_s;
    assert_eq!(estimate_time_offset(&scans(even, 0.0127), &odometry(even)), None);
    assert_eq!(estimate_time_offset(&scans(turning, 0.0127), &OdometryTrack::default()), None);
}

/// Stamps of another clock are not mended.
#[test]
fn absurd_offsets_are_not_believed() {
    let found = estimate_time_offset(&scans(turning, 0.4), &odometry(turning)).unwrap();
    assert!(!found.is_believed() && found.is_absurd(), "{found:?}");
}
