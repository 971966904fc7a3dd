//! The true state of a simulated world as recordings hold it, so that others can judge with programs of their own.

use floorguard_contact_judge as judge;
use floorguard_operator::telemetry::RunSinks;
use floorguard_recording::truth::{SolidShape, TrueSolid};
use floorguard_sim::simulation::Simulation;
use floorguard_types::time::Stamp;
use parry3d::math::{Rotation, Vector};

use crate::judge::{person, setup, thing};
use crate::plan::Plan;

/// From record to record of the true state.
const TRUTH_US: u64 = 20_000;

/// What of the true state is in the recording.
#[derive(Default)]
pub(super) struct TrueRecord {
    next_us: u64,
    parts: usize,
}

impl TrueRecord {
    /// Writes what stands at the begin.
    pub(super) fn begin(plan: &Plan, simulation: &Simulation, sinks: &mut RunSinks) -> Self {
        let begin = (Stamp::from_micros(simulation.now_us()), plan.odometry_in_world());
        sinks.true_world(begin, || things(setup(plan, simulation).things, 0));
        Self { next_us: 0, parts: simulation.scene().truth().len() }
    }

    /// Writes the robot and everybody when it is time, and what has come.
    pub(super) fn tell(&mut self, now_us: u64, simulation: &Simulation, sinks: &mut RunSinks) {
        if now_us < self.next_us {
            return;
        }
        self.next_us = now_us + TRUTH_US;
        let at = Stamp::from_micros(now_us);
        sinks.true_moment(at, simulation.robot(), || people(simulation));
        let parts = simulation.scene().truth();
        if parts.len() > self.parts {
            sinks.true_things(at, || arrivals(simulation, self.parts));
            self.parts = parts.len();
        }
    }
}

/// Parts of the scene that came after these; what stood at the begin, and holes in the floor, keep their numbers.
fn arrivals(simulation: &Simulation, known: usize) -> Vec<TrueSolid> {
    let scene = simulation.scene();
    let came = scene.truth().iter().skip(known).map(thing);
    things(came.collect(), (known + scene.drops().len()) as i32)
}

/// Objects in forms that are drawn, numbered from `first` on.
fn things(things: Vec<judge::Thing>, first: i32) -> Vec<TrueSolid> {
    things
        .into_iter()
        .flat_map(|thing| {
            let text = match (thing.kind, thing.surface) {
                (judge::ThingKind::Drop, _) => "hole",
                (_, judge::Surface::Glass) => "glass",
                (_, judge::Surface::Mirror) => "mirror",
                _ => "solid",
            };
            solids((&thing.name, text), &thing.solid)
        })
        .zip(first..)
        .map(|(solid, id)| TrueSolid { id, ..solid })
        .collect()
}

/// Everybody's limbs.
pub(super) fn people(simulation: &Simulation) -> Vec<TrueSolid> {
    let of_person = |real| {
        let judge::Person { id, kind, limbs, .. } = person(real);
        let name = format!("person {id} ({kind})");
        let parts = limbs.iter().flat_map(|limb| {
            let text = serde_json::to_value(limb.name).ok();
            let text = text.as_ref().and_then(|value| value.as_str()).unwrap_or_default();
            solids((&name, text), &limb.solid)
        });
        parts.zip(0..).map(|(solid, id)| TrueSolid { id, ..solid }).collect::<Vec<_>>()
    };
    simulation.people().iter().flat_map(of_person).collect()
}

/// A solid in forms that are drawn: a rod is a cylinder with a ball at each end.
fn solids((name, text): (&str, &str), solid: &judge::Solid) -> Vec<TrueSolid> {
    let one = |shape, centre: Vector, turn: Rotation| TrueSolid {
        name: name.to_owned(),
        id: 0,
        shape,
        centre_m: centre.to_array().map(f64::from),
        turn: turn.to_array().map(f64::from),
        text: text.to_owned(),
    };
    let ball = |centre_m: [f32; 3], radius_m: f32| {
        one(SolidShape::Ball(2.0 * f64::from(radius_m)), Vector::from_array(centre_m), Rotation::IDENTITY)
    };
    match *solid {
        judge::Solid::Box { centre_m, half_m, yaw_rad, slope_rad } => {
            let turn = Rotation::from_rotation_z(yaw_rad) * Rotation::from_rotation_y(-slope_rad);
            let size_m = half_m.map(|half| 2.0 * f64::from(half));
            vec![one(SolidShape::Box(size_m), Vector::from_array(centre_m), turn)]
        }
        judge::Solid::Cylinder { foot_m, radius_m, height_m } => {
            let shape = SolidShape::Cylinder(2.0 * f64::from(radius_m), f64::from(height_m));
            let middle = Vector::from_array(foot_m) + Vector::Z * (height_m / 2.0);
            vec![one(shape, middle, Rotation::IDENTITY)]
        }
        judge::Solid::Capsule { from_m, to_m, radius_m } => {
            let (from, to) = (Vector::from_array(from_m), Vector::from_array(to_m));
            let length_m = (to - from).length();
            let turn = Rotation::from_rotation_arc(Vector::Z, (to - from) / length_m.max(1.0e-6));
            let shape = SolidShape::Cylinder(2.0 * f64::from(radius_m), f64::from(length_m));
            vec![one(shape, (from + to) / 2.0, turn), ball(from_m, radius_m), ball(to_m, radius_m)]
        }
        judge::Solid::Ball { centre_m, radius_m } => vec![ball(centre_m, radius_m)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_sim::scenario::Scenario;

    /// A door that shuts gets a number of its own, behind those of what stood before and of the hole.
    #[test]
    fn what_comes_later_is_recorded_once() {
        let text = "title = \"a door\"\n[scene]\ndrop = [{ at_m = [8.0, 0.0], size_m = [1.0, 1.0], depth_m = 1.0 }]\n\
            furniture = [{ kind = \"box\", at_m = [5.0, 0.0], size_m = [0.1, 1.6], appears_s = 0.1 }, \
            { kind = \"box\", at_m = [2.0, -3.0], size_m = [0.4, 0.4] }]\n";
        let plan = Plan::of("door", Scenario::from_toml(text).unwrap(), 1, 1_000_000).unwrap();
        let mut simulation = plan.simulation().unwrap();
        let mut sinks = RunSinks::default();
        let mut record = TrueRecord::begin(&plan, &simulation, &mut sinks);
        let begin = things(setup(&plan, &simulation).things, 0);
        let names =
            |solids: &[TrueSolid]| solids.iter().map(|one| (one.name.clone(), one.id)).collect::<Vec<_>>();
        let known = [("box 2".to_owned(), 0), ("hole in the floor".to_owned(), 1)];
        assert_eq!(names(&begin), known);
        simulation.advance_to(200_000, &mut |_| {});
        assert_eq!(names(&arrivals(&simulation, record.parts)), [("box 1".to_owned(), 2)]);
        record.tell(200_000, &simulation, &mut sinks);
        assert!(arrivals(&simulation, record.parts).is_empty(), "it is recorded");
    }
}
