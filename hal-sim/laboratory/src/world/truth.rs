//! From the simulator's truth to the judge's.

use floorguard_sim::simulation::{Simulation, Truth as SimTruth};
use floorguard_types::geometry::{Point2, Pose2};

use crate::judge::{Truth, TruthPerson};

/// Farther away nothing reaches a zone, metres.
const RANGE_M: f32 = 5.0;
/// Heights at which objects may be that the safety scanner cannot see, metres.
const RAISED_M: [f32; 4] = [0.4, 0.75, 0.95, 1.2];

/// Sees the world as the judge wants it. What stands does not move: it is examined again only when the robot has moved.
#[derive(Default)]
pub struct TruthSampler {
    /// Heights at which something else stands than at the scanner's, metres.
    raised_m: Option<Vec<f32>>,
    around: Option<(Pose2, Around)>,
}

/// Points on what stands, robot frame, metres: at the scanner's height, and at other heights.
type Around = (Vec<Point2>, Vec<Point2>);

impl TruthSampler {
    /// The moment; `truth` is the simulation's own.
    pub fn judged(&mut self, simulation: &Simulation, truth: &SimTruth) -> Truth {
        let people = truth.people.iter().map(|person| TruthPerson {
            id: person.id,
            position: person.position,
            velocity_mps: person.velocity,
            radius_m: person.radius_m,
            ground: person.ground_discs.clone(),
            body: person.body_discs.clone(),
        });
        let raised_m = self.raised_m.get_or_insert_with(|| {
            let scanner_m = simulation.parameters().scanner.z_m;
            RAISED_M
                .into_iter()
                .filter(|raised_m| !simulation.is_same_at_heights(scanner_m, *raised_m))
                .collect()
        });
        let sample = || (truth.robot, sample_surroundings(simulation, raised_m));
        let known = self.around.take().filter(|(from, _)| *from == truth.robot);
        let (_, around) = self.around.insert(known.unwrap_or_else(sample));
        Truth {
            stamp: truth.stamp,
            robot: truth.robot,
            twist: truth.twist,
            people: people.collect(),
            obstacles_in_robot: around.0.clone(),
            raised_in_robot: around.1.clone(),
        }
    }
}

fn sample_surroundings(simulation: &Simulation, raised_m: &[f32]) -> Around {
    let raised = raised_m.iter().flat_map(|height_m| simulation.obstacles_at_height(*height_m, RANGE_M));
    (simulation.obstacles_in_robot(RANGE_M), raised.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_sim::scenario::Scenario;

    #[test]
    fn static_surroundings_are_resampled_after_motion() {
        let mut simulation = Simulation::new(&Scenario::named("crossing").unwrap(), 1).unwrap();
        let mut truth_sampler = TruthSampler::default();
        for step in 1..6 {
            // It stands first, and is towed then.
            simulation.tow(if step < 3 { 0.0 } else { 0.8 }, 0.1);
            simulation.advance_to(step * 400_000, &mut |_| {});
            let seen = truth_sampler.judged(&simulation, &simulation.truth());
            assert_eq!(seen.robot, simulation.robot().0);
            assert_eq!(seen.obstacles_in_robot, simulation.obstacles_in_robot(RANGE_M), "{step}");
        }
    }

    #[test]
    fn lidar_only_heights_are_sampled_where_present() {
        let raised = |name: &str| {
            let mut simulation = Simulation::new(&Scenario::named(name).unwrap(), 1).unwrap();
            simulation.advance_to(10_000, &mut |_| {});
            let seen = TruthSampler::default().judged(&simulation, &simulation.truth());
            (seen.raised_in_robot.len(), seen.obstacles_in_robot.len())
        };
        // Walls look the same at every height; shelves with boards and tables do not.
        assert!(matches!(raised("crossing"), (0, 1..)));
        assert!(raised("supermarket").0 > 0);
    }
}
