//! One walking person.

use floorguard_types::geometry::{Point2, wrap_angle};

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
            let course_rad = libm::atan2f(self.velocity.y_m, self.velocity.x_m);
            self.heading_rad = match self.kind.turns_radps() {
                // Somebody who wavers at a goal does not swing a trolley round in a step.
                Some(radps) => {
                    let most_rad = radps * step_s;
                    let turn_rad = wrap_angle(course_rad - self.heading_rad).clamp(-most_rad, most_rad);
                    wrap_angle(self.heading_rad + turn_rad)
                }
                None => course_rad,
            };
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Who steps to and fro around a goal for ten seconds, 0.1 m/s, half of a step of 10 ms each way.
    fn turned_rad(kind: PersonKind) -> f32 {
        let mut person = Person {
            id: 1,
            kind,
            build: Build::SAME,
            position: Point2::default(),
            velocity: Point2::default(),
            heading_rad: 1.6,
            gait_rad: 0.0,
            goals: Vec::new(),
            goal: 0,
            speed_mps: 1.0,
            starts_us: 0,
            sees_robot: false,
            walk: None,
        };
        let mut farthest_rad = 0.0_f32;
        for step in 0..1_000 {
            let y_m = if step % 2 == 0 { 0.1 } else { -0.1 };
            person.velocity = Point2::new(0.001, y_m);
            person.swing(0.01);
            farthest_rad = farthest_rad.max(wrap_angle(person.heading_rad - 1.6).abs());
        }
        farthest_rad
    }

    #[test]
    fn trolley_does_not_turn_round_in_a_step() {
        assert!(turned_rad(PersonKind::Trolley) < 0.1);
        assert!(turned_rad(PersonKind::Adult) > 3.0);
    }
}
