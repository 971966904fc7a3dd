//! A capture of the network through the robot's stages: a lidar's packets, a microScan3's datagrams, or both.

use std::time::{Duration, Instant};

use floorguard_drivers::lidar::{LidarDecoder as _, StraightColumns};
use floorguard_drivers::microscan3;
use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, SweepBuilder};
use floorguard_runtime::configuration::LidarModel;
use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::geometry::Pose2;
use floorguard_types::profile::Native;
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

use super::recorded::Recorded;
use super::rows::{FrameRow, print};
use super::stages::RobotStages;
use super::standing_lidar::StandingLidar;
use super::summary::Summary;
use crate::recordings::arguments::ReplayArguments;
use floorguard_host::outcome::BadInput;
use floorguard_host::words::counted;
use floorguard_recording::capture::{
    Capture, CaptureError, Datagram, LIDAR_DATA_PORT, is_scanner_datagram, settle_model,
};

/// Revolutions are cut behind the sensor, as on the robot.
const CUT_CDEG: u16 = 18_000;
/// So many datagrams tell whether a scanner sends.
const LOOK_AHEAD: usize = 2_000;

/// The lidar of a capture.
struct Lidar {
    decoder: Decoder,
    /// Of one whose lasers look beside their columns.
    straight: Option<StraightColumns<Native>>,
    builder: SweepBuilder,
    building: Box<Sweep>,
    refusal: Option<String>,
    odd_block: Option<String>,
}

/// What both sensors of a capture end in.
struct Player {
    stages: RobotStages,
    standing: StandingLidar,
    closed_cdeg: u32,
    json: bool,
    sweeps: Summary,
    scans: Summary,
    failed: std::io::Result<()>,
    recorded: Recorded,
}

/// Runs the command.
///
/// # Errors
/// Bad input; every sweep and scan before it has been processed and printed.
pub fn run(arguments: &ReplayArguments) -> anyhow::Result<()> {
    let mut lidar = match settle_model(&arguments.file, arguments.model.choice()) {
        Ok(model) => Some(Lidar::new(model)),
        Err(_) if holds_a_scanner(arguments)? => None,
        Err(error) => return Err(error),
    };
    let mut player = Player {
        stages: RobotStages::new()?,
        standing: StandingLidar::new(arguments.tilt),
        closed_cdeg: 0,
        json: arguments.json,
        sweeps: Summary::new(),
        scans: Summary::new(),
        failed: Ok(()),
        recorded: Recorded::open(&arguments.file, arguments.record.as_deref())?,
    };
    if let Some(lidar) = &lidar {
        player.stages.set_lidar(lidar.model());
    }
    let mut scanner = Box::new(microscan3::Receiver::new(microscan3::Configuration::default()));
    let mut pace = Pace { enabled: arguments.realtime, start: None };
    let mut ended: Option<CaptureError> = None;
    for datagram in Capture::open(&arguments.file)? {
        match (datagram, &mut lidar) {
            (Ok(datagram), Some(lidar)) if datagram.destination_port == LIDAR_DATA_PORT => {
                pace.wait(datagram.captured_us);
                lidar.take(&datagram, &mut player);
            }
            (Ok(datagram), _) if is_scanner_datagram(&datagram.payload) => {
                pace.wait(datagram.captured_us);
                player.scanner(&mut scanner, &datagram);
            }
            (Ok(_), _) => {}
            (Err(error), _) => ended = Some(error),
        }
    }
    if let Some(lidar) = &mut lidar {
        lidar.finish(&mut player);
    }
    std::mem::replace(&mut player.failed, Ok(()))?;
    if let Some(lidar) = &lidar {
        lidar.conclude(arguments, ended.is_some(), &player)?;
    }
    player.conclude(&scanner)?;
    ended.map_or(Ok(()), |error| Err(error.into()))
}

/// A microScan3 sends in it.
fn holds_a_scanner(arguments: &ReplayArguments) -> anyhow::Result<bool> {
    let first = Capture::open(&arguments.file)?.flatten().take(LOOK_AHEAD);
    Ok(first.into_iter().any(|datagram| is_scanner_datagram(&datagram.payload)))
}

impl Lidar {
    fn new(model: Model) -> Self {
        let straight = (model == Model::Vlp32C).then(|| StraightColumns::new(model));
        if model.lasers() > SWEEP_RINGS {
            say!(
                "a {} has 32 rings; people are looked for in 16 of them, and once more in 16 between these",
                model.name()
            );
        }
        Self {
            decoder: Decoder::new(ModelChoice::Fixed(model)),
            straight,
            builder: SweepBuilder::new(CUT_CDEG),
            building: Box::new(Sweep::EMPTY),
            refusal: None,
            odd_block: None,
        }
    }

    /// As a robot's file names it.
    fn model(&self) -> LidarModel {
        match self.decoder.model() {
            Some(Model::HiRes) => LidarModel::PuckHiRes,
            Some(Model::Vlp32C) => LidarModel::Vlp32c,
            Some(Model::Hdl32E) => LidarModel::Hdl32e,
            Some(Model::Vlp16) | None => LidarModel::Vlp16,
        }
    }

    fn take(&mut self, datagram: &Datagram, player: &mut Player) {
        let arrival = Stamp::from_micros(datagram.captured_us);
        player.recorded.datagram(arrival, &datagram.payload);
        let (mut packet, lost) = match self.decoder.decode(&datagram.payload, arrival) {
            Ok(decoded) => decoded,
            Err(error) => {
                self.refusal = Some(error.to_string());
                return;
            }
        };
        player.closed_cdeg = self.decoder.closed_sector().map_or(0, |closed| closed.width_cdeg());
        self.odd_block = self.decoder.odd_block().map(|error| error.to_string()).or(self.odd_block.take());
        // As on the robot: straight columns, the rings of a sweep in front, and behind them those of a second look.
        if let Some(straight) = &mut self.straight {
            straight.put_straight(&mut packet, lost);
        }
        self.decoder.arrange_for_people(&mut packet);
        player.stages.note_packet(&packet, lost, &player.standing.context().sensor_in_base);
        self.builder.add(&packet, lost, &mut self.building, |sweep| player.sweep(sweep));
    }

    fn finish(&mut self, player: &mut Player) {
        if self.building.column_count > 0 {
            player.sweep(&self.building);
        }
    }

    fn conclude(&self, arguments: &ReplayArguments, was_cut: bool, player: &Player) -> anyhow::Result<()> {
        let counters = self.decoder.counters();
        if let Some(error) = &self.refusal {
            let refused = counted(counters.refused, "packet");
            if counters.accepted == 0 && !was_cut {
                let name = arguments.file.display();
                let what = format!("{name}: {refused} refused and none taken; the last: {error}");
                return Err(BadInput(what).into());
            }
            say!("{refused} refused, the last: {error}");
        }
        if let Some(error) = &self.odd_block {
            say!("{} left out, the last: {error}", counted(counters.odd_blocks, "block"));
        }
        if let Some(closed) = self.decoder.closed_sector() {
            say!(
                "the lidar is set to a field of view: {closed}; what lies in the closed sector stays unknown"
            );
        }
        player.standing.say_height();
        let packets = counted(counters.accepted, "packet");
        say!("{packets} of the lidar ({} refused, {} lost)", counters.refused, counters.lost);
        Ok(())
    }
}

impl Player {
    fn sweep(&mut self, sweep: &Sweep) {
        self.standing.look(sweep, self.stages.rings());
        let context = self.standing.context();
        let row = self.stages.sweep(sweep, &context, "sensor").with_closed(sweep, self.closed_cdeg);
        self.sweeps.frame(&row);
        let motion = (context.base_in_odom, context.twist);
        let rings = *self.stages.rings();
        self.recorded.sweep((sweep, &rings), (&context.sensor_in_base, motion), row.everybody());
        self.print(&row);
    }

    fn scanner(&mut self, scanner: &mut microscan3::Receiver, datagram: &Datagram) {
        scanner.push(&datagram.payload, Stamp::from_micros(datagram.captured_us), |event| {
            if let microscan3::Event::Scan(scan) = event {
                let row = self.stages.scan("microScan3", scan, (Pose2::default(), None));
                self.scans.frame(&row);
                self.recorded.scan(scan, Pose2::default(), row.everybody());
                self.print(&row);
            }
        });
    }

    fn print(&mut self, row: &FrameRow) {
        if self.json && self.failed.is_ok() {
            self.failed = print(row);
        }
    }

    fn conclude(self, scanner: &microscan3::Receiver) -> anyhow::Result<()> {
        let counters = scanner.counters();
        if counters.assembly.datagrams > 0 {
            let messages = counted(u64::from(counters.assembly.messages), "message");
            let refused = counters.assembly.refused;
            say!("{messages} of a microScan3 ({refused} datagrams refused)");
        }
        for (summary, what) in [(&self.sweeps, "sweep"), (&self.scans, "scan")] {
            if summary.frames > 0 {
                say!("{}", summary.line(what));
            }
            summary.say_standing(what);
        }
        self.stages.say_times();
        self.recorded.finish()
    }
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
