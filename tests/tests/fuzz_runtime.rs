//! The whole runtime on the virtual clock under anything: several faults at once, at any place, from the first moment.
//!
//! No panic, no task that spins, no order to the drive beyond its limits, and a robot that can be judged to the end.
//! `cargo xtask campaign fuzz-runtime` runs as many worlds as one likes.

use floorguard_core::random::Pcg32;
use floorguard_hosted::campaign::random_fault;
use floorguard_hosted::world::{Observation, Observer, Plan, run_virtual};
use floorguard_sim::FaultSpec;
use floorguard_tests::campaign::{Random, Slice, report};

/// The robot's state is large, and moved by value when a run begins.
const STACK_BYTES: usize = 64 << 20;
const SCENARIOS: [&str; 5] = ["empty", "crossing", "encounter", "corridor", "warehouse"];

/// A world, and what it was, for the message.
fn draw(random: &mut Random) -> (Plan, Vec<String>) {
    let name = SCENARIOS[random.below(SCENARIOS.len() as u64) as usize];
    let duration_us = 2_000_000 + random.below(3_000_000);
    let mut plan = Plan::named(name, random.next(), duration_us).expect("a built-in scenario");
    let mut dice = Pcg32::new(random.next(), 71);
    let mut texts = Vec::new();
    for _ in 0..2 + random.below(5) {
        let from_ms = random.below(duration_us / 1_000);
        let text = format!(
            "{},from={from_ms}ms,to={}ms",
            random_fault(&mut dice),
            from_ms + 1 + random.below(2_000)
        );
        plan.faults.push(FaultSpec::parse(&text).expect("a fault"));
        texts.push(text);
    }
    if random.seldom(3) {
        let pressed_us = random.below(duration_us);
        plan.emergency_stop_us = vec![(pressed_us, pressed_us + random.below(1_000_000))];
    }
    (plan, texts)
}

fn play(plan: &Plan) -> anyhow::Result<Observation> {
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(plan, &mut show);
    run_virtual(plan, &mut observer)?;
    Ok(observer.into_observation())
}

fn run(slice: &Slice) {
    let (mut moved, mut stops, mut missed) = (0, 0, 0);
    for number in slice.trials.clone() {
        let mut random = slice.random(number);
        let (plan, texts) = draw(&mut random);
        let limit_mps = plan.robot.limits.speed_mps;
        let seen = play(&plan).unwrap_or_else(|error| panic!("world {number}, {texts:?}: {error}"));
        let verdict = &seen.verdict;
        assert!(verdict.distance_m.is_finite() && seen.robot_way.iter().all(|pose| pose.x_m.is_finite()));
        for (at_s, speed_mps, limit_seen_mps) in &seen.speeds {
            // What the robot believes of its speed may be spoilt; what it permits may not.
            assert!(
                limit_seen_mps.is_finite()
                    && *limit_seen_mps <= limit_mps + 1.0e-3
                    && !speed_mps.is_infinite(),
                "world {number}, {texts:?}: {limit_seen_mps} m/s permitted at {at_s} s"
            );
        }
        moved += u64::from(verdict.distance_m > 0.1);
        stops += u64::from(verdict.stops);
        missed += u64::from(verdict.missed_stops);
    }
    let worlds = slice.trials.end - slice.trials.start;
    report(&[
        ("worlds", worlds),
        ("moved", moved),
        ("stops", stops),
        ("missed under several faults", missed),
    ]);
    assert!(moved > 0 || worlds < 10, "no robot moved: the campaign tests nothing");
}

#[test]
fn any_faults_at_once_leave_the_runtime_running() {
    let slice = Slice::from_environment(16);
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
    if let Err(panic) = thread.spawn(move || run(&slice)).expect("a thread").join() {
        std::panic::resume_unwind(panic);
    }
}
