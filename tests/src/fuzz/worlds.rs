//! The whole runtime on the virtual clock under anything: several faults at once, at any place, from the first moment.
#![allow(clippy::missing_panics_doc)] // That they panic at a wrong answer is what they are for.

use floorguard_laboratory::campaign::random_fault;
use floorguard_laboratory::world::{Observation, Observer, Plan, run_virtual};
use floorguard_sim::FaultSpec;
use floorguard_types::random::Pcg32;

use crate::campaign::Random;

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

/// What came of a world.
#[derive(Clone, Copy, Debug, Default)]
pub struct Played {
    /// The robot went somewhere.
    pub moved: bool,
    /// Stops.
    pub stops: u64,
    /// Stops that ground truth asked for and that did not come; several faults at once may hide any person.
    pub missed: u64,
}

/// Draws a world and plays it to the end.
pub fn world(random: &mut Random) -> Played {
    let (plan, texts) = draw(random);
    let limit_mps = plan.robot.limits.speed_mps;
    let seen = play(&plan).unwrap_or_else(|error| panic!("{texts:?}: {error}"));
    let verdict = &seen.verdict;
    assert!(verdict.distance_m.is_finite() && seen.robot_path.iter().all(|pose| pose.x_m.is_finite()));
    for (at_s, speed_mps, limit_seen_mps) in &seen.speeds {
        // The robot's speed estimate may be corrupted; its permitted speed may not.
        assert!(
            limit_seen_mps.is_finite() && *limit_seen_mps <= limit_mps + 1.0e-3 && !speed_mps.is_infinite(),
            "{texts:?}: {limit_seen_mps} m/s permitted at {at_s} s"
        );
    }
    let (stops, missed) = (u64::from(verdict.stops), u64::from(verdict.missed_stops));
    Played { moved: verdict.distance_m > 0.1, stops, missed }
}
