//! What stands around the robot, in its own frame, and what of it holds it.

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_configuration::polygon_contains;
use floorguard_guard::{Cause, CauseRecord, signed_distance_m};
use floorguard_recording::describe;
use floorguard_runtime::shared::Shared;
use floorguard_types::geometry::{Point2, Point3, Pose2, Transform3};
use floorguard_types::sensing::{BeamReturn, Scan};
use serde::Serialize;

use crate::words::Language;

/// A person or another object that is followed, in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Followed {
    /// Number of the track.
    pub id: u32,
    /// Taken for a person.
    pub person: bool,
    /// Metres ahead of the robot's centre.
    pub x_m: f32,
    /// Metres to its left.
    pub y_m: f32,
    /// Speed over ground, m/s.
    pub speed_mps: f32,
}

/// Everything around the robot, in its frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Outline of the body.
    pub footprint: Vec<Point2>,
    /// The protective field that is watched.
    pub protective: Vec<Point2>,
    /// The warning field.
    pub warning: Vec<Point2>,
    /// Where the safety scanner saw something.
    pub hits: Vec<Point2>,
    /// What is followed.
    pub followed: Vec<Followed>,
}

/// What holds the robot, as far as it can be shown on a map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Holder {
    /// `a person` or `an obstacle`.
    pub what: &'static str,
    /// Number of the track of a person.
    pub id: Option<u32>,
    /// Metres ahead of the robot's centre.
    pub x_m: f32,
    /// Metres to its left.
    pub y_m: f32,
    /// Metres from the body's outline.
    pub distance_m: f32,
    /// Where it is, as one would say it beside the robot.
    pub direction: &'static str,
}

impl Holder {
    /// `a person (behind, 1.4 m)`.
    #[must_use]
    pub fn words(&self) -> String {
        self.words_in(Language::English)
    }

    /// The same in a language.
    #[must_use]
    pub fn words_in(&self, language: Language) -> String {
        let metres = language.number(self.distance_m.into(), 1);
        format!("{} ({}, {metres} m)", language.say(self.what), language.say(self.direction))
    }
}

/// Where the beams of a scan ended, in the robot's frame.
#[must_use]
pub fn scan_hits(scan: &Scan, mounting: &Transform3) -> Vec<Point2> {
    let beams = scan.beams.iter().enumerate().filter_map(|(index, beam)| match beam {
        BeamReturn::Hit(range_mm) => Some((index, f32::from(*range_mm) * 1.0e-3)),
        _ => None,
    });
    beams
        .map(|(index, range_m)| {
            let (sin, cos) = libm::sincosf(scan.first_angle_rad + index as f32 * scan.step_rad);
            let place = mounting.transform(Point3::new(range_m * cos, range_m * sin, 0.0));
            Point2::new(place.x_m, place.y_m)
        })
        .collect()
}

/// What is followed, as seen from the robot.
#[must_use]
pub fn followed<M: RawMutex>(shared: &Shared<M>, robot_in_odom: Pose2) -> Vec<Followed> {
    let report = shared.people.get().unwrap_or_default();
    let to_robot = robot_in_odom.inverse();
    let tracks = report.people.iter().map(|track| {
        let place = to_robot.transform(track.position);
        let (person, speed_mps) = (describe::is_person(track), track.velocity_mps.norm());
        Followed { id: track.id, person, x_m: place.x_m, y_m: place.y_m, speed_mps }
    });
    tracks.collect()
}

/// The sector of a place around the robot, in words.
#[must_use]
pub fn direction(place: Point2) -> &'static str {
    const SECTORS: [&str; 8] = [
        "ahead",
        "ahead on the left",
        "left",
        "behind on the left",
        "behind",
        "behind on the right",
        "right",
        "ahead on the right",
    ];
    let turn = libm::atan2f(place.y_m, place.x_m) / core::f32::consts::FRAC_PI_4;
    let sector = libm::roundf(turn).rem_euclid(8.0) as usize;
    SECTORS.get(sector).copied().unwrap_or("ahead")
}

impl Surroundings {
    /// What a cause speaks of: the person, or the nearest return in the field. `None` for a cause without a place.
    #[must_use]
    pub fn holder(&self, record: &CauseRecord) -> Option<Holder> {
        match record.cause {
            Cause::PersonNear | Cause::CollisionStop | Cause::CollisionSlow => self.nearest_person(),
            Cause::ScanProtective | Cause::LidarProtective => self.nearest_within(&self.protective),
            Cause::Warning => self.nearest_within(&self.warning),
            _ => None,
        }
    }

    /// The person nearest to the body.
    #[must_use]
    pub fn nearest_person(&self) -> Option<Holder> {
        let people = self.followed.iter().filter(|track| track.person);
        let near =
            people.map(|track| self.seen("a person", Some(track.id), Point2::new(track.x_m, track.y_m)));
        near.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
    }

    /// What stands in a field and is nearest to the body: a person, where one is followed at that place.
    fn nearest_within(&self, field: &[Point2]) -> Option<Holder> {
        /// A return this near to a track is the track's, metres: legs stand apart.
        const OF_TRACK_M: f32 = 0.5;
        if field.len() < 3 {
            return None;
        }
        let within = self.hits.iter().filter(|hit| polygon_contains(field, **hit));
        let near = within.map(|hit| self.seen("an obstacle", None, *hit));
        let found = near.min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))?;
        let place = Point2::new(found.x_m, found.y_m);
        let person = self
            .followed
            .iter()
            .filter(|track| track.person)
            .find(|track| Point2::new(track.x_m, track.y_m).distance(place) <= OF_TRACK_M);
        Some(match person {
            Some(track) => Holder { what: "a person", id: Some(track.id), ..found },
            None => found,
        })
    }

    fn seen(&self, what: &'static str, id: Option<u32>, place: Point2) -> Holder {
        let distance_m = signed_distance_m(&self.footprint, place).max(0.0);
        Holder { what, id, x_m: place.x_m, y_m: place.y_m, distance_m, direction: direction(place) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::time::Stamp;

    fn square(half_m: f32) -> Vec<Point2> {
        [(half_m, half_m), (-half_m, half_m), (-half_m, -half_m), (half_m, -half_m)]
            .map(|(x_m, y_m)| Point2::new(x_m, y_m))
            .to_vec()
    }

    #[test]
    fn directions_are_those_of_the_robot() {
        let named = [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (-1.0, 0.1), (-1.0, -0.1), (0.1, -1.0)];
        let words = named.map(|(x_m, y_m)| direction(Point2::new(x_m, y_m)));
        assert_eq!(words, ["ahead", "ahead on the left", "left", "behind", "behind", "right"]);
    }

    #[test]
    fn person_behind_is_what_holds_the_robot() {
        let person = Followed { id: 4, person: true, x_m: -1.9, y_m: 0.0, speed_mps: 0.5 };
        let around = Surroundings {
            footprint: square(0.5),
            protective: square(1.0),
            hits: vec![Point2::new(0.8, 0.0)],
            followed: vec![person, Followed { id: 5, x_m: -5.0, ..person }],
            ..Surroundings::default()
        };
        let holder =
            |cause| around.holder(&CauseRecord::new(cause, Stamp::ZERO)).map(|holder| holder.words());
        assert_eq!(holder(Cause::CollisionStop).as_deref(), Some("a person (behind, 1.4 m)"));
        assert_eq!(holder(Cause::ScanProtective).as_deref(), Some("an obstacle (ahead, 0.3 m)"));
        assert_eq!(holder(Cause::EmergencyStop), None);
    }
}
