//! Objects that are taken for people in a capture of a standing VLP-16: how many a sweep, in the first second and after
//! ten, and whether the people of a key are still taken for people, each with one identity.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_perception::motion::{MotionDetector, MotionParameters, find_moving_people};
use floorguard_perception::people::{PeoplePipeline, RingAngles, Track, TrackStatus};
use floorguard_types::geometry::Point2;
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;
use serde::Serialize;

use super::frames::{capture_frames, standing_context};
use super::motion_key::{KeyRow, read_key};
use crate::metrics::MotAccumulator;

/// A claim farther than this from every person of the key is false, metres (book, Tracking: Metrics).
const GATE_M: f64 = 0.5;
/// Keyed people farther away than this do not count, metres: they have few returns, and the keys end there.
const KEY_RANGE_M: f32 = 12.0;
/// The beginning, when nothing is known of the place, seconds.
const BEGINNING_S: f32 = 1.0;
/// After this long a place is known, seconds.
const KNOWN_S: f32 = 10.0;

/// Who was taken for a person, and who was one.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FalsePeopleReport {
    /// Sweeps played.
    pub sweeps: u64,
    /// From the first to the last of them, seconds.
    pub seconds: f32,
    /// Sightings of keyed people within 12 m, and the share of them that a claim fits within 0.5 m; `None` without a
    /// key.
    pub key_people: u64,
    /// See `key_people`.
    pub key_claimed: Option<f64>,
    /// The same without the sweeps in which a keyed person has been in the recording for less than half a second.
    pub key_claimed_later: Option<f64>,
    /// Times that a keyed person was covered by another identity than before.
    pub switches: u64,
    /// Claims a sweep that fit no keyed person, at any distance. Without a key every claim is one.
    pub false_people: f64,
    /// The same in the sweeps of the first second.
    pub false_people_in_first_second: f64,
    /// The same in the sweeps after ten seconds; `None` in a shorter recording.
    pub false_people_after_ten_seconds: Option<f64>,
    /// Tracks a sweep that would be claims if nothing explained them, by what explains them.
    pub explained: BTreeMap<&'static str, f64>,
}

/// Sum over sweeps.
#[derive(Clone, Copy, Debug, Default)]
struct Mean {
    sum: u64,
    sweeps: u64,
}

impl Mean {
    fn add(&mut self, count: usize) {
        self.sum += count as u64;
        self.sweeps += 1;
    }

    fn value(&self) -> Option<f64> {
        (self.sweeps > 0).then(|| self.sum as f64 / self.sweeps as f64)
    }
}

/// Frames of a tenth of a second that a key may leave out of a person who is there all the same.
const GAP_FRAMES: u64 = 10;
/// Time that a keyed person takes to be confirmed, in frames of a tenth of a second.
const CONFIRMED_FRAMES: u64 = 5;

/// Plays the capture through the robot's stages, forth and back until so many minutes have passed, at least once. The key has
/// columns `frame`, `time_s`, `track`, `x` and `y`.
///
/// # Errors
/// A file cannot be read or has another form.
pub fn false_people(capture: &Path, key: Option<&Path>, minutes: f32) -> anyhow::Result<FalsePeopleReport> {
    let key = key.map(read_key).transpose()?.unwrap_or_default();
    let sweeps = capture_frames(capture)?;
    Ok(judge(&sweeps, &key, minutes))
}

/// Sweeps of three hours: no more are played, even where time stands still.
const SWEEPS_MAX: usize = 108_000;

/// Which sweep comes when: forth, back, and forth again, in steps as long as they were. Nobody leaps where it turns.
fn forth_and_back(sweeps: &[Box<Sweep>], minutes: f32) -> Vec<(usize, Stamp)> {
    let Some(first) = sweeps.first() else { return Vec::new() };
    // In a single revolution time stands still: played again it tells nothing more.
    let minutes = if sweeps.len() > 1 { minutes } else { 0.0 };
    let back = (1..sweeps.len().saturating_sub(1)).rev();
    let (mut order, mut now, mut before) = (Vec::new(), first.end_stamp, first.end_stamp);
    for index in (0..sweeps.len()).chain(back).cycle() {
        let stamp = sweeps[index].end_stamp;
        now = now.plus_micros(before.past_us(stamp).max(stamp.past_us(before)));
        before = stamp;
        let is_over = now.seconds_since(first.end_stamp) >= 60.0 * minutes || order.len() >= SWEEPS_MAX;
        if order.len() >= sweeps.len() && is_over {
            break;
        }
        order.push((index, now));
    }
    order
}

fn judge(sweeps: &[Box<Sweep>], key: &[KeyRow], minutes: f32) -> FalsePeopleReport {
    let angles = RingAngles::vlp16();
    let context = standing_context(sweeps, &angles);
    let mut pipeline = Box::new(PeoplePipeline::new(angles));
    let mut motion = Box::new(MotionDetector::new(MotionParameters::FIXED));
    let mut figures = MotAccumulator::new();
    let [mut all, mut first, mut later] = [Mean::default(); 3];
    let (mut covered, mut covered_later) = (Share::default(), Share::default());
    let mut explained: BTreeMap<&'static str, u64> = BTreeMap::new();
    let begins = sweeps.first().map(|sweep| sweep.end_stamp);
    let mut seconds = 0.0;
    let order = forth_and_back(sweeps, minutes);
    let mut sweep = Box::new(Sweep::EMPTY);
    for (frame, now) in &order {
        let frame = *frame;
        retime(&mut sweep, &sweeps[frame], *now);
        let output = find_moving_people(&mut pipeline, &mut motion, &sweep, &context);
        seconds = begins.map_or(0.0, |begins| sweep.end_stamp.seconds_since(begins));
        let people = keyed(key, frame as u64);
        let claims: Vec<(u64, Point2)> = { output.tracks.iter() }
            .filter(|track| track.is_taken_for_person())
            .map(|track| (u64::from(track.id), track.state.position))
            .collect();
        for reason in output.tracks.iter().filter_map(explanation) {
            *explained.entry(reason).or_default() += 1;
        }
        let pairs = pairs(&people, &claims);
        figures.frame_by_distance(&ids(&people), &ids(&claims), |person, claim| {
            let distance_m = f64::from(people[person].1.distance(claims[claim].1));
            (distance_m <= GATE_M).then_some(distance_m)
        });
        for (row, (id, _)) in people.iter().enumerate() {
            let is_covered = pairs.iter().any(|(person, _)| *person == row);
            covered.add(is_covered);
            if { key.iter() }.any(|row| row.track == *id && row.frame + CONFIRMED_FRAMES <= frame as u64) {
                covered_later.add(is_covered);
            }
        }
        let false_claims = false_claims(&claims, &pairs, &unseen(key, frame as u64));
        all.add(false_claims);
        if seconds < BEGINNING_S {
            first.add(false_claims);
        } else if seconds >= KNOWN_S {
            later.add(false_claims);
        }
    }
    let count = order.len().max(1) as f64;
    FalsePeopleReport {
        sweeps: order.len() as u64,
        seconds,
        key_people: covered.of,
        key_claimed: covered.value(),
        key_claimed_later: covered_later.value(),
        switches: figures.summary().switches,
        false_people: all.value().unwrap_or(0.0),
        false_people_in_first_second: first.value().unwrap_or(0.0),
        false_people_after_ten_seconds: later.value(),
        explained: { explained.into_iter() }.map(|(reason, times)| (reason, times as f64 / count)).collect(),
    }
}

/// The same sweep at another time.
fn retime(sweep: &mut Sweep, recorded: &Sweep, end: Stamp) {
    sweep.clone_from(recorded);
    let took_us = recorded.stamp.past_us(recorded.end_stamp);
    (sweep.stamp, sweep.end_stamp) = (end.minus_micros(took_us), end);
}

/// Claims that fit no keyed person, and no person whom the key omits for a moment.
fn false_claims(claims: &[(u64, Point2)], pairs: &[(usize, usize)], between: &[Point2]) -> usize {
    let is_unkeyed = |column: usize| pairs.iter().all(|(_, claim)| *claim != column);
    let is_excused = |place: Point2| between.iter().any(|person| person.distance(place) <= GATE_M as f32);
    let unkeyed = { claims.iter().enumerate() }.filter(|(column, _)| is_unkeyed(*column));
    unkeyed.filter(|(_, (_, place))| !is_excused(*place)).count()
}

/// What explains a track that would be a person without it.
fn explanation(track: &Track) -> Option<&'static str> {
    let has_shape = track.status == TrackStatus::Confirmed && track.person_probability >= 0.5;
    track.explanation.filter(|_| has_shape).map(|explanation| explanation.name())
}

/// How many of some.
#[derive(Clone, Copy, Debug, Default)]
struct Share {
    part: u64,
    of: u64,
}

impl Share {
    fn add(&mut self, is_part: bool) {
        self.part += u64::from(is_part);
        self.of += 1;
    }

    fn value(&self) -> Option<f64> {
        (self.of > 0).then(|| self.part as f64 / self.of as f64)
    }
}

/// Number and place of the keyed people of a frame.
fn keyed(key: &[KeyRow], frame: u64) -> Vec<(u64, Point2)> {
    let rows = key.iter().filter(|row| row.frame == frame && row.position.norm() < KEY_RANGE_M);
    rows.map(|row| (row.track, row.position)).collect()
}

/// Where keyed people are in a frame that the key leaves out for at most a second: between two of its rows, or just after
/// the last. They need not be claimed, and a claim there is right.
fn unseen(key: &[KeyRow], frame: u64) -> Vec<Point2> {
    let mut people: BTreeMap<u64, [Option<&KeyRow>; 2]> = BTreeMap::new();
    for row in key {
        let near = people.entry(row.track).or_default();
        if row.frame <= frame {
            near[0] = Some(row);
        } else if near[1].is_none() {
            near[1] = Some(row);
        }
    }
    let place = |near: &[Option<&KeyRow>; 2]| match near {
        [Some(before), _] if before.frame == frame => None,
        [Some(before), Some(after)] if after.frame - before.frame <= GAP_FRAMES => {
            let share = (frame - before.frame) as f32 / (after.frame - before.frame) as f32;
            let between = |from: f32, to: f32| from + share * (to - from);
            let (from, to) = (before.position, after.position);
            Some(Point2::new(between(from.x_m, to.x_m), between(from.y_m, to.y_m)))
        }
        [Some(before), None] if frame - before.frame <= GAP_FRAMES => Some(before.position),
        _ => None,
    };
    people.values().filter_map(place).collect()
}

fn ids(list: &[(u64, Point2)]) -> Vec<u64> {
    list.iter().map(|(id, _)| *id).collect()
}

/// Rows of people and claims that fit each other, one to one, nearest first.
fn pairs(people: &[(u64, Point2)], claims: &[(u64, Point2)]) -> Vec<(usize, usize)> {
    let mut all = Vec::new();
    for (row, person) in people.iter().enumerate() {
        for (column, claim) in claims.iter().enumerate() {
            let distance_m = f64::from(person.1.distance(claim.1));
            if distance_m <= GATE_M {
                all.push((distance_m, row, column));
            }
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    for (_, row, column) in all {
        if pairs.iter().all(|pair| pair.0 != row && pair.1 != column) {
            pairs.push((row, column));
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::{SceneRun, play};
    use floorguard_sim::Scenario;

    /// Sweeps of a simulated room that are played again and again.
    const SWEEPS: usize = 60;
    /// Nobody has been seen often enough before, frames.
    const NEW_FRAMES: u64 = 20;

    /// A room in which people stand, among furniture, and nobody moves.
    const ROOM: &str = r#"
title = "people who stand"
[scene]
wall = [
    { from_m = [-8.0, -6.0], to_m = [8.0, -6.0], height_m = 3.0 },
    { from_m = [8.0, -6.0], to_m = [8.0, 6.0], height_m = 3.0 },
    { from_m = [8.0, 6.0], to_m = [-8.0, 6.0], height_m = 3.0 },
    { from_m = [-8.0, 6.0], to_m = [-8.0, -6.0], height_m = 3.0 },
]
furniture = [
    { kind = "shelf", at_m = [4.0, 4.6], size_m = [3.0, 0.5], height_m = 1.8 },
    { kind = "box", at_m = [-4.0, 4.0], size_m = [0.8, 0.6], height_m = 0.9 },
]
"#;

    /// Who stands where, metres.
    const PEOPLE: [(&str, [f32; 2]); 5] = [
        ("adult", [3.0, 0.5]),
        ("adult", [5.0, -2.5]),
        ("adult", [-2.5, -3.0]),
        ("adult", [2.0, 3.2]),
        ("child", [1.5, -2.0]),
    ];

    fn standing_people() -> (Vec<Box<Sweep>>, Vec<KeyRow>) {
        let person = |(kind, at_m): &(&str, [f32; 2])| {
            format!("[[person]]\nkind = \"{kind}\"\nat_m = {at_m:?}\nspeed_mps = 0.0\n")
        };
        let text = ROOM.to_owned() + &PEOPLE.iter().map(person).collect::<String>();
        let scenario = Scenario::from_toml(&text).expect("a room");
        let run = SceneRun { scenario, seed: 1, scale: 1.0, sensor_height_m: 0.8, starts_us: 200_000 };
        let (mut sweeps, mut key) = (Vec::new(), Vec::new());
        play(&run, (SWEEPS, 1), &mut |labelled| {
            let frame = sweeps.len() as u64;
            let mount = labelled.sensor_in_base.translation;
            key.extend(labelled.people.iter().map(|(id, _, place)| KeyRow {
                frame,
                time_s: 0.1 * frame as f64,
                track: u64::from(*id),
                position: Point2::new(place.x_m - mount.x_m, place.y_m - mount.y_m),
                is_last: false,
                walking: false,
            }));
            sweeps.push(labelled.sweep);
        });
        (sweeps, key)
    }

    #[test]
    fn who_stands_twenty_minutes_stays_a_person() {
        let (sweeps, key) = standing_people();
        let report = judge(&sweeps, &key, 20.0);
        assert!(report.seconds > 1_190.0, "{report:?}");
        let allowed = 1.0 - 2.0 * NEW_FRAMES as f64 / report.sweeps as f64;
        assert!(report.key_claimed.is_some_and(|share| share > allowed), "{report:?}");
        assert_eq!(report.switches, 0, "{report:?}");
    }

    #[test]
    fn single_revolution_is_played_once() {
        let (sweeps, key) = standing_people();
        let report = judge(&sweeps[..1], &key[..5], 20.0);
        assert_eq!(report.sweeps, 1);
    }
}
