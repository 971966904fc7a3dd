//! What the drive learns: where the robot is on the map, what stands around, and who walks.

use floorguard_guard::FUTURE_TOLERANCE_US;
use floorguard_navigation::costmap::{Beam, SpaceRay};
use floorguard_perception::people::{SeenReturn, TrackStatus};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::shared::{PeopleReport, PersonReport, StampedPose};
use floorguard_runtime::tasks::PERSON_PROBABILITY_MIN;
use floorguard_types::geometry::{Point2, Point3, Pose2};
use floorguard_types::motion::MovingPerson;
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::{Age, Stamp};

use super::place::Place;
use super::plan::NavigationPlan;
use super::space_inbox::SpaceSight;
use super::survey::{SharedSurvey, SurveyScan, in_map, locked};
use crate::cleaner::Whereabouts;
use crate::site::{RecentPoses, ends_of};

/// While the pose is not trusted a scan is taken in this often even if the robot stands, seconds.
const RETRY_S: f32 = 0.2;
/// One beam in this many is matched with the map.
const BEAM_INTERVAL: usize = 9;
/// Beams that end this near to somebody are no part of the map, metres.
const PERSON_M: f32 = 0.8;
/// A place this far from all that is on the map is the middle of a free floor, metres.
const MIDDLE_M: f32 = 0.6;
/// Beams that end this near to somebody who walks mark nothing: who walks is planned for where they will be, metres.
const WALKER_M: f32 = 0.6;
/// Who is slower stands, m/s.
const WALKS_MPS: f32 = 0.3;
/// What was known of people counts for so long, seconds.
const FADES_S: f32 = 1.0;

/// Pose, scans and people.
pub(super) struct Senses {
    place: Place,
    scanner_in_base: Pose2,
    poses: RecentPoses,
    odometry: StampedPose,
    people: Vec<PersonReport>,
    people_s: f32,
    next_retry_s: f32,
    /// Driven so far, metres.
    pub(super) distance_m: f32,
}

impl Senses {
    /// At the start of a plan, on its map, or with the map that is to be made.
    ///
    /// # Errors
    /// The map has no floor for this robot.
    pub(super) fn new(
        plan: &NavigationPlan,
        robot: &RobotConfiguration,
        (radius_m, survey): (f32, Option<&SharedSurvey>),
    ) -> anyhow::Result<Self> {
        let mounting = robot.scanner.mounting;
        let scanner_in_base = Pose2::new(mounting.position.x_m, mounting.position.y_m, mounting.yaw_rad);
        let place = match survey {
            Some(survey) => {
                locked(survey).mount(scanner_in_base);
                Place::Surveyed(survey.clone())
            }
            None => Place::on_map(plan, radius_m)?,
        };
        Ok(Self {
            place,
            scanner_in_base,
            poses: RecentPoses::default(),
            odometry: StampedPose::default(),
            people: Vec::new(),
            people_s: f32::NEG_INFINITY,
            next_retry_s: 0.0,
            distance_m: 0.0,
        })
    }

    /// Where the scanner sits.
    pub(super) const fn scanner_in_base(&self) -> Pose2 {
        self.scanner_in_base
    }

    /// Where the robot is believed to be now, map frame.
    pub(super) fn pose(&self) -> Pose2 {
        self.place.pose(self.odometry.pose_in_odometry)
    }

    /// All of that, for what drives the robot next.
    pub(super) fn whereabouts(&self) -> Whereabouts {
        Whereabouts {
            pose_in_map: self.pose(),
            doubt_m: self.place.doubt_m(),
            is_trusted: self.is_trusted(),
            odometry: self.odometry,
            poses: self.poses.clone(),
        }
    }

    /// Where the odometry frame lies in the map frame.
    pub(super) fn odometry_in_map(&self) -> Pose2 {
        self.pose().compose(self.odometry.pose_in_odometry.inverse())
    }

    /// How it moves.
    pub(super) const fn motion(&self) -> StampedPose {
        self.odometry
    }

    /// The robot stands here, map frame, as somebody outside says.
    pub(super) fn relocate(&mut self, pose_in_map: Pose2) {
        self.place.relocate(pose_in_map, self.odometry.pose_in_odometry);
    }

    /// The pose explains what the scanner sees.
    pub(super) fn is_trusted(&self) -> bool {
        self.place.is_trusted()
    }

    /// A pose of the odometry.
    pub(super) fn remember(&mut self, pose: StampedPose) {
        let (from, to) = (self.odometry.pose_in_odometry, pose.pose_in_odometry);
        if !self.poses.is_empty() {
            self.distance_m += libm::hypotf(to.x_m - from.x_m, to.y_m - from.y_m);
        }
        self.odometry = pose;
        self.poses.push(pose);
    }

    /// The list of people. While perception is silent its last message grows old, and one from the future counts for nothing.
    pub(super) fn see_people(&mut self, report: &PeopleReport, (now, now_s): (Stamp, f32)) {
        let age_us = match report.sweep.stamp.age(now) {
            Age::Past(age_us) => age_us,
            Age::Future(ahead_us) if ahead_us <= FUTURE_TOLERANCE_US => 0,
            Age::Future(_) => return,
        };
        self.people_s = now_s - age_us as f32 * 1.0e-6;
        let confirmed = report.people.iter().filter(|person| person.status == TrackStatus::Confirmed);
        self.people = confirmed.copied().collect();
    }

    /// A scan: it corrects the pose, and gives what stands around, with the sensor's place in the map frame.
    pub(super) fn see(&mut self, scan: &Scan, now_s: f32) -> (Point2, Vec<Beam>) {
        let odometry = self.odometry_at(scan.stamp);
        self.correct_place(scan, (odometry, now_s));
        let scanner = self.place.pose(odometry).compose(self.scanner_in_base);
        let beams = self.beams(scan, (odometry, now_s));
        let beams = beams.into_iter().map(|beam| in_map(scanner, beam)).collect();
        (Point2::new(scanner.x_m, scanner.y_m), beams)
    }

    /// The place after a scan.
    fn correct_place(&mut self, scan: &Scan, (odometry, now_s): (Pose2, f32)) {
        let is_lost = !self.place.is_trusted();
        let is_late = is_lost && now_s >= self.next_retry_s;
        let is_due = match &self.place {
            Place::Known(known) => known.1.is_due(odometry) || is_late,
            Place::Surveyed(survey) => {
                let beams = self.beams(scan, (odometry, now_s));
                let beams = beams.into_iter().map(|beam| self.without_people(beam, (odometry, now_s)));
                let taken = SurveyScan { scan, base_in_odometry: odometry, beams: beams.collect() };
                locked(survey).take(taken);
                false
            }
        };
        if is_due {
            self.next_retry_s = now_s + RETRY_S;
            let interval = if is_lost { BEAM_INTERVAL / 3 } else { BEAM_INTERVAL };
            let guess = self.place.pose(odometry);
            let is_no_wall = |end: &Point2| {
                self.is_near_person(odometry.transform(*end), PERSON_M, now_s)
                    || self.place.is_middle_of_floor(guess.transform(*end), MIDDLE_M)
            };
            let ends = ends_of(scan, interval).map(|end| self.scanner_in_base.transform(end));
            let matched: Vec<Point2> = ends.filter(|end| !is_no_wall(end)).collect();
            if let Place::Known(known) = &mut self.place {
                let (floor, localiser) = known.as_mut();
                localiser.update(floor, odometry, &matched, false);
            }
        }
    }

    /// All kept scans again, where a map is made and was corrected since the last call.
    pub(super) fn take_redrawn(&mut self) -> Option<Vec<(Point2, Vec<Beam>)>> {
        match &self.place {
            Place::Known(_) => None,
            Place::Surveyed(survey) => locked(survey).take_redrawn(),
        }
    }

    /// All kept scans, where a map is made.
    pub(super) fn redrawn(&self) -> Option<Vec<(Point2, Vec<Beam>)>> {
        match &self.place {
            Place::Known(_) => None,
            Place::Surveyed(survey) => Some(locked(survey).redrawn()),
        }
    }

    /// The beams in the scanner's frame. Who walks is passed through.
    fn beams(&self, scan: &Scan, (odometry, now_s): (Pose2, f32)) -> Vec<Beam> {
        let scanner = odometry.compose(self.scanner_in_base);
        let of = |(beam, seen): (usize, &BeamReturn)| {
            let place = |range_mm: u16| {
                let angle_rad = scan.first_angle_rad + beam as f32 * scan.step_rad;
                let range_m = f32::from(range_mm) * 1.0e-3;
                let (sin, cos) = libm::sincosf(angle_rad);
                Point2::new(range_m * cos, range_m * sin)
            };
            match seen {
                BeamReturn::Hit(range_mm) => {
                    let end = place(*range_mm);
                    let is_walker = self.is_near_walker(scanner.transform(end), now_s);
                    if is_walker { Beam::Free(end) } else { Beam::Hit(end) }
                }
                BeamReturn::Free(range_mm) => Beam::Free(place(*range_mm)),
                _ => Beam::Unknown,
            }
        };
        scan.beams.iter().enumerate().map(of).collect()
    }

    /// A beam that ends near somebody is no part of a map.
    fn without_people(&self, beam: Beam, (odometry, now_s): (Pose2, f32)) -> Beam {
        match beam {
            Beam::Hit(end) => {
                let in_odometry = odometry.transform(self.scanner_in_base.transform(end));
                if self.is_near_person(in_odometry, PERSON_M, now_s) { Beam::Unknown } else { beam }
            }
            other => other,
        }
    }

    fn is_near_person(&self, place: Point2, within_m: f32, now_s: f32) -> bool {
        now_s - self.people_s <= FADES_S
            && self.people.iter().any(|person| person.position.distance(place) < within_m)
    }

    fn is_near_walker(&self, place: Point2, now_s: f32) -> bool {
        let is_near = |person: &&PersonReport| person.position.distance(place) < WALKER_M;
        let walks = |person: &PersonReport| is_person(person) && person.velocity_mps.norm() > WALKS_MPS;
        now_s - self.people_s <= FADES_S && self.people.iter().filter(is_near).any(walks)
    }

    /// The people that are known now, map frame, moved on to this moment.
    pub(super) fn people_in_map(&self, now_s: f32) -> Vec<MovingPerson> {
        let age_s = now_s - self.people_s;
        if age_s > FADES_S {
            return Vec::new();
        }
        let to_map = self.odometry_in_map();
        let turn = Pose2::new(0.0, 0.0, to_map.heading_rad);
        let moved = |person: &PersonReport| {
            let known = MovingPerson {
                position_in_map: to_map.transform(person.position),
                velocity_in_map_mps: turn.transform(person.velocity_mps),
                position_deviation_m: person.position_sigma_m,
                velocity_deviation_mps: person.velocity_sigma_mps,
            };
            known.after(age_s.max(0.0), 0.0)
        };
        self.people.iter().filter(|person| is_person(person)).map(moved).collect()
    }

    /// The rays of a sweep in the axes of the map. Who walks does not mark.
    pub(super) fn rays_in_map(&self, sight: &SpaceSight, now_s: f32) -> Vec<SpaceRay> {
        let base_in_map = self.odometry_in_map().compose(sight.base_in_odometry);
        let in_map = |place: Point3| {
            let on_floor = base_in_map.transform(Point2::new(place.x_m, place.y_m));
            Point3::new(on_floor.x_m, on_floor.y_m, place.z_m)
        };
        let ray = |seen: &SeenReturn| {
            let end = Point2::new(seen.end_in_base.x_m, seen.end_in_base.y_m);
            let is_walker = self.is_near_walker(sight.base_in_odometry.transform(end), now_s);
            SpaceRay {
                from_in_map: in_map(seen.sensor_in_base),
                to_in_map: in_map(seen.end_in_base),
                marks: !is_walker,
            }
        };
        sight.returns.iter().map(ray).collect()
    }

    /// Where the robot was, by its wheels; now, if nothing is remembered.
    pub(super) fn odometry_at(&self, stamp: Stamp) -> Pose2 {
        self.poses.at(stamp).unwrap_or(self.odometry.pose_in_odometry)
    }
}

fn is_person(person: &PersonReport) -> bool {
    let has_shape = person.person_probability >= PERSON_PROBABILITY_MIN && person.explanation.is_none();
    has_shape || person.moving_probability >= PERSON_PROBABILITY_MIN
}
