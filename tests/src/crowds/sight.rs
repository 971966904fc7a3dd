//! Who can be seen: the share of a body that neither objects nor other people hide from the lidar.

use floorguard_sim::simulation::{PersonTruth, Truth};
use floorguard_types::geometry::Point2;

/// Beams over the breadth of a body.
const BEAMS: u16 = 15;
/// What is narrower than this hides nobody: legs, metres.
const BODY_MIN_M: f32 = 0.15;

/// Share of each person's breadth that is in sight, in the order of the truth. `viewpoint` is the lidar, world frame.
#[must_use]
pub fn shares_in_sight(truth: &Truth, viewpoint: Point2) -> Vec<f32> {
    truth
        .people
        .iter()
        .map(|person| if person.in_sight { share(truth, person, viewpoint) } else { 0.0 })
        .collect()
}

fn share(truth: &Truth, person: &PersonTruth, viewpoint: Point2) -> f32 {
    let away = Point2::new(person.position.x_m - viewpoint.x_m, person.position.y_m - viewpoint.y_m);
    let distance_m = away.norm().max(0.1);
    let open = (0..BEAMS).filter(|beam| {
        let aside_m = person.radius_m * (2.0 * (f32::from(*beam) + 0.5) / f32::from(BEAMS) - 1.0);
        let target = Point2::new(
            person.position.x_m - away.y_m / distance_m * aside_m,
            person.position.y_m + away.x_m / distance_m * aside_m,
        );
        let others = truth.people.iter().filter(|other| other.id != person.id);
        let mut discs = others.flat_map(|other| &other.body_discs).filter(|disc| disc.1 >= BODY_MIN_M);
        !discs.any(|(middle, radius_m)| hides(viewpoint, target, *middle, *radius_m))
    });
    open.count() as f32 / f32::from(BEAMS)
}

/// A disc lies across the ray from `viewpoint` to `target`.
fn hides(viewpoint: Point2, target: Point2, middle: Point2, radius_m: f32) -> bool {
    let ray = Point2::new(target.x_m - viewpoint.x_m, target.y_m - viewpoint.y_m);
    let to_disc = Point2::new(middle.x_m - viewpoint.x_m, middle.y_m - viewpoint.y_m);
    let length2 = (ray.x_m * ray.x_m + ray.y_m * ray.y_m).max(1.0e-6);
    let along = (to_disc.x_m * ray.x_m + to_disc.y_m * ray.y_m) / length2;
    let nearest = Point2::new(viewpoint.x_m + along * ray.x_m, viewpoint.y_m + along * ray.y_m);
    (0.0..1.0).contains(&along) && nearest.distance(middle) < radius_m
}
