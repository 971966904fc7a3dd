//! What the fault campaigns found, each as a test of its own.

use floorguard_laboratory::campaign::box_on_path;
use floorguard_laboratory::world::{Observation, Observer, Plan, run_virtual};
use floorguard_sim::FaultSpec;

/// The robot's state is large, and moved by value when a run begins.
const STACK_BYTES: usize = 64 << 20;

fn play(plan: Plan) -> Observation {
    let run = move || {
        let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
        let mut observer = Observer::new(&plan, &mut show);
        run_virtual(&plan, &mut observer).expect("the run");
        observer.into_observation()
    };
    std::thread::Builder::new()
        .stack_size(STACK_BYTES)
        .spawn(run)
        .expect("a thread")
        .join()
        .expect("no panic")
}

/// Drives up to a box under a fault; the front of the robot must stay off it.
fn stays_off_the_box(fault: &str) {
    let mut plan = box_on_path(7, 9_000_000).expect("a plan");
    plan.faults.push(FaultSpec::parse(fault).expect("a fault"));
    let seen = play(plan);
    let farthest_m = seen.robot_path.iter().map(|pose| pose.x_m).fold(0.0_f32, f32::max);
    assert!(seen.verdict.missed_stops == 0 && seen.verdict.passed, "{fault}: {:?}", seen.verdict);
    // The box begins at 2.1 m, the body ends 0.95 m before the origin.
    assert!(
        farthest_m > 0.5 && farthest_m + 0.95 < 2.1,
        "{fault}: the front came to {:.2} m",
        farthest_m + 0.95
    );
}

/// The process data to the traction drive are stuck at "drive on" while the master's heartbeat goes on: the drive's
/// watchdog had no reason to stop it.
#[test]
fn fg_req_055_stuck_drive_orders_stop_the_robot() {
    for from in ["1.5s", "2s", "2.5s", "3s", "4s"] {
        stays_off_the_box(&format!("traction-command:stuck,from={from},to=9s"));
    }
}

/// The bus repeats the computer's frames of two seconds ago, heartbeats included.
#[test]
fn fg_req_055_old_orders_do_not_carry_the_robot_on() {
    for from in ["2.5s", "3s", "4s"] {
        stays_off_the_box(&format!("commands:past=2000ms,from={from},to=9s"));
    }
}

/// The computer loses its power while the emergency stop is pressed, and comes back after its release: what was latched
/// is forgotten, and the drives were never switched off.
#[test]
fn fg_req_018_restarted_computer_does_not_start_robot() {
    let runs = [
        ("2.9s", "4.2s", vec![(3_000_000, 4_000_000)], 4.75),
        ("3s", "3.5s", vec![], 4.25),
        // Not in step with the heartbeats of the drives.
        ("3s", "3.537s", vec![], 4.3),
        ("3s", "3.571s", vec![], 4.3),
    ];
    for (from, to, pressed_us, stands_from_s) in runs {
        let mut plan = Plan::named("empty", 11, 12_000_000).expect("a plan");
        plan.emergency_stop_us = pressed_us;
        plan.faults.push(FaultSpec::parse(&format!("computer:reset,from={from},to={to}")).expect("a fault"));
        let seen = play(plan);
        // The operator of the simulator resets when the robot has waited for three seconds.
        assert!(seen.path_m(stands_from_s, stands_from_s + 2.0) < 0.05, "{from}: it started by itself");
        assert!(seen.resets >= 1 && seen.path_m(9.0, 11.75) > 0.5, "{from}: {} resets", seen.resets);
    }
}

/// Every telegram of the safety inputs is cut in half while the emergency stop is pressed and released (seed 2 of the
/// campaign, trial 3127): nobody heard it, so an operator must look.
#[test]
fn fg_req_003_unread_inputs_prevent_automatic_start() {
    let mut plan = Plan::named("empty", 11, 12_000_000).expect("a plan");
    plan.emergency_stop_us = vec![(3_000_000, 4_000_000)];
    plan.faults.push(FaultSpec::parse("inputs:truncate=100%,from=2s,to=4s").expect("a fault"));
    let seen = play(plan);
    // The operator of the simulator resets when the robot has waited for three seconds.
    assert!(seen.path_m(4.0, 5.0) < 0.05, "it rolled on while nobody had reset");
    assert!(seen.resets >= 1 && seen.path_m(9.0, 11.75) > 0.5, "{} resets", seen.resets);
}
