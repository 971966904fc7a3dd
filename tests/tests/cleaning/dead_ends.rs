//! Drives through buildings with dead ends, judged by what the true building offers; and out of a place before a wall.

use floorguard_laboratory::campaign::{dead_end_drive, dead_end_observation, judge_dead_end, run_seeds};
use floorguard_laboratory::judge::Outcome;
use floorguard_laboratory::world::{Observer, Plan, run_virtual};
use floorguard_sim::scenario::Scenario;
use floorguard_types::geometry::Pose2;

const PARKED: &str = r#"
title = "parked before a wall"
start = { at_m = [7.7, 0.0], yaw_deg = 0.0 }
[scene]
wall = [
  { from_m = [0.0, -3.0], to_m = [9.0, -3.0] },
  { from_m = [9.0, -3.0], to_m = [9.0, 3.0] },
  { from_m = [9.0, 3.0], to_m = [0.0, 3.0] },
  { from_m = [0.0, 3.0], to_m = [0.0, -3.0] },
]
"#;

#[test]
fn a_slice_of_drives_among_dead_ends() {
    let summary = run_seeds(2..4, dead_end_drive).unwrap();
    assert!(summary.failures.is_empty(), "{:#?}", summary.failures);
    assert_eq!(summary.endings.values().sum::<u32>(), 2, "{:?}", summary.endings);
}

/// Without obstacles in its costmap the robot drives up to what stands in its way and stays there. The judge notices.
#[test]
fn blind_robot_fails_among_dead_ends() {
    let (world, seen) = dead_end_observation(4, |plan| {
        plan.duration_us = 80_000_000;
        let drive = plan.navigation.as_mut().expect("a drive");
        (drive.settings.is_blind, drive.settings.help_after_s) = (true, 30.0);
    })
    .unwrap();
    let failure = judge_dead_end(&world, &seen).unwrap_err();
    let knows = ["there is a way", "neither arrives nor calls"].iter().any(|words| failure.contains(words));
    assert!(knows, "{failure}");
}

/// A robot that gives up at once is not right: the true building has a way.
#[test]
fn robot_that_gives_up_fails_among_dead_ends() {
    let (world, seen) = dead_end_observation(4, |plan| {
        plan.navigation.as_mut().expect("a drive").settings.help_after_s = 0.5;
    })
    .unwrap();
    let failure = judge_dead_end(&world, &seen).unwrap_err();
    assert!(failure.contains("although there is a way"), "{failure}");
}

/// Three decimetres before a wall the guard lets the robot do nothing but go back. It asks for nothing else.
#[test]
fn robot_parked_before_a_wall_backs_out() {
    let scenario = Scenario::from_toml(PARKED).unwrap();
    let plan = Plan::of("parked", scenario, 1, 100_000_000).unwrap();
    let plan = plan.navigating(Pose2::new(2.0, 0.0, std::f32::consts::PI)).unwrap();
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer).unwrap();
    let verdict = observer.into_observation().verdict;
    assert_eq!(verdict.verdict, Outcome::Good, "{}", verdict.reason);
    let drive = verdict.navigation.expect("the drive is judged");
    assert!(verdict.stops == 0 && drive.standing_share < 0.15, "{} stops, {drive:#?}", verdict.stops);
}
