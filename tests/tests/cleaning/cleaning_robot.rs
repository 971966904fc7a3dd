//! The robot that drives cleans: judged by the dirt that really lies there.

use floorguard_laboratory::world::{Observation, Observer, Plan, run_recorded};
use floorguard_operator::telemetry::RunSinks;
use floorguard_robot::cleaner::MissionStrategy;
use floorguard_sim::FaultSpec;
use floorguard_sim::scenario::Scenario;

/// A room of 10 x 7 m with two spills and nobody in it.
const ROOM: &str = r#"
title = "a room with two spills"
start = { at_m = [2.0, 3.5] }
[route]
speed_mps = 0.8
waypoints_m = [[7.0, 3.5]]
[scene]
wall = [
  { from_m = [0.0, 0.0], to_m = [10.0, 0.0] },
  { from_m = [10.0, 0.0], to_m = [10.0, 7.0] },
  { from_m = [10.0, 7.0], to_m = [0.0, 7.0] },
  { from_m = [0.0, 7.0], to_m = [0.0, 0.0] },
]
furniture = [{ kind = "box", at_m = [5.0, 0.6], size_m = [0.8, 0.8] }]
[dirt]
spill = [
  { at_m = [4.5, 3.6], radius_m = 0.25, units = 12.0 },
  { at_m = [6.5, 3.0], radius_m = 0.25, units = 15.0 },
]
"#;

fn plan(seconds: u64) -> Plan {
    let scenario = Scenario::from_toml(ROOM).unwrap();
    Plan::of("room", scenario, 1, seconds * 1_000_000).unwrap().cleaning(None).unwrap()
}

fn played(plan: &Plan, sinks: &mut RunSinks) -> Observation {
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(plan, &mut show);
    run_recorded(plan, &mut observer, sinks).unwrap();
    observer.into_observation()
}

/// Nobody on the path: the spills are gone by the truth, and nothing is claimed that is not clean.
#[test]
fn empty_room_is_cleaned_without_false_claims() {
    let mut plan = plan(90);
    plan.until_clean = true;
    let seen = played(&plan, &mut RunSinks::default());
    let mission = &seen.mission.as_ref().unwrap().report;
    assert!(
        mission.dirty_cells >= 35 && mission.claimed_cells == mission.dirty_cells && mission.finished,
        "{mission:?}"
    );
    assert_eq!(mission.falsely_claimed_cells, 0, "{mission:?}");
    assert!(mission.dirt_after_units * 10 < mission.dirt_before_units, "{mission:?}");
    assert!(mission.localisation_error_max_m.unwrap() < 0.1, "{mission:?}");
    assert!(seen.verdict.passed);
    // Nobody was there: nobody cost anything.
    assert!(mission.people_cost_s < 1.0, "{mission:?}");
    let ended_s = mission.finished_after_s.unwrap();
    let spent_s: f32 = mission.time_s.values().sum();
    assert!((f64::from(spent_s) - ended_s).abs() < 3.0, "the run ends with the mission: {mission:?}");
}

/// A minute of the supermarket with twenty people: the robot comes forward among them, touches nobody, claims nothing
/// falsely, and tells where the time went. The whole mission is a command: simulate --scenario busy-supermarket.
#[test]
fn a_minute_among_twenty_people() {
    let plan = Plan::named("busy-supermarket", 2, 60_000_000).unwrap().cleaning(None).unwrap();
    assert_eq!(plan.scenario.people(1).len(), 20);
    let seen = played(&plan, &mut RunSinks::default());
    let mission = &seen.mission.as_ref().unwrap().report;
    assert!(seen.verdict.passed && seen.verdict.avoidable_contacts == 0, "{:?}", seen.verdict);
    assert!(mission.dirt_after_units < mission.dirt_before_units && mission.distance_m > 3.0, "{mission:?}");
    assert_eq!(mission.falsely_claimed_cells, 0, "{mission:?}");
    let spent_s: f32 = mission.time_s.values().sum();
    assert!((spent_s - 60.0).abs() < 3.0, "{mission:?}");
    assert!(mission.people_cost_s > 1.0 && mission.people_cost_s < 45.0, "{mission:?}");
}

/// A supermarket with nobody in it is clean when the robot has been everywhere. With this seed the first pass over a spill is taken
/// for a slip: what the dirt sensor does not count on the next one must not be taken for another.
#[test]
fn empty_supermarket_is_cleaned_to_the_end() {
    let mut scenario = Scenario::named("supermarket").unwrap();
    scenario.person.clear();
    let mut plan =
        Plan::of("an empty supermarket", scenario, 1, 200_000_000).unwrap().cleaning(None).unwrap();
    plan.until_clean = true;
    let seen = played(&plan, &mut RunSinks::default());
    let mission = &seen.mission.as_ref().unwrap().report;
    assert!(mission.finished && mission.claimed_cells == mission.dirty_cells, "{mission:?}");
    assert!(mission.finished_after_s.unwrap() < 150.0, "{mission:?}");
    assert_eq!(mission.falsely_claimed_cells, 0, "{mission:?}");
}

/// Without a mission no dirt lies there and nothing is judged; the route alone misses a spill beside it.
#[test]
fn the_route_cleans_only_what_lies_on_it() {
    let scenario = Scenario::from_toml(ROOM).unwrap();
    let bare = Plan::of("room", scenario, 1, 20_000_000).unwrap();
    assert!(played(&bare, &mut RunSinks::default()).mission.is_none());
    let route = bare.cleaning(Some(MissionStrategy::Route)).unwrap();
    let report = played(&route, &mut RunSinks::default()).mission.unwrap().report;
    assert!(report.completion < 0.95, "{report:?}");
    assert!(report.dirt_after_units < report.dirt_before_units, "{report:?}");
}

/// The computer loses its power early or late in a pass: it finds itself again, doubts what it had just swept, and goes on
/// with what is left.
#[test]
fn a_power_cut_costs_time_and_no_claims() {
    for fault in ["computer:reset,from=8s,to=10s", "computer:reset,from=22s,to=24s"] {
        let mut plan = plan(75);
        plan.faults.push(FaultSpec::parse(fault).unwrap());
        let seen = played(&plan, &mut RunSinks::default());
        let mission = &seen.mission.as_ref().unwrap().report;
        assert!(mission.claimed_cells * 10 >= mission.dirty_cells * 9, "{fault}: {mission:?}");
        assert_eq!(mission.falsely_claimed_cells, 0, "{fault}: {mission:?}");
        assert!(seen.verdict.passed);
    }
}
