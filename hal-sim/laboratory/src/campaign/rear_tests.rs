//! Boxes beside the rear of a robot that spins: with a second scanner it stops before them; without, it turns slowly until it has seen
//! what is there. The judge knows true geometry alone.

use floorguard_configuration::parse;
use floorguard_runtime::configuration::RobotConfiguration;

use super::{STACK_BYTES, watched};
use crate::judge::Verdict;
use crate::plan::Plan;
use crate::world::load_scenario;

const FEWEST: &str = include_str!("../../../../examples/fewest-holes.toml");
/// The robot becomes ready and spins towards the box, microseconds.
const DURATION_US: u64 = 8_000_000;

fn plan(world: &str) -> Plan {
    let path = format!("{}/../scenarios/hazards/{world}.toml", env!("CARGO_MANIFEST_DIR"));
    let scenario = load_scenario(path.as_ref()).unwrap_or_else(|error| panic!("{path}: {error:#}"));
    let mut plan = Plan::of(world, scenario, 1, DURATION_US).expect("a plan");
    plan.lidar_grain = 2;
    plan
}

/// The same with the sensors of the example with two scanners.
fn plan_with_two_scanners(world: &str) -> Plan {
    let mut plan = plan(world);
    let read = parse("fewest-holes.toml", FEWEST).unwrap_or_else(|refused| panic!("{refused}"));
    let (route, route_limits) = (plan.robot.route.clone(), plan.robot.route_limits);
    plan.robot = RobotConfiguration { route, route_limits, ..read.robot };
    plan
}

fn verdict(plan: &Plan) -> Verdict {
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(1).stack_size(STACK_BYTES).build().expect("a thread");
    let seen = pool.install(|| watched(plan));
    seen.unwrap_or_else(|error| panic!("{}: {error:#}", plan.name)).verdict
}

/// Speed of the body at its hardest contact, m/s; none: it touches nothing.
fn touched_mps(verdict: &Verdict) -> Option<f32> {
    verdict.bodies.contacts.iter().map(|contact| contact.robot_mps).reduce(f32::max)
}

#[test]
fn fg_req_029_second_scanner_holds_the_tail() {
    // The high box a little farther away is met by the lidar before the start (FG-REQ-068): it holds without the second scanner, too.
    for (world, aside_m, lidar_holds) in
        [("tail-12", 0.0, false), ("tail-45", 0.0, false), ("tail-12", 0.04, false), ("tail-45", 0.04, true)]
    {
        let mut plan = plan_with_two_scanners(world);
        plan.scenario.scene.furniture.iter_mut().for_each(|object| object.at_m[1] -= aside_m);
        let whole = verdict(&plan);
        assert_eq!(touched_mps(&whole), None, "{world}: {}", whole.contacts_in_words());
        // It has no other order than to spin: it stands, and no other complaint is raised.
        assert!(
            whole.failures.iter().all(|failure| failure.contains("never")),
            "{world}: {:?}",
            whole.failures
        );
        // The same robot, and its second scanner does not look there.
        let mut without = plan;
        let rear = without.robot.rear_scanner.as_mut().expect("a second scanner");
        rear.sector_rad = [-2.3, -2.2];
        let without = verdict(&without);
        assert_eq!(touched_mps(&without).is_none(), lidar_holds, "{world}: {}", without.contacts_in_words());
    }
}

#[test]
fn fg_req_064_unknown_rear_is_touched_slowly() {
    // As soon as the robot turns by 2°, the lowest ring meets the far corner of a box of 45 cm, and what the memory knows is touched
    // slowly, if at all. Over one of 40 cm it passes.
    for (world, height_m, lidar_knows) in
        [("tail-12", 0.12, false), ("tail-45", 0.40, false), ("tail-45", 0.45, true)]
    {
        let mut slow = plan(world);
        slow.scenario.scene.furniture.iter_mut().for_each(|object| object.height_m = height_m);
        slow.duration_us = 14_000_000;
        let limit_mps = slow.robot.unseen.unknown_rear_mps;
        let mut fast = slow.clone();
        fast.robot.unseen.known_after_m = 0.0;
        let (slow, fast) = (touched_mps(&verdict(&slow)), touched_mps(&verdict(&fast)));
        assert!(slow.is_none_or(|mps| mps <= limit_mps), "{height_m} m: {slow:?}");
        let is_slow = fast.is_none_or(|mps| mps <= limit_mps);
        assert_eq!(is_slow, lidar_knows, "{height_m} m, whose rear counts as known: {fast:?}");
    }
}

/// Low boxes ahead are accepted at 0.2 m/s: a robot without the limit meets them faster.
#[test]
fn fg_req_063_low_box_is_touched_at_the_accepted_speed() {
    let accepted = floorguard_configuration::EXAMPLE.replacen(
        "front below 0.16 m\"",
        "front below 0.16 m at 0.20 m/s\"",
        1,
    );
    let robot = parse("robot.toml", &accepted).unwrap_or_else(|refused| panic!("{refused}")).robot;
    // The memory knows a box of 6 cm in time to brake; nothing counts one of 4.5 cm as an object.
    for (world, memory_knows) in [("low-box-4", false), ("low-box-6", true)] {
        let mut limited = plan(world);
        limited.duration_us = 26_000_000;
        let mut free = limited.clone();
        limited.robot.unseen = robot.unseen;
        free.duration_us = 10_000_000;
        let (limited, free) = (touched_mps(&verdict(&limited)), touched_mps(&verdict(&free)));
        // So slow, the lidar may see it in time.
        assert!(limited.is_none_or(|mps| mps <= 0.22), "{world}: {limited:?}");
        let is_fast = free.is_some_and(|mps| mps > 0.3);
        assert_eq!(is_fast, !memory_knows, "{world}: {free:?}");
    }
}
