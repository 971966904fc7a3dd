//! What the mission hears and sees: where it is, what the brush picks up, who and what stands on the path.

use floorguard_guard::{AdvisedPerson, FUTURE_TOLERANCE_US};
use floorguard_guard::{FloorSight, OBSTACLE_HEIGHT_MIN_M};
use floorguard_perception::people::TrackStatus;
use floorguard_runtime::shared::{PeopleReport, StampedPose};
use floorguard_runtime::tasks::PERSON_PROBABILITY_MIN;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{DirtReading, Scan};
use floorguard_types::time::{Age, Stamp};

use super::mission::Cleaner;
use super::obstacles::FADES_S;
use super::plan::MissionStrategy;
use super::retreat::keep_out_disc;
use super::track::Track;
use crate::site::ends_of;

/// While the pose is not trusted a scan is taken in this often even if the robot stands, seconds.
const RETRY_S: f32 = 0.2;
/// Without a word of the dirt sensor for this long nothing counts as cleaned, microseconds.
const DEAF_US: u64 = 500_000;
/// One beam in this many is matched with the map.
const BEAM_INTERVAL: usize = 9;
/// Beams that end this near to somebody are no part of the map, metres: a body, its luggage or its trolley.
const PERSON_M: f32 = 0.8;
/// A place this far from all that is on the map is the middle of a free floor, metres.
const MIDDLE_M: f32 = 0.6;
/// What is higher than this the scanner sees, metres.
const LOW_M: f32 = 0.14;

impl Cleaner {
    pub(super) fn remember(&mut self, pose: StampedPose) {
        let before = std::mem::replace(&mut self.odometry, pose);
        let (from, to) = (before.pose_in_odometry, pose.pose_in_odometry);
        self.distance_m += libm::hypotf(to.x_m - from.x_m, to.y_m - from.y_m);
        self.poses.push(pose);
    }

    /// What the dirt sensor has counted since it was asked last; a sensor that is silent leaves everything open.
    pub(super) fn hear(&mut self, dirt: Option<DirtReading>, now: Stamp) {
        let fresh = dirt.filter(|dirt| matches!(dirt.stamp.age(now), Age::Past(us) if us <= DEAF_US));
        let hits = match (self.dirt, fresh) {
            (Some(before), Some(dirt)) => dirt.hits_since(&before),
            (None, Some(_)) => Some(0),
            (_, None) => None,
        };
        self.localiser.collect(hits.map_or(0, u32::from), hits.is_none());
        self.localiser.brush_turns = fresh.is_some_and(|dirt| dirt.brush_turns);
        self.dirt = fresh.or(self.dirt);
    }

    /// A scan, at the pose where it was measured.
    pub(super) fn see(&mut self, scan: &Scan, now_s: f32) {
        let odometry = self.odometry_at(scan.stamp);
        let is_lost = !self.localiser.is_trusted();
        if self.localiser.is_due(odometry) || (is_lost && now_s >= self.next_retry_s) {
            self.next_retry_s = now_s + RETRY_S;
            let interval = if is_lost { BEAM_INTERVAL / 3 } else { BEAM_INTERVAL };
            // A customer is not on the map, and says nothing of where the robot is; nor does what stands in the middle of a
            // free floor. Beams that end behind a wall do.
            let guess = self.localiser.pose(odometry);
            let is_no_wall = |end: &Point2| {
                self.is_on_person(odometry.transform(*end), now_s)
                    || self.ground.floor.clearance.clearance_m(guess.transform(*end)) > MIDDLE_M
            };
            let ends = ends_of(scan, interval).map(|end| self.scanner_mount.in_base.transform(end));
            let matched: Vec<Point2> = ends.filter(|end| !is_no_wall(end)).collect();
            self.localiser.update(&self.ground.floor, odometry, &matched, true);
        }
        let pose = self.localiser.pose(odometry);
        self.obstacles.see(&self.ground.floor, pose.compose(self.scanner_mount.in_base), (scan, now_s));
    }

    /// Somebody was there a moment ago, odometry frame.
    pub(super) fn is_on_person(&self, place: Point2, now_s: f32) -> bool {
        let is_recent = now_s - self.near.seen_s <= FADES_S;
        is_recent && self.people_seen.iter().any(|person| person.distance(place) < PERSON_M)
    }

    /// People are obstacles where they are, also behind the robot, outside the scanner's field of view. While
    /// perception is silent its last word grows old, and a word from the future is none.
    pub(super) fn see_people(&mut self, people: &PeopleReport, (now, now_s): (Stamp, f32)) {
        let age_us = match people.sweep.stamp.age(now) {
            Age::Past(age_us) => age_us,
            Age::Future(ahead_us) if ahead_us <= FUTURE_TOLERANCE_US => 0,
            Age::Future(_) => return,
        };
        let seen_s = now_s - age_us as f32 * 1.0e-6;
        self.near.seen_s = seen_s;
        let confirmed = || people.people.iter().filter(|person| person.status == TrackStatus::Confirmed);
        self.people_seen = confirmed().map(|person| person.position).collect();
        let real = confirmed().filter(|person| {
            person.person_probability >= PERSON_PROBABILITY_MIN && person.explanation.is_none()
        });
        let advised = real.map(|person| AdvisedPerson {
            id: person.id,
            position: person.position,
            velocity_mps: person.velocity_mps,
            position_sigma_m: person.position_sigma_m,
            velocity_sigma_mps: person.velocity_sigma_mps,
        });
        self.near.people = advised.collect();
        let to_map = self.pose().compose(self.odometry.pose_in_odometry.inverse());
        let places: Vec<(Point2, f32)> = self
            .near
            .people
            .iter()
            .map(|person| keep_out_disc(person, to_map.transform(person.position)))
            .collect();
        self.obstacles.see_people(&places, seen_s);
    }

    /// Low objects on the floor, which neither lidar nor scanner sees, are driven round; higher ones those
    /// see.
    pub(super) fn see_floor(&mut self, floor: &FloorSight, now_s: f32) {
        if !floor.is_known {
            return;
        }
        let low = floor
            .obstacles
            .iter()
            .filter(|obstacle| (OBSTACLE_HEIGHT_MIN_M..LOW_M).contains(&obstacle.height_m));
        let obstacles: Vec<(Point2, f32)> =
            low.map(|obstacle| (obstacle.position, obstacle.half_width_m)).collect();
        let pose = self.localiser.pose(self.odometry_at(floor.stamp));
        if self.obstacles.see_obstacles(&self.ground.floor, pose, (&obstacles, now_s))
            && self.plan.strategy == MissionStrategy::Guarantee
        {
            self.detours += 1;
            self.track = Track::default();
        }
    }

    /// Where the robot was, by its wheels; now, if nothing is remembered.
    pub(super) fn odometry_at(&self, stamp: Stamp) -> Pose2 {
        self.poses.at(stamp).unwrap_or(self.odometry.pose_in_odometry)
    }
}
