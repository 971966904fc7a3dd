//! Simulator on one thread, robot on two, and between them what a real robot has: UDP over the loopback, serial lines
//! and an SLCAN adapter as pseudo-terminals. Nothing repeats bit for bit here; the verdict must be the same all the same.

use std::net::UdpSocket;
use std::time::Duration;

use anyhow::Context;
use floorguard_core::time::Stamp;
use floorguard_drivers::can::CanFrame;
use floorguard_runtime::clock;
use floorguard_runtime::shared::StopRecord;
use floorguard_sim::can::{SlcanDecoder, encode_slcan};
use floorguard_sim::simulation::{Payload, Simulation, Stream, WireEvent};
use floorguard_sim::{CanFrame as SimCanFrame, FaultLayer};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::observer::Observer;
use super::operator::Operator;
use super::plan::Plan;
use super::spawn::new_shared;
use crate::carriers::PseudoTerminal;
use crate::configuration::{CanAddress, SerialAddress};
use crate::executor::{Ring, StopFlag, take_priority};
use crate::robot::{HostedShared, Links, run_rings};

/// How often truth is compared with what the robot does, microseconds.
const JUDGE_US: u64 = 10_000;
/// Bit rates of the simulated lines; a pseudo-terminal takes any.
const SCANNER_BAUD: u32 = 500_000;
const IMU_BAUD: u32 = 115_200;
/// A read takes what is there, up to this.
const PORTION_BYTES: usize = 4_096;

/// What the real carriers did to the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CarrierFigures {
    /// The simulator was behind the clock by at most this, microseconds.
    pub latest_us: u64,
    /// Bytes and datagrams that a full line refused.
    pub refused: u64,
}

/// The simulator's ends of the lines.
struct Ends {
    lidar: UdpSocket,
    scanner: PseudoTerminal,
    imu: PseudoTerminal,
    can: PseudoTerminal,
    adapter: SlcanDecoder,
    refused: u64,
}

impl Ends {
    /// Both ends: the simulator's and the robot's.
    fn open() -> anyhow::Result<(Self, Links)> {
        let robot_lidar = UdpSocket::bind("127.0.0.1:0").context("no UDP port on the loopback")?;
        let lidar = UdpSocket::bind("127.0.0.1:0")?;
        lidar.connect(robot_lidar.local_addr()?)?;
        let terminal = || PseudoTerminal::open().context("no pseudo-terminal");
        let (scanner, imu, can) = (terminal()?, terminal()?, terminal()?);
        let links = Links {
            lidar: robot_lidar,
            scanner: SerialAddress { device: scanner.device.clone(), baud: SCANNER_BAUD },
            imu: Some(SerialAddress { device: imu.device.clone(), baud: IMU_BAUD }),
            can: CanAddress::Slcan(can.device.clone()),
        };
        Ok((Self { lidar, scanner, imu, can, adapter: SlcanDecoder::default(), refused: 0 }, links))
    }

    fn deliver(&mut self, event: WireEvent) {
        let delivered = match (event.stream, event.payload) {
            (Stream::LidarData, Payload::Bytes(bytes)) => self.lidar.send(&bytes).is_ok(),
            (Stream::ScannerSerial, Payload::Bytes(bytes)) => write_all(&self.scanner, &bytes),
            (Stream::ImuSerial, Payload::Bytes(bytes)) => write_all(&self.imu, &bytes),
            (Stream::Can, Payload::Frame(frame)) => write_all(&self.can, encode_slcan(&frame).as_bytes()),
            _ => true,
        };
        self.refused += u64::from(!delivered);
    }

    /// What the robot has written to the bus and to the inertial sensor.
    fn receive(&mut self) -> (Vec<SimCanFrame>, Vec<u8>) {
        let (frames, replies) = self.adapter.push(&read_all(&self.can));
        self.refused += u64::from(!write_all(&self.can, &replies));
        (frames, read_all(&self.imu))
    }

    /// Sleeps until the robot writes something, or a time has passed.
    fn wait(&self, at_most_us: u64) -> anyhow::Result<()> {
        let mut lines = [&self.can, &self.imu].map(|line| PollFd::new(&line.near, PollFlags::IN));
        let timeout = Timespec { tv_sec: 0, tv_nsec: (at_most_us.min(JUDGE_US) * 1_000) as i64 };
        match poll(&mut lines, Some(&timeout)) {
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
        // A terminal that nobody has opened yet is always ready to say so.
        if lines.iter().any(|line| line.revents().contains(PollFlags::HUP)) {
            std::thread::sleep(Duration::from_micros(at_most_us.clamp(200, 1_000)));
        }
        Ok(())
    }
}

fn write_all(line: &PseudoTerminal, bytes: &[u8]) -> bool {
    bytes.is_empty() || rustix::io::write(&line.near, bytes).is_ok_and(|count| count == bytes.len())
}

fn read_all(line: &PseudoTerminal) -> Vec<u8> {
    let mut bytes = vec![0; PORTION_BYTES];
    // Nothing there, or nobody at the other end yet: no bytes.
    let count = rustix::io::read(&line.near, &mut bytes[..]).unwrap_or(0);
    bytes.truncate(count);
    bytes
}

/// Plays a plan in real time over real carriers.
///
/// # Errors
/// A carrier could not be opened, or a ring failed.
pub fn run_real(plan: &Plan, observer: &mut Observer<'_>) -> anyhow::Result<CarrierFigures> {
    let mut simulation = Simulation::new(&plan.scenario, plan.seed)?;
    let (mut ends, links) = Ends::open()?;
    let start = clock::now();
    observer.set_clock_start(start);
    let shared: Box<HostedShared> = new_shared(&plan.robot, start)
        .map_err(|error| anyhow::anyhow!("the guard refuses the robot: {error}"))?;
    let flag = StopFlag::default();
    anstream::eprintln!("  {}", take_priority(Ring::World));
    let beside = || play((plan, start), &mut simulation, (&mut ends, &shared, &flag), observer);
    run_rings((&plan.robot, links), &shared, &flag, beside)?
}

fn play(
    (plan, start): (&Plan, Stamp),
    simulation: &mut Simulation,
    (ends, shared, flag): (&mut Ends, &HostedShared, &StopFlag),
    observer: &mut Observer<'_>,
) -> anyhow::Result<CarrierFigures> {
    let mut faults = FaultLayer::new(&plan.faults, plan.seed);
    let mut operator = Operator::new(plan.emergency_stop_us.clone());
    let mut judge_us = 0;
    let mut latest_us = 0;
    let clock_us = || clock::now().as_micros().saturating_sub(start.as_micros());
    while !flag.is_stopped() {
        let now_us = clock_us();
        if now_us > plan.duration_us {
            break;
        }
        // Truth is looked at every 10 ms of the world's time, however late this thread is.
        let to_us = now_us.min(judge_us);
        latest_us = latest_us.max(now_us - to_us);
        simulation.advance_to(to_us, &mut |event| faults.pass(event, &mut |event| ends.deliver(event)));
        faults.release(to_us, &mut |event| ends.deliver(event));
        let (frames, imu) = ends.receive();
        for frame in frames {
            observer.on_frame(&CanFrame::standard(frame.id as u16, frame.payload()), to_us);
            simulation.receive_can(frame, to_us);
        }
        if !imu.is_empty() {
            simulation.receive(Stream::ImuSerial, &imu);
        }
        observer.after_tasks(shared);
        if to_us >= judge_us {
            judge_us += JUDGE_US;
            let state = shared.decision.get().map(|decision| decision.state).unwrap_or_default();
            let deed = operator.act(to_us, state);
            simulation.press_emergency_stop(deed.pressed);
            observer.on_emergency_stop(deed.pressed, to_us);
            if deed.reset {
                shared.reset.signal(());
            }
            let stops: Vec<StopRecord> = std::iter::from_fn(|| shared.stops.try_pop()).collect();
            observer.observe(simulation, shared, &stops);
        }
        let due_us = simulation.next_event_us().min(faults.next_event_us()).min(judge_us);
        ends.wait(due_us.saturating_sub(clock_us()))?;
    }
    observer.finish(operator.resets());
    Ok(CarrierFigures { latest_us, refused: ends.refused })
}
