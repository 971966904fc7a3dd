//! Which objects move, against a key of walking people: a recording of a lidar that stands still.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_perception::motion::MotionParameters;
use floorguard_types::geometry::Point2;
use serde::Serialize;

use super::motion_key::{KeyRow, read_key};
use super::motion_play::{Moment, play};
use floorguard_host::outcome::BadInput;

/// A moving object this near to a keyed position is that person, metres.
pub const MATCH_M: f32 = 0.5;
/// A moving object this near to where a keyed person was within [`AROUND_S`] is a part of him or of where he came
/// from, not a false alarm; metres.
const BELONGS_M: f32 = 0.7;
const AROUND_S: f64 = 0.5;
/// The same after the last position of a person, seconds: a key loses people behind furniture, where they go on moving.
const BEYOND_END_S: f64 = 2.0;
/// No lidar of 16 rings sees farther, metres.
const LIDAR_RANGE_M: f32 = 150.0;
/// From the start of a frame to its middle, seconds.
const HALF_FRAME_S: f64 = 0.05;
/// A sweep and a frame of the key are the same moment within this time, seconds: half a revolution and a bit.
const SAME_TIME_S: f64 = 0.06;
/// One person of the key.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrackReport {
    /// Of the key.
    pub track: u64,
    /// Frames with a position.
    pub keyed_frames: u64,
    /// Of them those in which he walks by the key itself.
    pub walking_frames: u64,
    /// Share of the walking frames in which a moving object was found where he is.
    pub found: f64,
    /// Share of all keyed frames, standing ones included.
    pub found_in_all: f64,
}

/// How it came out.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MotionReport {
    /// Sweeps judged.
    pub sweeps: u64,
    /// Walking people found moving, of all walking people in all frames (Rath et al. 2020, equation 10), in percent.
    pub accuracy: f64,
    /// Objects called moving where nobody was keyed, summed over the sweeps.
    pub false_positives: u64,
    /// The same per 100 sweeps.
    pub false_positives_per_100_sweeps: f64,
    /// Objects judged where nobody was keyed, summed over the sweeps.
    pub static_objects: u64,
    /// Rows of the key from when nothing was recorded: they do not count.
    pub key_rows_outside: u64,
    /// Nanoseconds a sweep for the verdicts alone, without floor and clusters.
    pub ns_per_sweep: f64,
    /// Per keyed person.
    pub tracks: Vec<TrackReport>,
}

/// Judges a recording of a lidar that stands still, upright, and compares with its key.
///
/// # Errors
/// A file cannot be read, holds no lidar of 16 rings, or is no key.
pub fn motion(recording: &Path, key: &Path, parameters: MotionParameters) -> anyhow::Result<MotionReport> {
    let rows = read_key(key)?;
    let (moments, ns_per_sweep) = play(recording, parameters)?;
    let (inside, outside): (Vec<KeyRow>, Vec<KeyRow>) =
        rows.iter().partition(|row| is_recorded(row, &moments));
    if inside.is_empty() {
        let at = |moment: Option<&Moment>| moment.map_or(0.0, |moment| moment.middle_s);
        return Err(BadInput(format!(
            "{}: its {} rows are from {:.1} s on, and {} lasts from {:.1} s to {:.1} s after its first packet: nothing to compare; \
             give the key of this recording",
            key.display(),
            rows.len(),
            rows.iter().map(|row| row.time_s).fold(f64::INFINITY, f64::min),
            recording.display(),
            at(moments.first()),
            at(moments.last())
        ))
        .into());
    }
    let nearest_m = inside.iter().map(|row| row.position.norm()).fold(f32::INFINITY, f32::min);
    if nearest_m > LIDAR_RANGE_M {
        return Err(BadInput(format!(
            "{}: the nearest keyed place is {nearest_m:.0} m away, and the lidar sees {LIDAR_RANGE_M} m; places are metres in its frame",
            key.display()
        ))
        .into());
    }
    let rows = inside;
    Ok(MotionReport { ns_per_sweep, key_rows_outside: outside.len() as u64, ..compare(&rows, &moments) })
}

/// The recording was running when a row was keyed. What is lost within it counts as not found.
fn is_recorded(row: &KeyRow, moments: &[Moment]) -> bool {
    let frame_s = row.time_s + HALF_FRAME_S;
    let began = moments.first().is_some_and(|moment| frame_s >= moment.middle_s - SAME_TIME_S - HALF_FRAME_S);
    began && moments.last().is_some_and(|moment| frame_s <= moment.middle_s + SAME_TIME_S)
}

fn compare(rows: &[KeyRow], moments: &[Moment]) -> MotionReport {
    let mut report = MotionReport { sweeps: moments.len() as u64, ..MotionReport::default() };
    let mut tracks: BTreeMap<u64, [u64; 4]> = BTreeMap::new();
    for row in rows {
        let frame_s = row.time_s + HALF_FRAME_S;
        let moment = moments
            .iter()
            .min_by(|a, b| (a.middle_s - frame_s).abs().total_cmp(&(b.middle_s - frame_s).abs()))
            .filter(|moment| (moment.middle_s - frame_s).abs() <= SAME_TIME_S);
        let found = moment.is_some_and(|moment| {
            moment.found.iter().any(|found| found.moving && found.position.distance(row.position) <= MATCH_M)
        });
        let [keyed, walking, found_walking, found_in_all] = tracks.entry(row.track).or_default();
        *keyed += 1;
        *walking += u64::from(row.walking);
        *found_walking += u64::from(row.walking && found);
        *found_in_all += u64::from(found);
    }
    let share = |part: u64, whole: u64| if whole == 0 { 1.0 } else { part as f64 / whole as f64 };
    for (track, [keyed, walking, found_walking, found_in_all]) in &tracks {
        report.tracks.push(TrackReport {
            track: *track,
            keyed_frames: *keyed,
            walking_frames: *walking,
            found: share(*found_walking, *walking),
            found_in_all: share(*found_in_all, *keyed),
        });
    }
    let sum = |index: usize| tracks.values().map(|counts| counts[index]).sum::<u64>();
    report.accuracy = 100.0 * share(sum(2), sum(1));
    for moment in moments {
        for found in moment.found.iter().filter(|found| is_no_walker(rows, moment.middle_s, found.position)) {
            report.static_objects += 1;
            report.false_positives += u64::from(found.moving);
        }
    }
    report.false_positives_per_100_sweeps = 100.0 * share(report.false_positives, report.sweeps);
    report
}

/// No keyed person was near this place around this time.
fn is_no_walker(rows: &[KeyRow], middle_s: f64, position: Point2) -> bool {
    !rows.iter().any(|row| {
        let later_s = middle_s - row.time_s - HALF_FRAME_S;
        let until_s = if row.is_last { BEYOND_END_S } else { AROUND_S };
        (-AROUND_S..=until_s).contains(&later_s) && row.position.distance(position) <= BELONGS_M
    })
}
