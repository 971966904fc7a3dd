//! The camera above the lidar looks up into a mirror: its picture is a ring.

use floorguard_types::geometry::Pose2;
use image::{Rgb, RgbImage};
use parry3d::math::Vector;
use parry3d::query::Ray;

use crate::people::{BodyPart, Person, body_parts};
use crate::scene::Scene;

/// The camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorCamera {
    /// Pixels of a side of the picture.
    pub side: u32,
    /// Where the ring begins and ends, pixels from the middle. The upper elevation is outside.
    pub radii: [f32; 2],
    /// Elevations of the inner and the outer circle, radians.
    pub elevations_rad: [f32; 2],
    /// Height above the floor, metres.
    pub height_m: f32,
}

/// The camera of the rig.
pub const MIRROR: MirrorCamera =
    MirrorCamera { side: 480, radii: [60.0, 230.0], elevations_rad: [-0.75, 0.6], height_m: 0.70 };

/// A picture.
pub type Ring = RgbImage;

/// A person in the picture: directions in the robot's frame, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PersonView {
    /// Right and left end.
    pub azimuths_rad: [f32; 2],
    /// Lower and upper end.
    pub elevations_rad: [f32; 2],
}

/// Farther is dark, metres.
const REACH_M: f32 = 8.0;

impl MirrorCamera {
    /// What it sees from a pose of the robot. The mirror is bent: elevation grows with the square root of the share of the radius
    /// for a part, so that a straight line through both ends would be wrong by some degrees in between.
    #[must_use]
    pub fn picture(&self, scene: &Scene, people: &[Person], robot: Pose2) -> Ring {
        let bodies: Vec<BodyPart> = people.iter().flat_map(body_parts).collect();
        let origin = Vector::new(robot.x_m, robot.y_m, self.height_m);
        let middle = self.side as f32 / 2.0;
        RgbImage::from_fn(self.side, self.side, |x, y| {
            let (dx, dy) = (x as f32 - middle, y as f32 - middle);
            let share = (libm::hypotf(dx, dy) - self.radii[0]) / (self.radii[1] - self.radii[0]);
            if !(0.0..=1.0).contains(&share) {
                return Rgb([0, 0, 0]);
            }
            let elevation = self.elevation_rad(share);
            let azimuth = robot.heading_rad + libm::atan2f(dy, dx);
            let (sin, cos) = libm::sincosf(elevation);
            let direction = Vector::new(cos * libm::cosf(azimuth), cos * libm::sinf(azimuth), sin);
            colour(scene, &bodies, (origin, direction))
        })
    }

    /// Elevation at a share of the ring, from the inner to the outer circle, radians.
    #[must_use]
    pub fn elevation_rad(&self, share: f32) -> f32 {
        let bent = 0.8 * share + 0.2 * share * share;
        self.elevations_rad[0] + bent * (self.elevations_rad[1] - self.elevations_rad[0])
    }

    /// Where people are in it: what a detector would say.
    #[must_use]
    pub fn people(&self, people: &[Person], robot: Pose2) -> Vec<PersonView> {
        let view = |person: &Person| {
            let there = robot.inverse().transform(person.position);
            let distance_m = there.norm().max(0.3);
            let azimuth = libm::atan2f(there.y_m, there.x_m);
            let half = libm::asinf((0.32 / distance_m).min(1.0));
            let elevation = |height_m: f32| libm::atan2f(height_m - self.height_m, distance_m - 0.2);
            PersonView {
                azimuths_rad: [azimuth - half, azimuth + half],
                elevations_rad: [elevation(0.0), elevation(person.height_m() + 0.05)],
            }
        };
        people.iter().map(view).collect()
    }
}

/// Walls grey, floor brown, people blue; the nearer, the brighter.
fn colour(scene: &Scene, bodies: &[BodyPart], (origin, direction): (Vector, Vector)) -> Rgb<u8> {
    let hit = scene.cast(origin, direction, REACH_M).map(|hit| hit.range_m);
    let ray = Ray::new(origin, direction);
    let body = bodies.iter().filter_map(|part| part.cast(&ray, REACH_M)).reduce(f32::min);
    let range_m = hit.unwrap_or(REACH_M).min(body.unwrap_or(REACH_M));
    let bright = 1.0 - 0.7 * range_m / REACH_M;
    let at = origin + direction * range_m;
    let base = match (body, hit) {
        (Some(body_m), _) if body_m <= range_m => [70.0, 110.0, 230.0],
        (_, None) => [20.0, 20.0, 30.0],
        _ if at.z < 0.01 => [170.0, 140.0, 100.0],
        // Furniture is coloured by its place, so that a wrong direction shows.
        _ => {
            let wave = |place: f32| 0.5 + 0.5 * libm::sinf(4.0 * place);
            [200.0, 150.0 + 80.0 * wave(at.y), 150.0 + 80.0 * wave(at.x)]
        }
    };
    Rgb(base.map(|value: f32| (value * bright).clamp(0.0, 255.0) as u8))
}
