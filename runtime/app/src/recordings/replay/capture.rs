//! A lidar capture through the people stages.

use std::time::{Duration, Instant};

use floorguard_drivers::velodyne::{
    ClosedSector, Counters, DecodeError, Decoder, Model, ModelChoice, SweepBuilder,
};
use floorguard_perception::motion::{MotionDetector, MotionParameters, find_moving_people};
use floorguard_perception::people::{FloorHeight, PeoplePipeline, RingAngles, SweepContext};
use floorguard_types::geometry::{Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

use super::recorded::Recorded;
use super::rows::{SweepRow, print};
use crate::recordings::arguments::ReplayArguments;
use floorguard_host::outcome::BadInput;
use floorguard_host::words::counted;
use floorguard_recording::capture::{Capture, CaptureError};
use floorguard_recording::capture::{LIDAR_DATA_PORT, settle_model};

/// Height assumed while no sweep has shown a floor, metres (the FLOBOT layout).
pub(super) const ASSUMED_HEIGHT_M: f32 = 0.8;

/// A sweep with fewer columns began or ended in the middle of a revolution.
const WHOLE_COLUMNS: usize = 1_500;

struct Player {
    pipeline: Box<PeoplePipeline>,
    angles: RingAngles,
    motion: Box<MotionDetector>,
    context: SweepContext,
    floor_known: bool,
    json: bool,
    sweeps: u64,
    most_people: usize,
    identities: std::collections::BTreeSet<u32>,
    failed: std::io::Result<()>,
    recorded: Recorded,
    closed: Option<ClosedSector>,
}

/// Runs the command.
///
/// # Errors
/// Bad input; every sweep before it has been processed and printed.
pub fn run(arguments: &ReplayArguments) -> anyhow::Result<()> {
    let model = settle_model(&arguments.file, arguments.model.choice())?;
    if !matches!(model, Model::Vlp16 | Model::HiRes) {
        let name = model.name();
        let reason =
            format!("the people stages know lidars of 16 rings; this one is a {name} (decode works)");
        return Err(BadInput(format!("{}: {reason}", arguments.file.display())).into());
    }
    let mut decoder = Decoder::new(ModelChoice::Fixed(model));
    let mut builder = SweepBuilder::new(18_000);
    let mut building = Box::new(Sweep::<16>::EMPTY);
    let recorded = Recorded::open(&arguments.file, arguments.record.as_deref())?;
    let mut player = Player::new(model, arguments.json, recorded);
    let mut pace = Pace { enabled: arguments.realtime, start: None };
    let mut ended: Option<CaptureError> = None;
    let mut refusal: Option<DecodeError> = None;
    let mut odd_block = None;
    let started = Instant::now();
    for datagram in Capture::open(&arguments.file)? {
        match datagram {
            Ok(datagram) if datagram.destination_port == LIDAR_DATA_PORT => {
                pace.wait(datagram.captured_us);
                let arrival = Stamp::from_micros(datagram.captured_us);
                player.recorded.datagram(arrival, &datagram.payload);
                match decoder.decode(&datagram.payload, arrival) {
                    Ok((packet, lost)) => {
                        player.closed = decoder.closed_sector();
                        builder.add(&packet, lost, &mut building, |sweep| player.sweep(sweep));
                        odd_block = decoder.odd_block().or(odd_block);
                    }
                    Err(error) => refusal = Some(error),
                }
            }
            Ok(_) => {}
            Err(error) => ended = Some(error),
        }
    }
    if building.column_count > 0 {
        player.sweep(&building);
    }
    std::mem::replace(&mut player.failed, Ok(()))?;
    let counters = decoder.counters();
    if let Some(error) = refusal {
        let refused = counted(counters.refused, "packet");
        if counters.accepted == 0 && ended.is_none() {
            let name = arguments.file.display();
            return Err(
                BadInput(format!("{name}: {refused} refused and none taken; the last: {error}")).into()
            );
        }
        say!("{refused} refused, the last: {error}");
    }
    if let Some(error) = odd_block {
        say!("{} left out, the last: {error}", counted(counters.odd_blocks, "block"));
    }
    player.summary(&counters, started.elapsed());
    player.recorded.finish()?;
    ended.map_or(Ok(()), |error| Err(error.into()))
}

impl Player {
    fn new(model: Model, json: bool, recorded: Recorded) -> Self {
        let angles = match model {
            Model::HiRes => RingAngles::even(-10.0, 4.0 / 3.0),
            _ => RingAngles::vlp16(),
        };
        Self {
            pipeline: Box::new(PeoplePipeline::new(angles)),
            angles,
            motion: Box::new(MotionDetector::new(MotionParameters::FIXED)),
            context: SweepContext {
                sensor_in_base: at_height(ASSUMED_HEIGHT_M),
                twist: Twist2::ZERO,
                base_in_odom: Pose2::default(),
            },
            floor_known: false,
            json,
            sweeps: 0,
            most_people: 0,
            identities: std::collections::BTreeSet::new(),
            failed: Ok(()),
            recorded,
            closed: None,
        }
    }

    fn sweep(&mut self, sweep: &Sweep) {
        if !self.floor_known
            && sweep.column_count > WHOLE_COLUMNS
            && let Some(height_m) = FloorHeight::estimate_m(sweep, &self.pipeline.angles)
        {
            self.context.sensor_in_base = at_height(height_m);
            self.floor_known = true;
            say!("the floor lies {height_m:.2} m below the lidar (estimated from the first whole sweep)");
        }
        let output = find_moving_people(&mut self.pipeline, &mut self.motion, sweep, &self.context);
        self.sweeps += 1;
        let people = output.tracks.iter().filter(|track| track.is_taken_for_person());
        self.most_people = self.most_people.max(people.clone().count());
        self.identities.extend(people.map(|track| track.id));
        let closed_cdeg = self.closed.map_or(0, |closed| closed.width_cdeg());
        let row = SweepRow::of_output(sweep, &output).with_closed(sweep, closed_cdeg);
        if self.json && self.failed.is_ok() {
            self.failed = print(&row);
        }
        let SweepContext { sensor_in_base, twist, base_in_odom } = &self.context;
        self.recorded.sweep((sweep, &self.angles), (sensor_in_base, (*base_in_odom, *twist)), row.people());
    }

    fn summary(&self, counters: &Counters, took: Duration) {
        if !self.floor_known {
            say!(
                "no sweep has shown the floor: the lidar is taken to be {ASSUMED_HEIGHT_M:.2} m above it, and what was found may be wrong"
            );
        }
        if let Some(closed) = &self.closed {
            say!(
                "the lidar is set to a field of view: {closed}; what lies in the closed sector stays unknown"
            );
        }
        let per_sweep_ms = took.as_secs_f64() * 1.0e3 / self.sweeps.max(1) as f64;
        say!(
            "{} from {} ({} refused, {} lost): {} in all, at most {} at once; {per_sweep_ms:.2} ms a sweep",
            counted(self.sweeps, "sweep"),
            counted(counters.accepted, "packet"),
            counters.refused,
            counters.lost,
            counted(self.identities.len() as u64, "person"),
            self.most_people,
        );
    }
}

fn at_height(height_m: f32) -> Transform3 {
    Transform3 { translation: Point3::new(0.0, 0.0, height_m), ..Transform3::IDENTITY }
}

/// Waits so that packets come as they were recorded.
struct Pace {
    enabled: bool,
    start: Option<(Instant, u64)>,
}

impl Pace {
    fn wait(&mut self, captured_us: u64) {
        if !self.enabled {
            return;
        }
        let (started, first_us) = *self.start.get_or_insert((Instant::now(), captured_us));
        let due = Duration::from_micros(captured_us.saturating_sub(first_us));
        std::thread::sleep(due.saturating_sub(started.elapsed()));
    }
}
