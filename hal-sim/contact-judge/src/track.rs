//! What has been: where the robot was, and where people were, for the last minutes and seconds.

use std::collections::VecDeque;

use crate::scene::Person;
use crate::{Brakes, RobotMotion, RobotPose};

/// The robot's path is kept for so long, seconds.
const ROBOT_S: f64 = 120.0;
/// People are kept for so long, seconds: longer than any stop takes.
const PEOPLE_S: f64 = 6.0;
/// And this often, seconds.
const PEOPLE_STEP_S: f64 = 0.02;
/// Nobody farther away from the robot than this matters, metres.
const PEOPLE_M: f32 = 6.0;

/// The robot at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    pub(crate) at_s: f64,
    pub(crate) pose: RobotPose,
    pub(crate) motion: RobotMotion,
    /// Way of the braked wheel since the start, metres.
    pub(crate) path_m: f64,
}

/// The past.
#[derive(Default)]
pub(crate) struct Track {
    robot: VecDeque<Sample>,
    people: VecDeque<(f64, Vec<Person>)>,
}

impl Track {
    /// The robot has come to a pose.
    pub(crate) fn push(&mut self, at_s: f64, pose: RobotPose, (motion, brakes): (RobotMotion, &Brakes)) {
        let path_m = self.robot.back().map_or(0.0, |last| {
            let [from, to] = [last.pose, pose].map(|pose| pose.point(brakes.wheel_m));
            last.path_m + f64::from(libm::hypotf(to[0] - from[0], to[1] - from[1]))
        });
        self.robot.push_back(Sample { at_s, pose, motion, path_m });
        while self.robot.front().is_some_and(|sample| sample.at_s < at_s - ROBOT_S) {
            self.robot.pop_front();
        }
    }

    /// Everybody at a moment.
    pub(crate) fn push_people(&mut self, at_s: f64, people: &[Person]) {
        if self.people.back().is_some_and(|(last_s, _)| at_s - last_s < PEOPLE_STEP_S - 1.0e-6) {
            return;
        }
        let here = self.robot.back().map(|sample| sample.pose).unwrap_or_default();
        let is_near = |person: &&Person| {
            let [x, y] = person.middle_m();
            libm::hypotf(x - here.x_m, y - here.y_m) < PEOPLE_M
        };
        self.people.push_back((at_s, people.iter().filter(is_near).cloned().collect()));
        while self.people.front().is_some_and(|(old_s, _)| *old_s < at_s - PEOPLE_S) {
            self.people.pop_front();
        }
    }

    /// The last moment.
    pub(crate) fn last(&self) -> Option<&Sample> {
        self.robot.back()
    }

    /// The first moment that is still known, seconds.
    pub(crate) fn first_s(&self) -> f64 {
        self.robot.front().map_or(0.0, |sample| sample.at_s)
    }

    /// The robot at a time; the first or last that is known outside of the past.
    pub(crate) fn at(&self, at_s: f64) -> Option<Sample> {
        let next = self.robot.partition_point(|sample| sample.at_s <= at_s);
        self.mixed(next, |sample| sample.at_s, at_s)
    }

    /// Where the robot was when the braked wheel had come so far.
    pub(crate) fn at_way(&self, path_m: f64) -> Option<RobotPose> {
        let next = self.robot.partition_point(|sample| sample.path_m <= path_m);
        self.mixed(next, |sample| sample.path_m, path_m).map(|sample| sample.pose)
    }

    fn mixed(&self, next: usize, of: impl Fn(&Sample) -> f64, value: f64) -> Option<Sample> {
        let Some(before) = next.checked_sub(1).and_then(|at| self.robot.get(at)) else {
            return self.robot.front().copied();
        };
        let Some(after) = self.robot.get(next) else { return Some(*before) };
        let span = of(after) - of(before);
        let share = if span > 1.0e-9 { ((value - of(before)) / span) as f32 } else { 0.0 };
        let mix = |a: f32, b: f32| a + share * (b - a);
        Some(Sample {
            at_s: before.at_s + f64::from(share) * (after.at_s - before.at_s),
            pose: before.pose.between(after.pose, share),
            motion: RobotMotion {
                forward_mps: mix(before.motion.forward_mps, after.motion.forward_mps),
                turn_radps: mix(before.motion.turn_radps, after.motion.turn_radps),
            },
            path_m: before.path_m + f64::from(share) * (after.path_m - before.path_m),
        })
    }

    /// Everybody near the robot at about a time.
    pub(crate) fn people_at(&self, at_s: f64) -> &[Person] {
        let next = self.people.partition_point(|(then_s, _)| *then_s <= at_s + PEOPLE_STEP_S / 2.0);
        self.people.get(next.saturating_sub(1)).map_or(&[], |(_, people)| people)
    }

    /// A person at about a time; after the last moment it goes on as it did.
    pub(crate) fn person_at(&self, id: u32, at_s: f64) -> Option<Person> {
        let found = self.people_at(at_s).iter().find(|person| person.id == id)?;
        let last_s = self.people.back().map_or(at_s, |(last_s, _)| *last_s);
        Some(if at_s > last_s { found.after((at_s - last_s) as f32) } else { found.clone() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn past_is_queried_by_time_and_distance() {
        let brakes = Brakes { response_s: 0.0, deceleration_mps2: 1.0, wheel_m: [0.8, 0.0] };
        let motion = RobotMotion { forward_mps: 0.5, turn_radps: 0.0 };
        let mut track = Track::default();
        for step in 0..200_u16 {
            let at_s = f64::from(step) * 0.01;
            track.push(at_s, RobotPose { x_m: 0.5 * at_s as f32, ..RobotPose::default() }, (motion, &brakes));
        }
        let then = track.at(0.505).unwrap();
        assert!((then.pose.x_m - 0.2525).abs() < 1e-5 && (then.path_m - 0.2525).abs() < 1e-5, "{then:?}");
        assert!((track.at_way(0.3).unwrap().x_m - 0.3).abs() < 1e-5);
        assert!((track.at(9.0).unwrap().pose.x_m - 0.995).abs() < 1e-5);
    }

    #[test]
    fn a_person_goes_on_after_the_last_moment() {
        let brakes = Brakes { response_s: 0.0, deceleration_mps2: 1.0, wheel_m: [0.0, 0.0] };
        let mut track = Track::default();
        track.push(1.0, RobotPose::default(), (RobotMotion::default(), &brakes));
        let solid = crate::Solid::Ball { centre_m: [1.0, 0.0, 1.0], radius_m: 0.2 };
        let limbs = vec![crate::Limb { name: crate::LimbName::Torso, solid }];
        track.push_people(1.0, &[Person { id: 4, kind: "adult", velocity_mps: [1.0, 0.0], limbs }]);
        let later = track.person_at(4, 1.5).unwrap();
        assert!((later.middle_m()[0] - 1.5).abs() < 1e-5);
        assert!(track.person_at(5, 1.5).is_none());
    }
}
