//! Which things move, against a key of walking people: a recording of a lidar that stands still.

use std::path::Path;

use floorguard_core::geometry::{Point2, Point3, Pose2, Transform3, Twist2};
use floorguard_core::motion::{MotionDetector, MotionParameters};
use floorguard_core::people::{FloorHeight, PeoplePipeline, RingAngles, SweepContext};
use floorguard_core::sensing::Sweep;
use floorguard_core::time::Stamp;
use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, SweepBuilder};
use serde::Serialize;

use super::motion_key::{KeyRow, read_key};
use crate::capture::Capture;
use crate::commands::{BadInput, LIDAR_DATA_PORT, settle_model};

/// A moving thing this near to a keyed position is that person, metres.
pub const MATCH_M: f32 = 0.5;
/// A moving thing this near to where a keyed person was within [`AROUND_S`] is a part of him or of where he came from,
/// not a false alarm; metres.
const BELONGS_M: f32 = 0.7;
const AROUND_S: f64 = 0.5;
/// A sweep and a frame of the key are the same moment within this time, seconds: half a revolution and a bit.
const SAME_TIME_S: f64 = 0.06;
/// Height assumed while no sweep has shown a floor, metres (the FLOBOT layout).
const ASSUMED_HEIGHT_M: f32 = 0.8;
/// A sweep with fewer columns began or ended in the middle of a revolution.
const WHOLE_COLUMNS: usize = 1_500;

/// One person of the key.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrackReport {
    /// Of the key.
    pub track: u64,
    /// Frames with a position.
    pub keyed_frames: u64,
    /// Of them those in which he walks by the key itself.
    pub walking_frames: u64,
    /// Share of the walking frames in which a moving thing was found where he is.
    pub found: f64,
    /// Share of all keyed frames, standing ones included.
    pub found_in_all: f64,
}

/// How it came out.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MotionReport {
    /// Sweeps judged.
    pub sweeps: u64,
    /// Walking people found moving, of all walking people in all frames (P1, equation 10), in percent.
    pub accuracy: f64,
    /// Things called moving where nobody was keyed, summed over the sweeps.
    pub false_positives: u64,
    /// The same per 100 sweeps.
    pub false_positives_per_100_sweeps: f64,
    /// Things judged where nobody was keyed, summed over the sweeps.
    pub static_things: u64,
    /// Nanoseconds a sweep for the verdicts alone, without floor and clusters.
    pub ns_per_sweep: f64,
    /// Per keyed person.
    pub tracks: Vec<TrackReport>,
}

/// One thing of one sweep.
struct Found {
    position: Point2,
    moving: bool,
}

/// One sweep: its middle in seconds after the first packet, and its things.
struct Moment {
    middle_s: f64,
    found: Vec<Found>,
}

/// Judges a recording of a lidar that stands still, upright, and compares with its key.
///
/// # Errors
/// A file cannot be read, holds no lidar of 16 rings, or is no key.
pub fn motion(recording: &Path, key: &Path, parameters: MotionParameters) -> anyhow::Result<MotionReport> {
    let rows = read_key(key)?;
    let mut player = Player::new(parameters);
    let (sweeps, angles) = sweeps(recording)?;
    player.people.angles = angles;
    let moments: Vec<Moment> = sweeps.iter().map(|sweep| player.judge(sweep)).collect();
    let mut report = compare(&rows, &moments);
    report.ns_per_sweep = player.spent_ns / report.sweeps.max(1) as f64;
    Ok(report)
}

struct Player {
    people: Box<PeoplePipeline>,
    motion: Box<MotionDetector>,
    context: SweepContext,
    floor_known: bool,
    first: Option<Stamp>,
    spent_ns: f64,
}

impl Player {
    fn new(parameters: MotionParameters) -> Self {
        Self {
            people: Box::new(PeoplePipeline::new(RingAngles::vlp16())),
            motion: Box::new(MotionDetector::new(parameters)),
            context: SweepContext {
                sensor_in_base: at_height(ASSUMED_HEIGHT_M),
                twist: Twist2::ZERO,
                base_in_odom: Pose2::default(),
            },
            floor_known: false,
            first: None,
            spent_ns: 0.0,
        }
    }

    fn judge(&mut self, sweep: &Sweep) -> Moment {
        if !self.floor_known
            && sweep.column_count > WHOLE_COLUMNS
            && let Some(height_m) = FloorHeight::estimate_m(sweep, &self.people.angles)
        {
            self.context.sensor_in_base = at_height(height_m);
            self.floor_known = true;
        }
        self.people.find_things(sweep, &self.context);
        let started = std::time::Instant::now();
        let output = self.motion.process(&self.people, sweep, &self.context);
        self.spent_ns += started.elapsed().as_nanos() as f64;
        let first = *self.first.get_or_insert(sweep.stamp);
        let middle_us = (sweep.stamp.as_micros() + sweep.end_stamp.as_micros()) / 2;
        let judged = self.people.things().iter().zip(output.verdicts).filter(|(_, verdict)| verdict.judged);
        let found = judged.map(|(thing, verdict)| Found {
            position: Point2::new(thing.centroid.x_m, thing.centroid.y_m),
            moving: verdict.moving,
        });
        Moment { middle_s: (middle_us as f64 - first.as_micros() as f64) * 1.0e-6, found: found.collect() }
    }
}

fn at_height(height_m: f32) -> Transform3 {
    Transform3 { translation: Point3::new(0.0, 0.0, height_m), ..Transform3::IDENTITY }
}

/// All sweeps of a recording, and the elevations of its lidar.
fn sweeps(recording: &Path) -> anyhow::Result<(Vec<Box<Sweep>>, RingAngles)> {
    let model = settle_model(recording, ModelChoice::Auto)?;
    let angles = match model {
        Model::Vlp16 => RingAngles::vlp16(),
        Model::HiRes => RingAngles::even(-10.0, 4.0 / 3.0),
        _ => {
            let reason = format!("{}: motion knows lidars of 16 rings", recording.display());
            return Err(BadInput(reason).into());
        }
    };
    let mut decoder = Decoder::new(ModelChoice::Fixed(model));
    let mut builder = SweepBuilder::new(18_000);
    let mut building = Box::new(Sweep::<16>::EMPTY);
    let mut sweeps = Vec::new();
    for datagram in Capture::open(recording)? {
        let datagram = datagram?;
        let arrival = Stamp::from_micros(datagram.captured_us);
        if datagram.destination_port == LIDAR_DATA_PORT
            && let Ok((packet, lost)) = decoder.decode(&datagram.payload, arrival)
        {
            builder.add(&packet, lost, &mut building, |sweep| sweeps.push(Box::new(sweep.clone())));
        }
    }
    if building.column_count > 0 {
        sweeps.push(building);
    }
    Ok((sweeps, angles))
}

fn compare(rows: &[KeyRow], moments: &[Moment]) -> MotionReport {
    let mut report = MotionReport { sweeps: moments.len() as u64, ..MotionReport::default() };
    let mut tracks: std::collections::BTreeMap<u64, [u64; 4]> = std::collections::BTreeMap::new();
    for row in rows {
        let frame_s = row.time_s + 0.05;
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
        for found in moment.found.iter().filter(|found| is_nobody(rows, moment.middle_s, found.position)) {
            report.static_things += 1;
            report.false_positives += u64::from(found.moving);
        }
    }
    report.false_positives_per_100_sweeps = 100.0 * share(report.false_positives, report.sweeps);
    report
}

/// No keyed person was near this place around this time.
fn is_nobody(rows: &[KeyRow], middle_s: f64, position: Point2) -> bool {
    !rows.iter().any(|row| {
        (row.time_s + 0.05 - middle_s).abs() <= AROUND_S && row.position.distance(position) <= BELONGS_M
    })
}
