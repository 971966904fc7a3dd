//! Scans of any two-dimensional scanner: legs, and the people that they carry.

use std::collections::{BTreeMap, BTreeSet};

use floorguard_perception::legs::{Leg, LegDetector, LegTracker};
use floorguard_types::capacities::SCAN_BEAMS_MAX;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;
use serde::Serialize;

use super::rows::PersonRow;

/// What has stood at a place for this long is furniture, microseconds.
const FURNITURE_US: u64 = 10_000_000;
/// When half of a scan has stood for this long, the scanner stands, microseconds.
const SETTLED_US: u64 = 2_000_000;
/// What was gone for this long has not stood, microseconds.
const GONE_US: u64 = 1_500_000;
/// Two legs that have come this far are a person's, metres: chairs and doors stay where they are.
const WALKED_M: f32 = 0.4;
/// Edge of a place, metres.
const PLACE_M: f32 = 0.15;

/// A leg.
#[derive(Clone, Debug, Serialize)]
pub struct LegRow {
    x_m: f32,
    y_m: f32,
    probability: f32,
}

/// A scan.
#[derive(Clone, Debug, Serialize)]
pub struct ScanRow {
    stamp_us: u64,
    frame: &'static str,
    points: u32,
    segments: u32,
    legs: Vec<LegRow>,
    people: Vec<PersonRow>,
    dropped_legs: u32,
    health: &'static str,
}

impl ScanRow {
    /// Confirmed people in it.
    pub fn people(&self) -> impl Iterator<Item = u32> + '_ {
        self.people.iter().filter_map(PersonRow::confirmed_id)
    }

    /// Everybody in it, confirmed or not.
    pub fn everybody(&self) -> &[PersonRow] {
        &self.people
    }

    /// It bears a later time than the scan before.
    pub fn is_newer(&self) -> bool {
        self.health != "frozen"
    }

    /// Legs in it.
    pub fn legs(&self) -> usize {
        self.legs.len()
    }
}

/// What stands where, by the scans so far.
#[derive(Debug, Default)]
struct Furniture(BTreeMap<(i32, i32), (u64, u64)>);

impl Furniture {
    fn place(point: Point2) -> (i32, i32) {
        ((point.x_m / PLACE_M).floor() as i32, (point.y_m / PLACE_M).floor() as i32)
    }

    /// Gives for how long something has stood there.
    fn see(&mut self, point: Point2, now_us: u64) -> u64 {
        let (since_us, last_us) = self.0.entry(Self::place(point)).or_insert((now_us, now_us));
        if now_us.saturating_sub(*last_us) > GONE_US {
            *since_us = now_us;
        }
        *last_us = (*last_us).max(now_us);
        last_us.saturating_sub(*since_us)
    }

    fn stands(&self, point: Point2) -> bool {
        let found = self.0.get(&Self::place(point));
        found.is_some_and(|(since_us, last_us)| last_us.saturating_sub(*since_us) >= FURNITURE_US)
    }
}

/// Who walks on which legs.
#[derive(Debug, Default)]
struct Walkers {
    by_leg: BTreeMap<u32, u32>,
    /// Who is in the scan already: nobody is in it twice.
    taken: BTreeSet<u32>,
    /// How many there were so far.
    known: u32,
    /// Where each was first seen, and whether it has walked since.
    walked: BTreeMap<u32, (Point2, bool)>,
}

impl Walkers {
    /// The number of a person with these legs, and whether it has walked. A leg that is taken for somebody's stays
    /// with that person, whatever other leg it is paired with.
    fn know(&mut self, legs: [u32; 2], position: Point2) -> (u32, bool) {
        let [one, other] = legs;
        let known = [one, other].map(|leg| self.by_leg.get(&leg).copied());
        let id = known.into_iter().flatten().find(|id| !self.taken.contains(id)).unwrap_or_else(|| {
            self.known += 1;
            self.known
        });
        self.taken.insert(id);
        self.by_leg.extend([(one, id), (other, id)]);
        let (first, walked) = self.walked.entry(id).or_insert((position, false));
        *walked |= first.distance(position) >= WALKED_M;
        (id, *walked)
    }
}

/// Follows legs through scans.
pub struct ScanPlayer {
    detector: LegDetector,
    tracker: LegTracker,
    furniture: Furniture,
    walkers: Walkers,
    /// Time of the newest scan.
    newest: Option<Stamp>,
}

impl ScanPlayer {
    /// Nobody yet.
    pub fn new() -> Self {
        Self {
            detector: LegDetector::new(),
            tracker: LegTracker::new(),
            furniture: Furniture::default(),
            walkers: Walkers::default(),
            newest: None,
        }
    }

    /// A scan, and where its scanner was in the fixed frame.
    pub fn scan(&mut self, scan: &Scan, (sensor, frame): (Pose2, &'static str)) -> ScanRow {
        let now_us = scan.stamp.as_micros();
        let is_newer = self.newest.is_none_or(|newest| scan.stamp > newest);
        self.newest = Some(scan.stamp);
        let furniture = &mut self.furniture;
        let (mut points, mut settled) = (0_u32, 0_u32);
        for point in hits(scan) {
            points += 1;
            settled += u32::from(furniture.see(sensor.transform(point), now_us) >= SETTLED_US);
        }
        // A scanner that moves unknown to us has no furniture: everything does.
        let fixed = frame != "sensor" || settled * 2 > points;
        let map = |point: Point2| fixed && furniture.stands(sensor.transform(point));
        let output = self.detector.process(scan, Some(map));
        let (segments, dropped) = (output.segments, output.dropped);
        let legs: Vec<Leg> =
            output.legs.iter().map(|leg| Leg { position: sensor.transform(leg.position), ..*leg }).collect();
        self.tracker.update(scan.stamp, &legs);
        ScanRow {
            stamp_us: now_us,
            frame,
            points,
            segments,
            legs: legs
                .iter()
                .map(|leg| LegRow {
                    x_m: leg.position.x_m,
                    y_m: leg.position.y_m,
                    probability: leg.probability,
                })
                .collect(),
            people: self.people(),
            dropped_legs: dropped,
            health: match (points, is_newer) {
                (0, _) => "blind",
                // Its time stands still or runs backwards: nothing that depends on time is known.
                (_, false) => "frozen",
                (_, true) => "healthy",
            },
        }
    }

    fn people(&mut self) -> Vec<PersonRow> {
        let mut people = Vec::new();
        let Self { tracker, walkers, .. } = self;
        walkers.taken.clear();
        tracker.people(|person| {
            let legs = person.legs.map(|id| tracker.tracks().iter().find(|track| track.id == id));
            if let [Some(one), Some(other)] = legs {
                let known = walkers.know(person.legs, person.position);
                people.push(PersonRow::of_legs(&person, [one, other], known));
            }
        });
        people
    }
}

fn hits(scan: &Scan) -> impl Iterator<Item = Point2> + '_ {
    scan.beams.iter().enumerate().filter_map(|(index, beam)| match beam {
        BeamReturn::Hit(range_mm) => {
            let range_m = f32::from(*range_mm) * 1.0e-3;
            let (sin, cos) = libm::sincosf(scan.first_angle_rad + index as f32 * scan.step_rad);
            Some(Point2::new(range_m * cos, range_m * sin))
        }
        _ => None,
    })
}

/// Ranges in metres as a scan; clockwise ones are turned round, and of more beams than fit every so manieth is taken.
/// A range within the limits is a hit; one at or beyond `limits_m[1]` is unknown: few recorders tell "nothing" from
/// "no answer".
pub fn to_scan(
    stamp: Stamp,
    (first_rad, step_rad): (f32, f32),
    ranges_m: &[f32],
    limits_m: [f32; 2],
) -> Scan {
    let every = ranges_m.len().div_ceil(SCAN_BEAMS_MAX).max(1);
    let [min_m, max_m] = limits_m;
    let beam = |range_m: &f32| {
        let usable = range_m.is_finite() && *range_m > min_m.max(0.01) && *range_m < max_m.min(65.0);
        if usable { BeamReturn::Hit((range_m * 1_000.0) as u16) } else { BeamReturn::Unknown }
    };
    let mut scan =
        Scan { stamp, first_angle_rad: first_rad, step_rad: step_rad * every as f32, ..Scan::default() };
    scan.beams.extend(ranges_m.iter().step_by(every).take(SCAN_BEAMS_MAX).map(beam));
    if step_rad < 0.0 {
        scan.first_angle_rad += scan.step_rad * scan.beams.len().saturating_sub(1) as f32;
        scan.step_rad = -scan.step_rad;
        scan.turn_round();
    }
    scan
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Legs that change partners: no person has two places in a scan.
    #[test]
    fn no_identity_is_given_twice() {
        let mut walkers = Walkers::default();
        let mut scan = |pairs: &[[u32; 2]]| -> Vec<u32> {
            walkers.taken.clear();
            pairs.iter().map(|legs| walkers.know(*legs, Point2::new(0.0, 0.0)).0).collect()
        };
        let first = scan(&[[1, 2]]);
        for pairs in [[[1, 3], [2, 4]], [[3, 4], [1, 2]], [[1, 4], [2, 3]]] {
            let ids = scan(&pairs);
            assert_ne!(ids[0], ids[1], "{pairs:?}");
            assert!(ids.contains(&first[0]), "the first one is still there: {ids:?}");
        }
    }
}
