//! One walking person.

use floorguard_types::geometry::Point2;

use super::{Build, PersonKind, RecordedWalk};

/// A person.
#[derive(Clone, Debug)]
pub struct Person {
    /// Number in the scenario, from 1.
    pub id: u32,
    /// Who it is.
    pub kind: PersonKind,
    /// How this one differs from others of the kind.
    pub build: Build,
    /// Middle of the body, world frame, metres.
    pub position: Point2,
    /// World frame, m/s.
    pub velocity: Point2,
    /// Where the person looks, radians.
    pub heading_rad: f32,
    /// Phase of the gait, radians.
    pub gait_rad: f32,
    /// Places to walk to, one after the other, over and over.
    pub goals: Vec<Point2>,
    /// Index of the present goal.
    pub goal: usize,
    /// m/s; 0 stands.
    pub speed_mps: f32,
    /// Stands until then, microseconds.
    pub starts_us: u64,
    /// Walks around the robot; an inattentive person does not.
    pub sees_robot: bool,
    /// Follows this path at these times, whatever happens; instead of the goals.
    pub walk: Option<RecordedWalk>,
}

impl Person {
    /// Metres.
    #[must_use]
    pub fn height_m(&self) -> f32 {
        self.kind.height_m() * self.build.stature
    }

    /// Radius of the body seen from above, metres.
    #[must_use]
    pub fn radius_m(&self) -> f32 {
        self.kind.radius_m() * self.build.breadth
    }

    /// Moves on by its velocity and swings its legs.
    pub fn advance(&mut self, step_s: f32) {
        self.position.x_m += self.velocity.x_m * step_s;
        self.position.y_m += self.velocity.y_m * step_s;
        self.swing(step_s);
    }

    /// Looks where it goes and moves its legs.
    pub(super) fn swing(&mut self, step_s: f32) {
        let speed = self.velocity.norm();
        if speed > 0.05 {
            self.heading_rad = libm::atan2f(self.velocity.y_m, self.velocity.x_m);
            // A pair of steps covers about 0.7 m plus half a second's travel: 1.3 m at walking speed.
            let stride_m = 0.7 + 0.5 * speed;
            self.gait_rad += core::f32::consts::TAU * speed * step_s / stride_m;
            self.gait_rad %= core::f32::consts::TAU;
        }
    }

    /// How far the feet swing before and behind the hip, metres.
    #[must_use]
    pub fn swing_m(&self) -> f32 {
        let reach = 0.25 * self.height_m() / 1.75;
        reach * (self.velocity.norm() / 1.2).min(1.2) * libm::sinf(self.gait_rad)
    }

    /// Middle of the left and the right foot on the floor, world frame.
    #[must_use]
    pub fn feet(&self) -> [Point2; 2] {
        let swing = self.swing_m();
        [self.beside(swing, 0.1), self.beside(-swing, -0.1)]
    }

    /// A point ahead and to the left of the middle, world frame.
    #[must_use]
    pub fn beside(&self, ahead_m: f32, left_m: f32) -> Point2 {
        let (sin, cos) = libm::sincosf(self.heading_rad);
        Point2::new(
            self.position.x_m + cos * ahead_m - sin * left_m,
            self.position.y_m + sin * ahead_m + cos * left_m,
        )
    }
}
