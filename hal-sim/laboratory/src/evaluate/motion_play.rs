//! Plays a recording of a lidar that stands still, upright, into the detector of moving objects.

use std::path::Path;

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, SweepBuilder};
use floorguard_perception::motion::{MotionDetector, MotionParameters};
use floorguard_perception::people::{FloorHeight, PeoplePipeline, RingAngles, SweepContext};
use floorguard_types::geometry::{Point2, Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

use floorguard_host::outcome::BadInput;
use floorguard_recording::capture::Capture;
use floorguard_recording::capture::{LIDAR_DATA_PORT, settle_model};

/// Height assumed while no sweep has shown a floor, metres (the FLOBOT layout).
const ASSUMED_HEIGHT_M: f32 = 0.8;
/// A sweep with fewer columns began or ended in the middle of a revolution.
const WHOLE_COLUMNS: usize = 1_500;

/// Motion is judged against what was seen before.
const SWEEPS_MIN: usize = 2;

/// One object of one sweep.
pub(super) struct Found {
    pub(super) position: Point2,
    pub(super) moving: bool,
}

/// One sweep: its middle in seconds after the first packet, and its objects.
pub(super) struct Moment {
    pub(super) middle_s: f64,
    pub(super) found: Vec<Found>,
}

/// Judges every sweep of a recording; also says what the verdicts took, nanoseconds a sweep.
///
/// # Errors
/// The recording cannot be read or holds no lidar of 16 rings.
pub(super) fn play(recording: &Path, parameters: MotionParameters) -> anyhow::Result<(Vec<Moment>, f64)> {
    let (sweeps, angles) = sweeps(recording)?;
    let mut player = Player::new(angles, parameters);
    player.find_floor(&sweeps);
    let moments: Vec<Moment> = sweeps.iter().map(|sweep| player.judge(sweep)).collect();
    let ns_per_sweep = player.spent_ns / moments.len().max(1) as f64;
    Ok((moments, ns_per_sweep))
}

struct Player {
    people: Box<PeoplePipeline>,
    motion: Box<MotionDetector>,
    context: SweepContext,
    first: Option<Stamp>,
    spent_ns: f64,
}

impl Player {
    fn new(angles: RingAngles, parameters: MotionParameters) -> Self {
        Self {
            people: Box::new(PeoplePipeline::new(angles)),
            motion: Box::new(MotionDetector::new(parameters)),
            context: SweepContext {
                sensor_in_base: at_height(ASSUMED_HEIGHT_M),
                twist: Twist2::ZERO,
                base_in_odom: Pose2::default(),
            },
            first: None,
            spent_ns: 0.0,
        }
    }

    /// The height above the floor, from the first whole sweep that shows one.
    fn find_floor(&mut self, sweeps: &[Box<Sweep>]) {
        let whole = sweeps.iter().filter(|sweep| sweep.column_count > WHOLE_COLUMNS);
        let heights = { whole }.filter_map(|sweep| FloorHeight::estimate_m(sweep, &self.people.angles));
        if let Some(height_m) = { heights }.next() {
            self.context.sensor_in_base = at_height(height_m);
        }
    }

    fn judge(&mut self, sweep: &Sweep) -> Moment {
        self.people.find_clusters(sweep, &self.context);
        let started = std::time::Instant::now();
        let output = self.motion.process(&self.people, sweep, &self.context);
        self.spent_ns += started.elapsed().as_nanos() as f64;
        let first = *self.first.get_or_insert(sweep.stamp);
        let middle_us = (sweep.stamp.as_micros() + sweep.end_stamp.as_micros()) / 2;
        let moving = output.moving.iter().map(|moving| Found {
            position: Point2::new(moving.centroid.x_m, moving.centroid.y_m),
            moving: true,
        });
        let judged = self.people.clusters().iter().zip(output.verdicts).filter(|(_, verdict)| verdict.judged);
        let found = judged
            .map(|(cluster, verdict)| Found {
                position: Point2::new(cluster.centroid.x_m, cluster.centroid.y_m),
                moving: verdict.moving,
            })
            .chain(moving);
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
            let reason = format!(
                "{}: this is a {}; motion knows lidars of 16 rings",
                recording.display(),
                model.name()
            );
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
    let whole = sweeps.iter().filter(|sweep| sweep.column_count > WHOLE_COLUMNS / 4).count();
    if whole < SWEEPS_MIN {
        let reason =
            format!("{}: {whole} whole revolutions; motion needs {SWEEPS_MIN} at least", recording.display());
        return Err(BadInput(reason).into());
    }
    Ok((sweeps, angles))
}
