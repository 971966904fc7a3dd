//! Simulator and robot in one thread on a virtual clock: a day of robot time in minutes, every run repeatable.

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_core::time::Stamp;
use floorguard_drivers::can::CanFrame;
use floorguard_runtime::shared::{Shared, StopRecord};
use floorguard_runtime::tape::TapeLine;
use floorguard_sim::simulation::{Payload, Simulation, Stream, WireEvent};
use floorguard_sim::{CanFrame as SimCanFrame, FaultLayer};

use super::observer::Observer;
use super::operator::Operator;
use super::plan::Plan;
use super::spawn::{GuardCarriers, new_perception, new_shared, spawn_guard_ring, spawn_perception_ring};
use super::witnesses::Witnesses;
use crate::carriers::{CanPipe, DatagramPipe, DuplexPipe, PipeReader, PipeWriter, byte_pipe};
use crate::executor::{TaskSet, advance_virtual, next_timer_us, use_real_clock, use_virtual_clock};

/// How often truth is compared with what the robot does, microseconds.
const JUDGE_US: u64 = 10_000;

/// The lines between simulator and robot.
struct Lines {
    lidar: DatagramPipe,
    scanner: PipeWriter,
    imu: PipeWriter,
    can: CanPipe,
}

/// The robot's ends of the serial lines.
struct Ends {
    scanner: PipeReader,
    imu: DuplexPipe,
    /// What the robot writes to the inertial sensor.
    from_imu_line: PipeReader,
}

/// The bit rate that the simulated inertial sensor has.
pub(super) const IMU_BAUD: u32 = 115_200;

impl Lines {
    fn new() -> (Self, Ends) {
        let (scanner, scanner_reader) = byte_pipe();
        let (imu, imu_reader) = byte_pipe();
        let (to_imu, from_imu_line) = byte_pipe();
        let lines = Self { lidar: DatagramPipe::default(), scanner, imu, can: CanPipe::default() };
        let imu = DuplexPipe { reader: imu_reader, writer: to_imu };
        (lines, Ends { scanner: scanner_reader, imu, from_imu_line })
    }

    fn deliver(&self, event: WireEvent, now_us: u64, witnesses: &mut Witnesses) {
        let when = (now_us, event.at_us);
        match (event.stream, event.payload) {
            (Stream::LidarData, Payload::Bytes(bytes)) => {
                witnesses.delivered(when, TapeLine::Lidar, &bytes);
                self.lidar.push(Stamp::from_micros(event.at_us), bytes);
            }
            (Stream::ScannerSerial, Payload::Bytes(bytes)) => {
                witnesses.delivered(when, TapeLine::Scanner, &bytes);
                self.scanner.push(&bytes);
            }
            (Stream::ImuSerial, Payload::Bytes(bytes)) => {
                witnesses.delivered(when, TapeLine::Imu, &bytes);
                self.imu.push(&bytes);
            }
            (Stream::Can, Payload::Frame(frame)) => {
                let [low, high] = (frame.id as u16).to_le_bytes();
                let bytes: Vec<u8> = [low, high].iter().chain(frame.payload()).copied().collect();
                witnesses.delivered(when, TapeLine::Can, &bytes);
                self.can.push(CanFrame::standard(frame.id as u16, frame.payload()));
            }
            // Position packets only discipline the lidar's clock, which the arrival times already do.
            _ => {}
        }
    }
}

/// Plays a plan to its end. The observer sees every moment of 10 ms.
///
/// # Errors
/// The robot cannot be configured, or one of its tasks spins.
pub fn run_virtual(plan: &Plan, observer: &mut Observer<'_>) -> anyhow::Result<()> {
    run_recorded(plan, observer, &mut Witnesses::default())
}

/// The same, with witnesses.
///
/// # Errors
/// As [`run_virtual`].
pub fn run_recorded(
    plan: &Plan,
    observer: &mut Observer<'_>,
    witnesses: &mut Witnesses,
) -> anyhow::Result<()> {
    let mut simulation = Simulation::new(&plan.scenario, plan.seed)?;
    use_virtual_clock(0);
    let outcome = play(plan, &mut simulation, (observer, witnesses));
    use_real_clock();
    outcome
}

fn play(
    plan: &Plan,
    simulation: &mut Simulation,
    (observer, witnesses): (&mut Observer<'_>, &mut Witnesses),
) -> anyhow::Result<()> {
    let shared: Box<Shared<NoopRawMutex>> = new_shared(&plan.robot, Stamp::ZERO)
        .map_err(|error| anyhow::anyhow!("the guard refuses the robot: {error}"))?;
    let mut perception = new_perception(&plan.robot);
    let (lines, Ends { scanner, imu, from_imu_line }) = Lines::new();
    let mut faults = FaultLayer::new(&plan.faults, plan.seed);
    let mut operator = Operator::new(plan.emergency_stop_us.clone());
    let mut tasks = TaskSet::new();
    let carriers = GuardCarriers {
        lidar: lines.lidar.clone(),
        scanner,
        imu: Some((imu, IMU_BAUD)),
        can: lines.can.clone(),
    };
    spawn_guard_ring(&mut tasks, &shared, &plan.robot, carriers);
    spawn_perception_ring(&mut tasks, &shared, &plan.robot, &mut perception);
    let mut judge_us = 0;
    let mut reset = false;
    loop {
        let now_us = simulation
            .next_event_us()
            .min(faults.next_event_us())
            .min(next_timer_us().unwrap_or(u64::MAX))
            .min(judge_us);
        if now_us > plan.duration_us {
            break;
        }
        simulation.advance_to(now_us, &mut |event| {
            faults.pass(event, &mut |event| lines.deliver(event, now_us, witnesses))
        });
        faults.release(now_us, &mut |event| lines.deliver(event, now_us, witnesses));
        advance_virtual(now_us);
        if std::mem::take(&mut reset) {
            shared.reset.signal(());
            witnesses.delivered((now_us, now_us), TapeLine::Reset, &[]);
        }
        tasks.poll_until_quiet()?;
        observer.after_tasks(&shared);
        for frame in lines.can.drain() {
            observer.on_frame(&frame, now_us);
            witnesses.sent(&frame, now_us);
            let id = u32::from(frame.standard_id().unwrap_or_default());
            simulation.receive_can(SimCanFrame::new(id, frame.payload()), now_us);
        }
        let bytes = from_imu_line.drain();
        if !bytes.is_empty() {
            simulation.receive(Stream::ImuSerial, &bytes);
        }
        witnesses.after_tasks(&shared, (now_us, observer.digest().value()));
        if now_us >= judge_us {
            judge_us += JUDGE_US;
            let state = shared.decision.get().map(|decision| decision.state).unwrap_or_default();
            let deed = operator.act(now_us, state);
            simulation.press_emergency_stop(deed.pressed);
            observer.on_emergency_stop(deed.pressed, now_us);
            // The button reaches the tasks with the next moment.
            reset = deed.reset;
            let stops: Vec<StopRecord> = std::iter::from_fn(|| shared.stops.try_pop()).collect();
            stops.iter().for_each(|stop| witnesses.stop(stop));
            observer.observe(simulation, &shared, &stops);
        }
    }
    observer.finish(operator.resets());
    Ok(witnesses.finish((plan.duration_us, observer.digest().value()))?)
}
