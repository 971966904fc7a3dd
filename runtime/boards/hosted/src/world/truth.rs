//! From the simulator's truth to the judge's.

use floorguard_sim::simulation::Simulation;

use crate::judge::{Truth, TruthPerson};

/// Farther away nothing reaches a zone, metres.
const RANGE_M: f32 = 5.0;
/// Heights at which things may be that the safety scanner cannot see, metres.
const RAISED_M: [f32; 4] = [0.4, 0.75, 0.95, 1.2];

/// The moment as the judge wants it.
pub fn judged(simulation: &Simulation) -> Truth {
    let truth = simulation.truth();
    let people = truth.people.iter().map(|person| TruthPerson {
        id: person.id,
        position: person.position,
        velocity_mps: person.velocity,
        radius_m: person.radius_m,
        ground: person.ground_discs.clone(),
        body: person.body_discs.clone(),
    });
    Truth {
        stamp: truth.stamp,
        robot: truth.robot,
        twist: truth.twist,
        people: people.collect(),
        obstacles_in_robot: simulation.obstacles_in_robot(RANGE_M),
        raised_in_robot: RAISED_M
            .iter()
            .flat_map(|height_m| simulation.obstacles_at_height(*height_m, RANGE_M))
            .collect(),
    }
}
