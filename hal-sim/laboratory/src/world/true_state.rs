//! The true state of a simulated world as recordings hold it, so that others can judge with programs of their own.

use floorguard_contact_judge as judge;
use floorguard_recording::truth::{SolidShape, TrueSolid};
use floorguard_sim::simulation::Simulation;
use parry3d::math::{Rotation, Vector};

use super::plan::Plan;
use crate::judge::{person, setup};

/// Everything that stands, and holes in the floor.
pub(super) fn things(plan: &Plan, simulation: &Simulation) -> Vec<TrueSolid> {
    let things = setup(plan, simulation).things.into_iter();
    things
        .flat_map(|thing| {
            let text = match (thing.kind, thing.surface) {
                (judge::ThingKind::Drop, _) => "hole",
                (_, judge::Surface::Glass) => "glass",
                (_, judge::Surface::Mirror) => "mirror",
                _ => "solid",
            };
            solids((&thing.name, text), &thing.solid)
        })
        .zip(0..)
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
