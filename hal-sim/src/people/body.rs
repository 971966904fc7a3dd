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
