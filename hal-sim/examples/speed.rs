//! How much faster than real time the world runs: `cargo run --release -p floorguard-sim --example speed`.

use std::time::Instant;

use floorguard_sim::{Scenario, Simulation};

fn main() {
    for name in Scenario::names() {
        let scenario = Scenario::named(name).expect("built-in scenarios are tested");
        let mut simulation = Simulation::new(&scenario, 1).expect("built-in scenarios are tested");
        let start = Instant::now();
        let mut events = 0_u32;
        simulation.advance_to(10_000_000, &mut |_| events += 1);
        let seconds = start.elapsed().as_secs_f64();
        let people = simulation.truth().people.len();
        println!("{name}: {people} people, {events} events, {:.1} times real time", 10.0 / seconds);
    }
}
