//! The body as capsules, balls and boxes.

use parry3d::math::{Pose, Rotation, Vector};
use parry3d::query::{Ray, RayCast};
use parry3d::shape::{Ball, Capsule, Cuboid};

use super::{Person, PersonKind};

/// A part of a body, world frame.
#[derive(Clone, Copy, Debug)]
pub enum BodyPart {
    /// Torso, leg.
    Capsule(Capsule),
    /// Head.
    Ball(Vector, Ball),
    /// Chair, trolley, suitcase.
    Box(Pose, Cuboid),
}

impl BodyPart {
    /// Along a beam of unit direction, metres.
    #[must_use]
    pub fn cast(&self, ray: &Ray, range_max_m: f32) -> Option<f32> {
        match self {
            Self::Capsule(capsule) => capsule.cast_local_ray(ray, range_max_m, true),
            Self::Ball(centre, ball) => {
                ball.cast_ray(&Pose::from_translation(*centre), ray, range_max_m, true)
            }
            Self::Box(pose, cuboid) => cuboid.cast_ray(pose, ray, range_max_m, true),
        }
    }
}

fn upright(person: &Person, at: (f32, f32), z: (f32, f32), radius_m: f32) -> BodyPart {
    let foot = person.beside(at.0, at.1);
    let low = Vector::new(foot.x_m, foot.y_m, z.0 + radius_m);
    let high = Vector::new(foot.x_m, foot.y_m, (z.1 - radius_m).max(z.0 + radius_m + 0.01));
    BodyPart::Capsule(Capsule::new(low, high, radius_m))
}

fn head(person: &Person, ahead_m: f32, top_m: f32) -> BodyPart {
    let at = person.beside(ahead_m, 0.0);
    BodyPart::Ball(Vector::new(at.x_m, at.y_m, top_m - 0.11), Ball::new(0.11))
}

fn block(person: &Person, at: (f32, f32), size: (f32, f32), z: (f32, f32)) -> BodyPart {
    let middle = person.beside(at.0, at.1);
    let pose = Pose::from_parts(
        Vector::new(middle.x_m, middle.y_m, (z.0 + z.1) / 2.0),
        Rotation::from_rotation_z(person.heading_rad),
    );
    BodyPart::Box(pose, Cuboid::new(Vector::new(size.0 / 2.0, size.1 / 2.0, (z.1 - z.0) / 2.0)))
}

fn leg(person: &Person, swing_m: f32, left_m: f32, hip_m: f32, radius_m: f32) -> BodyPart {
    let (hip, foot) = (person.beside(0.0, left_m), person.beside(swing_m, left_m));
    let low = Vector::new(foot.x_m, foot.y_m, radius_m);
    BodyPart::Capsule(Capsule::new(low, Vector::new(hip.x_m, hip.y_m, hip_m), radius_m))
}

/// A rod with round ends between two points: metres ahead, to the left, up.
fn rod(person: &Person, from: [f32; 3], to: [f32; 3], radius_m: f32) -> BodyPart {
    let [from, to] = [from, to].map(|[ahead_m, left_m, up_m]| {
        let at = person.beside(ahead_m, left_m);
        Vector::new(at.x_m, at.y_m, up_m)
    });
    BodyPart::Capsule(Capsule::new(from, to, radius_m))
}

/// On the back: 1.75 m from the feet at -0.80 m to the head at 0.80 m.
fn lying(person: &Person) -> Vec<BodyPart> {
    let head_at = person.beside(0.72, 0.0);
    vec![
        rod(person, [-0.80, 0.12, 0.065], [0.0, 0.09, 0.08], 0.065),
        rod(person, [-0.80, -0.12, 0.065], [0.0, -0.09, 0.08], 0.065),
        rod(person, [0.0, 0.09, 0.13], [0.45, 0.09, 0.13], 0.13),
        rod(person, [0.0, -0.09, 0.13], [0.45, -0.09, 0.13], 0.13),
        BodyPart::Ball(Vector::new(head_at.x_m, head_at.y_m, 0.11), Ball::new(0.11)),
        rod(person, [0.40, 0.25, 0.05], [0.05, 0.75, 0.05], 0.05),
    ]
}

/// Bent over, an arm stretched out ahead and down to 0.45 m.
fn reaching(person: &Person) -> Vec<BodyPart> {
    vec![
        rod(person, [0.0, 0.10, 0.065], [-0.05, 0.10, 0.82], 0.065),
        rod(person, [0.0, -0.10, 0.065], [-0.05, -0.10, 0.82], 0.065),
        rod(person, [-0.05, 0.09, 0.90], [0.20, 0.09, 1.20], 0.14),
        rod(person, [-0.05, -0.09, 0.90], [0.20, -0.09, 1.20], 0.14),
        BodyPart::Ball(
            Vector::new(person.beside(0.32, 0.0).x_m, person.beside(0.32, 0.0).y_m, 1.34),
            Ball::new(0.11),
        ),
        rod(person, [0.25, 0.18, 1.15], [0.75, 0.18, 0.45], 0.05),
    ]
}

/// Parts of people as far as a contact with them differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limb {
    /// Leg and foot.
    Leg,
    /// Belly, chest, back.
    Torso,
    /// Arm and hand.
    Arm,
    /// Head.
    Head,
    /// Chair, trolley, suitcase.
    Thing,
}

/// What each of the [`body_parts`] of a kind is, in the same order.
#[must_use]
pub const fn limbs(kind: PersonKind) -> &'static [Limb] {
    use Limb::{Arm, Head, Leg, Thing, Torso};
    match kind {
        PersonKind::Wheelchair => &[Thing, Thing, Thing, Torso, Torso, Head, Leg, Leg],
        PersonKind::Crouching => &[Leg, Leg, Torso, Head],
        PersonKind::Lying | PersonKind::Reaching => &[Leg, Leg, Torso, Torso, Head, Arm],
        _ => &[Leg, Leg, Torso, Torso, Head, Thing],
    }
}

/// The parts of a person at this moment.
#[must_use]
pub fn body_parts(person: &Person) -> Vec<BodyPart> {
    let h = person.height_m();
    match person.kind {
        PersonKind::Wheelchair => vec![
            block(person, (0.0, 0.0), (0.5, 0.5), (0.35, 0.55)),
            block(person, (-0.1, 0.29), (0.55, 0.05), (0.0, 0.55)),
            block(person, (-0.1, -0.29), (0.55, 0.05), (0.0, 0.55)),
            upright(person, (-0.05, 0.08), (0.5, h - 0.2), 0.14),
            upright(person, (-0.05, -0.08), (0.5, h - 0.2), 0.14),
            head(person, -0.05, h),
            upright(person, (0.35, 0.1), (0.05, 0.5), 0.07),
            upright(person, (0.35, -0.1), (0.05, 0.5), 0.07),
        ],
        PersonKind::Crouching => vec![
            upright(person, (0.1, 0.1), (0.0, 0.5), 0.09),
            upright(person, (0.1, -0.1), (0.0, 0.5), 0.09),
            upright(person, (-0.05, 0.0), (0.2, h - 0.18), 0.19),
            head(person, 0.0, h),
        ],
        PersonKind::Lying => lying(person),
        PersonKind::Reaching => reaching(person),
        kind => {
            let mut parts = walking(person, h);
            match kind {
                PersonKind::Trolley => parts.push(block(person, (0.75, 0.0), (0.85, 0.5), (0.45, 0.95))),
                PersonKind::Luggage => parts.push(block(person, (-0.55, 0.1), (0.3, 0.4), (0.05, 0.65))),
                _ => {}
            }
            parts
        }
    }
}

fn walking(person: &Person, height_m: f32) -> Vec<BodyPart> {
    // Breadth goes with the kind, not with the stature.
    let scale = person.kind.height_m() / 1.75 * person.build.breadth;
    let neck_m = 0.25 * height_m / 1.75;
    let swing = person.swing_m();
    let hip_m = 0.47 * height_m;
    vec![
        leg(person, swing, 0.1 * scale, hip_m, 0.065 * scale),
        leg(person, -swing, -0.1 * scale, hip_m, 0.065 * scale),
        upright(person, (0.0, 0.09 * scale), (hip_m - 0.1, height_m - neck_m), 0.14 * scale),
        upright(person, (0.0, -0.09 * scale), (hip_m - 0.1, height_m - neck_m), 0.14 * scale),
        head(person, 0.02, height_m),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::people::Build;
    use floorguard_types::geometry::Point2;

    #[test]
    fn every_part_is_a_correctly_high_limb() {
        for kind in PersonKind::ALL {
            let person = Person {
                id: 1,
                kind,
                build: Build::SAME,
                position: Point2::new(1.0, 2.0),
                velocity: Point2::default(),
                heading_rad: 0.5,
                gait_rad: 0.0,
                goals: Vec::new(),
                goal: 0,
                speed_mps: 0.0,
                starts_us: 0,
                sees_robot: false,
                walk: None,
            };
            let parts = body_parts(&person);
            assert!(limbs(kind).len() >= parts.len(), "{kind:?}");
            // A ball is a head, a box is an object.
            for (part, limb) in parts.iter().zip(limbs(kind)) {
                match part {
                    BodyPart::Ball(..) => assert_eq!(*limb, Limb::Head, "{kind:?}"),
                    BodyPart::Box(..) => assert_eq!(*limb, Limb::Thing, "{kind:?}"),
                    BodyPart::Capsule(_) => assert!(!matches!(limb, Limb::Head | Limb::Thing), "{kind:?}"),
                }
            }
            let down = Ray::new(
                Vector::new(person.beside(0.2, 0.09).x_m, person.beside(0.2, 0.09).y_m, 3.0),
                -Vector::Z,
            );
            let top_m = parts.iter().filter_map(|part| part.cast(&down, 3.0)).fold(3.0, f32::min);
            assert!(3.0 - top_m <= person.height_m() + 1e-3, "{kind:?}: {top_m}");
        }
    }
}
