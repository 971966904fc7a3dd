//! The world as a beam sees it at one moment.

use floorguard_types::geometry::{Pose2, wrap_angle};
use parry3d::math::Vector;
use parry3d::query::Ray;

use crate::people::{BodyPart, Clothes, PLAIN, Person, body_parts};
use crate::robot::{RobotBody, SensorMount};
use crate::scene::{Hit, Scene};

/// Nothing of a person reaches further from the middle of the body than this (a trolley's front end), metres.
const REACH_M: f32 = 1.25;

struct Seen {
    parts: Vec<BodyPart>,
    bearing_rad: f32,
    half_angle_rad: f32,
    /// Where the person stands and looks, and what it wears; `None`: nothing that matters.
    worn: Option<(Pose2, Clothes)>,
}

impl Seen {
    /// What a part throws back where a beam meets it.
    fn reflectivity(&self, part: usize, at: Vector) -> u8 {
        self.worn.map_or(PLAIN, |(stands, clothes)| {
            let around_rad = libm::atan2f(at.y - stands.y_m, at.x - stands.x_m) - stands.heading_rad;
            clothes.reflectivity(part, at.z, around_rad)
        })
    }
}

/// Scene, people and the moving sensor.
pub struct View<'a> {
    scene: &'a Scene,
    robot: &'a RobotBody,
    mount: SensorMount,
    seen: Vec<Seen>,
}

impl<'a> View<'a> {
    /// Prepares bodies and their angular extents for a sensor on the robot; people beyond `range_max_m` are left out.
    #[must_use]
    pub fn new(
        scene: &'a Scene,
        people: &[Person],
        (robot, mount): (&'a RobotBody, SensorMount),
        range_max_m: f32,
    ) -> Self {
        let origin = robot.pose().compose(Pose2::new(mount.x_m, mount.y_m, 0.0));
        let seen = people.iter().filter_map(|person| {
            let (dx, dy) = (person.position.x_m - origin.x_m, person.position.y_m - origin.y_m);
            let distance = libm::hypotf(dx, dy);
            if distance > range_max_m {
                return None;
            }
            let half_angle_rad = if distance > REACH_M + 0.1 {
                libm::asinf(REACH_M / distance) + 0.02
            } else {
                core::f32::consts::PI
            };
            let bearing_rad = libm::atan2f(dy, dx);
            let stands = Pose2::new(person.position.x_m, person.position.y_m, person.heading_rad);
            let worn = person.build.clothes.map(|clothes| (stands, clothes));
            Some(Seen { parts: body_parts(person), bearing_rad, half_angle_rad, worn })
        });
        Self { scene, robot, mount, seen: seen.collect() }
    }

    /// The sensor's place `ahead_s` after the last step of the robot.
    #[must_use]
    pub fn sensor(&self, ahead_s: f32) -> Pose2 {
        let mount = Pose2::new(self.mount.x_m, self.mount.y_m, self.mount.yaw_rad);
        self.robot.pose_ahead(ahead_s).compose(mount)
    }

    /// Bodies that a beam of this world bearing may meet.
    pub fn candidates(&self, bearing_rad: f32, found: &mut Vec<usize>) {
        found.clear();
        for (index, seen) in self.seen.iter().enumerate() {
            if wrap_angle(bearing_rad - seen.bearing_rad).abs() < seen.half_angle_rad {
                found.push(index);
            }
        }
    }

    /// Casts a beam from the sensor at a bearing of the world, and the sine and cosine of an elevation.
    #[must_use]
    pub fn cast(
        &self,
        sensor: Pose2,
        (bearing_rad, (sin_e, cos_e)): (f32, (f32, f32)),
        candidates: &[usize],
        range_max_m: f32,
    ) -> Option<Hit> {
        let (sin_b, cos_b) = libm::sincosf(bearing_rad);
        let direction = Vector::new(cos_e * cos_b, cos_e * sin_b, sin_e);
        let origin = Vector::new(sensor.x_m, sensor.y_m, self.mount.z_m);
        let mut nearest = self.scene.cast(origin, direction, range_max_m);
        let ray = Ray::new(origin, direction);
        let mut on_body = None;
        for seen in candidates.iter().filter_map(|index| self.seen.get(*index)) {
            for (index, part) in seen.parts.iter().enumerate() {
                let limit = nearest.map_or(range_max_m, |hit| hit.range_m);
                if let Some(range_m) = part.cast(&ray, limit).filter(|range_m| *range_m < limit) {
                    nearest = Some(Hit { range_m, reflectivity: PLAIN });
                    on_body = Some((seen, index));
                }
            }
        }
        if let (Some(hit), Some((seen, part))) = (&mut nearest, on_body) {
            hit.reflectivity = seen.reflectivity(part, origin + direction * hit.range_m);
        }
        nearest
    }
}
