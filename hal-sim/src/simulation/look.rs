//! The true state of a running world, for judges.

use floorguard_types::geometry::Point2;
use floorguard_types::time::Stamp;
use parry3d::math::Vector;

use super::Simulation;
use super::truth::{PersonTruth, Truth};
use crate::people::{Person, body_discs, ground_discs};
use crate::robot::RobotParameters;
use crate::scene::Scene;
use crate::scene::distance_to_area;

impl Simulation {
    /// The last moment played, microseconds.
    #[must_use]
    pub const fn now_us(&self) -> u64 {
        self.now_us
    }

    /// The robot as its file says that it is: without what the scenario has misplaced.
    #[must_use]
    pub const fn nominal(&self) -> &RobotParameters {
        &self.nominal
    }

    /// What stands, for judges and sensors.
    #[must_use]
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Everybody at the last moment played.
    #[must_use]
    pub fn people(&self) -> &[Person] {
        &self.crowd.people
    }

    /// The true state at the last moment played.
    #[must_use]
    pub fn truth(&self) -> Truth {
        let robot = self.body.pose();
        let people: Vec<PersonTruth> =
            self.crowd.people.iter().map(|person| self.person_truth(person)).collect();
        let gap = |person: &PersonTruth| {
            let in_robot = robot.inverse().transform(person.position);
            (distance_to_area(&self.parameters.footprint, in_robot) - person.radius_m).max(0.0)
        };
        let touching = people.iter().filter(|person| gap(person) <= 0.0).map(|person| person.id).collect();
        Truth {
            stamp: Stamp::from_micros(self.now_us),
            robot,
            twist: self.body.twist(),
            steering_rad: self.body.steering_rad(),
            nearest_person_m: people.iter().map(gap).fold(f32::INFINITY, f32::min),
            touching,
            people,
            emergency_stop: self.bus.power_cut(),
        }
    }

    /// Points on standing objects around the robot at the scanner's height, robot frame, one per 2°, within a
    /// range.
    #[must_use]
    pub fn obstacles_in_robot(&self, range_m: f32) -> Vec<Point2> {
        self.obstacles_at_height(self.parameters.scanner.z_m, range_m)
    }

    /// The same at any height above the floor, metres.
    #[must_use]
    pub fn obstacles_at_height(&self, height_m: f32, range_m: f32) -> Vec<Point2> {
        let robot = self.body.pose();
        let mount = self.parameters.scanner;
        let origin = robot.transform(Point2::new(mount.x_m, mount.y_m));
        let at = Vector::new(origin.x_m, origin.y_m, height_m);
        let beam = |step: u16| {
            let bearing = (f32::from(step) * 2.0).to_radians();
            let (sin, cos) = libm::sincosf(bearing + robot.heading_rad);
            let hit = self.scene.cast(at, Vector::new(cos, sin, 0.0), range_m)?;
            let (sin, cos) = libm::sincosf(bearing);
            Some(Point2::new(mount.x_m + hit.range_m * cos, mount.y_m + hit.range_m * sin))
        };
        (0..180).filter_map(beam).collect()
    }

    /// Level beams at both heights above the floor meet the same standing objects, metres.
    #[must_use]
    pub fn is_same_at_heights(&self, one_m: f32, other_m: f32) -> bool {
        self.scene.is_same_at_heights(one_m, other_m)
    }

    fn person_truth(&self, person: &Person) -> PersonTruth {
        PersonTruth {
            id: person.id,
            kind: person.kind,
            position: person.position,
            velocity: person.velocity,
            feet: person.feet(),
            radius_m: person.radius_m(),
            height_m: person.height_m(),
            ground_discs: ground_discs(person),
            body_discs: body_discs(person),
            in_sight: self.is_in_sight(person),
        }
    }

    /// A beam from the lidar to the person's chest meets nothing that stands still.
    fn is_in_sight(&self, person: &Person) -> bool {
        let mount = self.parameters.lidar;
        let viewpoint = self.body.pose().transform(Point2::new(mount.x_m, mount.y_m));
        let from = Vector::new(viewpoint.x_m, viewpoint.y_m, mount.z_m);
        let chest = Vector::new(person.position.x_m, person.position.y_m, 0.7 * person.height_m());
        let path = chest - from;
        let distance_m = path.length();
        distance_m < 0.1 || self.scene.cast(from, path / distance_m, distance_m - 0.05).is_none()
    }
}
