//! How long people are waited for, and the retreat from a person who stands too near: a short straight path, backwards or
//! ahead, whichever the guard permits.
//!
//! The guard judges the requested velocity: while a person stands where a turn or an arc would lead, it holds the robot
//! as long as that turn is requested. A request that leads away is permitted, and from there every path is open again.

use floorguard_guard::{AdvisedPerson, Body as GuardBody, Cause, DriveLimits};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::motion::{Gear, Waypoint};

use super::mission::Cleaner;
use super::surroundings::Surroundings;
use super::track::Track;

/// Held for this long by somebody who stands there, the robot leaves, seconds. Most people who stop before a robot go on before.
const AFTER_S: f32 = 5.0;
/// Held by the guard for so long, the robot takes a detour, seconds. For people a detour costs more than it gains before: most of them are
/// gone by then, and it is turned slowly. What merely stands there stays.
const PATIENCE_S: f32 = 2.0;
const PATIENCE_WITH_PEOPLE_S: f32 = 6.0;
/// Older than this, what is known of people says nothing of who stands there now, seconds.
const FRESH_S: f32 = 0.5;
/// Who walks faster than this is gone in a moment, m/s.
pub(super) const STANDS_MPS: f32 = 0.25;
/// A person farther away is not the one that holds the robot, metres from its body.
const NEAR_M: f32 = 1.2;
/// Steps of the retreat, and how long one is, metres: no farther than what was seen beside the rear stays known (FG-REQ-064).
const STEPS: i8 = 2;
const STEP_M: f32 = 0.12;
/// Slowly, m/s.
const SPEED_MPS: f32 = 0.2;
/// Later than the guard asks for by this, for the doubt of the tracks, seconds.
const DOUBT_S: f32 = 0.1;

/// The people that the robot knows of, and the guard's own question: would this motion reach somebody before it ends?
#[derive(Clone, Debug)]
pub struct PeopleNear {
    /// Odometry frame.
    pub people: Vec<AdvisedPerson>,
    /// When they were seen, seconds of the mission.
    pub seen_s: f32,
    /// On a retreat from a person, until another path is chosen.
    pub is_leaving: bool,
    body: GuardBody,
    drive: DriveLimits,
}

impl PeopleNear {
    /// Nobody is known yet.
    pub fn of(robot: &RobotConfiguration) -> Self {
        Self {
            people: Vec::new(),
            seen_s: f32::NEG_INFINITY,
            is_leaving: false,
            body: GuardBody::around(&robot.geometry.footprint),
            drive: robot.guard().drive,
        }
    }

    /// The guard would let the robot drive like this, as far as these people are concerned; they in the robot's frame.
    fn is_let(&self, people: &[AdvisedPerson], twist: Twist2) -> bool {
        let clear_s = self.drive.clear_of_people_s(twist.linear_mps.abs()) + DOUBT_S;
        people.iter().all(|person| {
            // What is no number is no licence.
            if !person.is_finite() {
                return false;
            }
            let [soonest_s, _] = self.body.times_to_person_s(person, twist);
            soonest_s >= clear_s || self.body.recedes_from(person, twist)
        })
    }
}

impl Cleaner {
    /// The people that the robot knows of, in its own frame.
    fn people_in_robot(&self) -> Vec<AdvisedPerson> {
        let to_robot = self.odometry.pose_in_odometry.inverse();
        let turn = Pose2::new(0.0, 0.0, to_robot.heading_rad);
        let in_robot = |person: &AdvisedPerson| AdvisedPerson {
            position: to_robot.transform(person.position),
            velocity_mps: turn.transform(person.velocity_mps),
            ..*person
        };
        self.near.people.iter().map(in_robot).collect()
    }

    /// Held by the guard for so long the robot takes a detour, seconds.
    pub(super) fn patience_s(&self, now_s: f32) -> f32 {
        let is_for_people = match self.held_by {
            Some(Cause::CollisionStop) => true,
            // The guard remembers it: nobody who walks on takes it along.
            Some(Cause::WayClosed) => false,
            _ => self.is_someone_near(now_s),
        };
        if is_for_people { PATIENCE_WITH_PEOPLE_S } else { PATIENCE_S }
    }

    /// A person who is known at this moment may be what holds the robot.
    fn is_someone_near(&self, now_s: f32) -> bool {
        let is_near = |person: &AdvisedPerson| {
            !person.is_finite() || self.near.body.distance_m(person.position) < NEAR_M
        };
        now_s - self.near.seen_s <= FRESH_S && self.people_in_robot().iter().any(is_near)
    }

    /// Retreats, if a person who stands near holds the robot and a straight path leads away.
    pub(super) fn retreat(&mut self, pose: Pose2, now_s: f32) {
        let is_known = now_s - self.near.seen_s <= FRESH_S;
        if self.held_s < AFTER_S || self.near.is_leaving || !is_known {
            return;
        }
        let people = self.people_in_robot();
        let is_near = |person: &&AdvisedPerson| self.near.body.distance_m(person.position) < NEAR_M;
        if !people.iter().filter(is_near).any(|person| person.velocity_mps.norm() < STANDS_MPS) {
            return;
        }
        let around = Surroundings::new(&self.ground, (&self.obstacles, now_s), pose);
        let paths = [(Gear::Back, -1.0), (Gear::Ahead, 1.0)].into_iter().filter_map(|(gear, sign)| {
            let twist = Twist2 { linear_mps: sign * SPEED_MPS, angular_radps: 0.0 };
            if !self.near.is_let(&people, twist) {
                return None;
            }
            let place = |step: i8| pose.compose(Pose2::new(sign * STEP_M * f32::from(step), 0.0, 0.0));
            let free = (1..=STEPS).take_while(|step| around.is_free(place(*step), gear)).count();
            let path = (0..=free as i8).map(|step| Waypoint { pose_in_map: place(step), gear });
            Some(path.collect::<Vec<Waypoint>>())
        });
        let Some(path) = paths.filter(|path| path.len() > 1).max_by_key(Vec::len) else { return };
        self.held_s = 0.0;
        self.detours += 1;
        self.near.is_leaving = true;
        self.target = None;
        self.lanes.break_off(Point2::new(pose.x_m, pose.y_m), now_s);
        self.track = Track::new(path);
    }
}

/// Middle of a person on the map and what is kept around it, metres: of one who stands, what the guard keeps.
pub(super) fn keep_out_disc(person: &AdvisedPerson, place: Point2) -> (Point2, f32) {
    /// Half a person; the footprint of the robot has a margin of its own.
    const WALKS_M: f32 = 0.15;
    /// A body of 0.3 m, two standard deviations of its place, and half a second of the robot's travel.
    const STANDS_M: f32 = 0.33;
    (place, if person.velocity_mps.norm() < STANDS_MPS { STANDS_M } else { WALKS_M })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::cleaner::mission::SharedWatch;
    use crate::cleaner::plan::MissionPlan;
    use crate::cleaner::store::Store;
    use floorguard_configuration::{EXAMPLE, parse};
    use floorguard_perception::people::TrackStatus;
    use floorguard_runtime::shared::{PeopleReport, PersonReport};
    use floorguard_types::time::Stamp;

    fn advised_person(x_m: f32, y_m: f32, walks_mps: f32) -> AdvisedPerson {
        AdvisedPerson {
            position: Point2::new(x_m, y_m),
            velocity_mps: Point2::new(walks_mps, 0.0),
            position_sigma_m: 0.07,
            ..AdvisedPerson::default()
        }
    }

    /// The path of a robot that a person holds.
    fn path_from(person: AdvisedPerson, held_s: f32) -> Vec<Waypoint> {
        path_from_seen_person(person, 0.1, held_s)
    }

    /// A robot in the aisle of a supermarket.
    fn in_an_aisle() -> Cleaner {
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let plan = MissionPlan::supermarket();
        let store = Store::Memory(Arc::default());
        Cleaner::new(&plan, &robot, (SharedWatch::default(), store)).unwrap()
    }

    fn path_from_seen_person(person: AdvisedPerson, seen_ago_s: f32, held_s: f32) -> Vec<Waypoint> {
        let mut cleaner = in_an_aisle();
        let pose = cleaner.pose();
        cleaner.near.people = vec![person];
        cleaner.near.seen_s = -seen_ago_s;
        let place = pose.transform(person.position);
        cleaner.obstacles.see_people(&[keep_out_disc(&person, place)], -seen_ago_s);
        cleaner.held_s = held_s;
        cleaner.retreat(pose, 0.0);
        assert_eq!(cleaner.near.is_leaving, !cleaner.track.is_over());
        cleaner.track.rest().to_vec()
    }

    #[test]
    fn retreats_from_standing_waits_for_walking_people() {
        let back = path_from(advised_person(1.55, 0.3, 0.0), AFTER_S + 0.5);
        assert!(
            back.iter().all(|at| at.gear == Gear::Back) && back.last().unwrap().pose_in_map.x_m < -0.2,
            "{back:?}"
        );
        let on = path_from(advised_person(-1.2, 0.1, 0.0), AFTER_S + 0.5);
        assert!(
            on.iter().all(|at| at.gear == Gear::Ahead) && on.last().unwrap().pose_in_map.x_m > 0.2,
            "{on:?}"
        );
        assert!(
            path_from(advised_person(1.55, 0.3, 0.0), AFTER_S - 0.5).is_empty(),
            "at once the guard may let it go"
        );
        assert!(
            path_from(advised_person(1.55, 0.3, -1.0), AFTER_S + 0.5).is_empty(),
            "who walks is gone in a moment"
        );
        assert!(
            path_from(advised_person(0.3, 0.5, 0.0), AFTER_S + 0.5).is_empty(),
            "a person in contact blocks every path"
        );
        assert!(
            path_from(advised_person(4.0, 0.0, 0.0), AFTER_S + 0.5).is_empty(),
            "somebody far away does not hold it"
        );
        let before = path_from_seen_person(advised_person(1.55, 0.3, 0.0), 0.6, AFTER_S + 0.5);
        assert!(before.is_empty(), "a person seen a while ago may stand behind it by now");
        let nowhere = AdvisedPerson { position_sigma_m: f32::NAN, ..advised_person(1.55, 0.3, 0.0) };
        assert!(path_from(nowhere, AFTER_S + 0.5).is_empty(), "what is no number is no licence");
    }

    /// A standing person gets the clearance that the guard keeps, a walking one less, because they will be
    /// gone in a moment.
    #[test]
    fn standing_people_get_more_clearance() {
        let keep_out_m =
            |walks_mps: f32| keep_out_disc(&advised_person(1.0, 0.0, walks_mps), Point2::default()).1;
        assert!(keep_out_m(0.0) > 0.3 && keep_out_m(0.0) - keep_out_m(1.0) > 0.1);
    }

    /// The last output of perception, repeated while it is silent or has a future stamp.
    #[test]
    fn last_seen_person_expires() {
        let mut cleaner = in_an_aisle();
        let place = cleaner.odometry.pose_in_odometry.transform(Point2::new(1.55, 0.3));
        let mut report = PeopleReport::default();
        let person = PersonReport {
            id: 1,
            status: TrackStatus::Confirmed,
            position: place,
            velocity_mps: Point2::default(),
            position_sigma_m: 0.07,
            velocity_sigma_mps: 0.1,
            person_probability: 0.9,
            moving_probability: 0.0,
            sensors: Default::default(),
            explanation: None,
        };
        report.people.push(person).unwrap();
        let moment = |now_ms: u64| (Stamp::from_micros(now_ms * 1_000), now_ms as f32 * 1.0e-3);
        let mut at = |measured_ms: u64, now_ms: u64| {
            report.sweep.stamp = moment(measured_ms).0;
            cleaner.see_people(&report, moment(now_ms));
            cleaner.held_s = AFTER_S + 0.5;
            cleaner.near.is_leaving = false;
            cleaner.track = Track::default();
            cleaner.retreat(cleaner.pose(), moment(now_ms).1);
            let places = cleaner.obstacles.places(moment(now_ms).1).len();
            // Obstacles are left out of the match with the map, too.
            assert_eq!(cleaner.is_on_person(place, moment(now_ms).1), places > 0);
            (places, cleaner.near.is_leaving)
        };
        assert_eq!(at(1_000, 1_100), (1, true), "there, and to be left");
        assert_eq!(at(1_000, 2_000), (1, false), "there, but nobody knows who else is");
        assert_eq!(at(1_000, 4_900), (1, false));
        assert_eq!(at(1_000, 5_100), (0, false), "a stale report blocks no path");
        assert_eq!(at(6_001, 6_000), (1, true), "rounding is no time to come");
        assert_eq!(at(9_000, 7_000), (1, false), "who is measured in two seconds is not seen again");
        assert_eq!(at(9_000, 9_300), (1, true), "by then it is past");
        assert_eq!(at(90_000, 14_500), (0, false), "a clock that leapt keeps nobody there");
    }
}
