//! Plays the simulated world on the board's own clock.
//!
//! The world never runs ahead of the board: it is advanced to the time that the board reports, and no more datagrams
//! are in flight than its Ethernet controller holds. So a busy host makes the run slower, not worse.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::Context;
use floorguard_laboratory::world::Plan;
use floorguard_operator::telemetry::Tape;
use floorguard_sim::can::{CanFrame, SlcanDecoder, encode_slcan};
use floorguard_sim::{Payload, Simulation, Stream, WireEvent};

use super::board::Board;
use super::outcome::Outcome;
use super::report::Report;

/// What to play.
#[derive(Clone, Debug)]
pub struct Options {
    /// The linked image.
    pub image: PathBuf,
    /// Scenario of the simulator.
    pub scenario: String,
    /// Seed of all randomness.
    pub seed: u64,
    /// Board's time, microseconds.
    pub duration_us: u64,
}

/// Bytes in flight on the lines of scanner, inertial sensor and CAN adapter: what a busy host was late with does not
/// arrive all at once, as it would on no wire. Two telegrams, 70 ms of samples, 100 ms of the bus.
const BYTES_IN_FLIGHT: [u64; 3] = [2_216, 512, 1_024];
/// Between two datagrams, microseconds: three quarters of the lidar's own pause, so that a busy host can catch up.
const PACKET_US: u64 = 1_000;
/// Datagrams in flight: the emulated controller holds eight.
const WINDOW: u32 = 6;
/// After the end, what is in flight or still waits for a line has this long to arrive, microseconds of the board's
/// time.
const DRAIN_US: u64 = 10_000_000;
/// NMT: stop, all nodes.
const STOP_ALL_NODES: [u8; 2] = [2, 0];
/// First process data of the traction drive, node 1 (book, CANopen: Process data): control word and target velocity.
const TRACTION_ORDER: u32 = 0x201;
/// Control word of an enabled operation, in its lowest bits.
const OPERATE: u8 = 0x0f;
/// State of the guard that waits for an operator.
const LATCHED: u32 = 4;
/// State of the guard that waits for the start command.
const AWAITS_START: u32 = 5;
/// How long the operator looks around first, microseconds.
const RESET_DELAY_US: u64 = 3_000_000;

/// The world's end of the wires.
pub(super) struct World {
    simulation: Simulation,
    adapter: SlcanDecoder,
    datagrams: VecDeque<Vec<u8>>,
    pub(super) outcome: Outcome,
    /// The board commanded all nodes of the bus to stop.
    pub(super) stopped_nodes: bool,
    /// Since when the traction drive is commanded to stand, microseconds of the world's time; `None` while it is
    /// commanded to move.
    pub(super) ordered_to_stand_us: Option<u64>,
    /// How long the operator looks around before a reset, microseconds.
    pub(super) reset_delay_us: u64,
    /// The board's time when it was served last, microseconds.
    served_us: u64,
    /// Time in which no datagram was sent, up to a window of them.
    packets_allowed_us: u64,
    /// Datagrams that may be in flight.
    pub(super) window: u32,
    latched_since_us: Option<u64>,
}

/// Runs the image with the world on its wires.
///
/// # Errors
/// The emulator or the firmware fails.
pub fn run(options: &Options) -> anyhow::Result<Outcome> {
    let plan = Plan::named(&options.scenario, options.seed, options.duration_us)?;
    let folder = tempfile::tempdir()?;
    let mut board =
        Board::start(&options.image, &Tape::new(&plan.robot, plan.duration_us).finish(), 0, folder.path())?;
    let mut world = World::new(&plan)?;
    let began = Instant::now();
    let start = greet(&board)?;
    let began_at = world.simulation.robot().0;
    let end_us = start.now_us + plan.duration_us;
    let mut newest = start;
    while newest.now_us < end_us + DRAIN_US && !(newest.now_us >= end_us && world.is_drained(&board, &newest))
    {
        newest = newest_report(&board)?;
        world.serve(&mut board, &newest, newest.now_us.min(end_us) - start.now_us)?;
    }
    let lines = [&board.scanner, &board.imu, &board.can];
    let mut outcome = world.outcome;
    outcome.bytes_sent = lines.map(|line| line.sent);
    let ended_at = world.simulation.robot().0;
    outcome.driven_m = (ended_at.x_m - began_at.x_m).hypot(ended_at.y_m - began_at.y_m);
    outcome.seconds = [(newest.now_us - start.now_us) as f64 * 1.0e-6, began.elapsed().as_secs_f64()];
    outcome.board = newest;
    board.quit()?;
    Ok(outcome)
}

/// Says hello until the board answers.
pub(super) fn greet(board: &Board) -> anyhow::Result<Report> {
    let patience = Instant::now() + Duration::from_secs(30);
    board.bench.set_read_timeout(Some(Duration::from_millis(100)))?;
    while Instant::now() < patience {
        board.bench.send(b"H")?;
        let mut bytes = [0; 256];
        let answer = board.bench.recv(&mut bytes).ok();
        if let Some(report) = answer.and_then(|length| Report::parse(bytes.get(..length)?)) {
            board.bench.set_read_timeout(Some(Duration::from_secs(20)))?;
            return Ok(report);
        }
    }
    anyhow::bail!("the firmware does not answer on its network")
}

/// Waits for a report, and takes the newest that is there.
pub(super) fn newest_report(board: &Board) -> anyhow::Result<Report> {
    let mut bytes = [0; 256];
    let length = board.bench.recv(&mut bytes).context("the firmware has fallen silent")?;
    let mut newest = bytes.get(..length).and_then(Report::parse);
    board.bench.set_nonblocking(true)?;
    while let Ok(length) = board.bench.recv(&mut bytes) {
        newest = bytes.get(..length).and_then(Report::parse).or(newest);
    }
    board.bench.set_nonblocking(false)?;
    newest.context("the firmware reports in words that nobody knows")
}

/// What a frame tells the traction drive: to stand, or to move; `None`: nothing.
fn orders_standstill(frame: &CanFrame) -> Option<bool> {
    if frame.id != TRACTION_ORDER {
        return None;
    }
    let [word, _, target @ ..] = frame.payload() else { return None };
    Some(*word & OPERATE != OPERATE || target.iter().all(|byte| *byte == 0))
}

impl World {
    /// At its beginning.
    ///
    /// # Errors
    /// The scenario cannot be played.
    pub(super) fn new(plan: &Plan) -> anyhow::Result<Self> {
        Ok(Self {
            simulation: Simulation::new(&plan.scenario, plan.seed)?,
            adapter: SlcanDecoder::default(),
            datagrams: VecDeque::new(),
            outcome: Outcome::default(),
            stopped_nodes: false,
            ordered_to_stand_us: Some(0),
            window: WINDOW,
            served_us: 0,
            packets_allowed_us: 0,
            reset_delay_us: RESET_DELAY_US,
            latched_since_us: None,
        })
    }

    /// Everything has arrived.
    fn is_drained(&self, board: &Board, report: &Report) -> bool {
        let lines = [(&board.scanner, report.scanner_bytes), (&board.imu, report.imu_bytes)];
        let can = (&board.can, report.can_bytes);
        let datagrams = self.datagrams.is_empty() && self.outcome.lidar_sent == report.lidar;
        datagrams && lines.into_iter().chain([can]).all(|(line, taken)| line.sent == u64::from(taken))
    }

    /// Brings the world to `to_us`, and what it says to the board.
    pub(super) fn serve(&mut self, board: &mut Board, report: &Report, to_us: u64) -> anyhow::Result<()> {
        let datagrams = &mut self.datagrams;
        self.simulation.advance_to(to_us, &mut |WireEvent { stream, payload, .. }| match (stream, payload) {
            (Stream::LidarData, Payload::Bytes(bytes)) => datagrams.push_back(bytes),
            (Stream::ScannerSerial, Payload::Bytes(bytes)) => board.scanner.send(&bytes),
            (Stream::ImuSerial, Payload::Bytes(bytes)) => board.imu.send(&bytes),
            (Stream::Can, Payload::Frame(frame)) => board.can.send(encode_slcan(&frame).as_bytes()),
            _ => {}
        });
        self.listen(board, to_us)?;
        let orders = board.imu.receive()?;
        if !orders.is_empty() {
            self.simulation.receive(Stream::ImuSerial, &orders);
        }
        let elapsed_us = report.now_us.saturating_sub(self.served_us);
        self.served_us = report.now_us;
        let lines = [
            (&mut board.scanner, report.scanner_bytes),
            (&mut board.imu, report.imu_bytes),
            (&mut board.can, report.can_bytes),
        ];
        for ((line, taken), window) in lines.into_iter().zip(BYTES_IN_FLIGHT) {
            line.flush(taken, window, elapsed_us)?;
        }
        self.packets_allowed_us = (self.packets_allowed_us + elapsed_us).min(u64::from(WINDOW) * PACKET_US);
        let in_flight = self.outcome.lidar_sent.wrapping_sub(report.lidar);
        let allowed = self.window.saturating_sub(in_flight).min((self.packets_allowed_us / PACKET_US) as u32);
        for _ in 0..allowed {
            let Some(datagram) = self.datagrams.pop_front() else { break };
            board.lidar.send(&datagram)?;
            self.outcome.lidar_sent += 1;
            self.packets_allowed_us -= PACKET_US;
        }
        self.operate(board, report, to_us)
    }

    /// Takes what the board has put on the bus.
    pub(super) fn listen(&mut self, board: &mut Board, to_us: u64) -> anyhow::Result<()> {
        let (frames, replies) = self.adapter.push(&board.can.receive()?);
        board.can.send(&replies);
        for frame in frames {
            self.outcome.frames_received += 1;
            self.stopped_nodes |= frame.id == 0 && frame.payload() == STOP_ALL_NODES;
            if let Some(stands) = orders_standstill(&frame) {
                let since_us = self.ordered_to_stand_us.unwrap_or(to_us);
                self.ordered_to_stand_us = stands.then_some(since_us);
            }
            self.simulation.receive_can(frame, to_us);
        }
        Ok(())
    }

    /// The person with the key: resets what is latched, and gives the start command when the robot waits for it.
    fn operate(&mut self, board: &Board, report: &Report, to_us: u64) -> anyhow::Result<()> {
        if report.state == AWAITS_START {
            board.bench.send(b"S")?;
        }
        if report.state != LATCHED {
            self.latched_since_us = None;
        } else if to_us - *self.latched_since_us.get_or_insert(to_us) >= self.reset_delay_us {
            self.latched_since_us = None;
            board.bench.send(b"R")?;
        }
        Ok(())
    }
}
