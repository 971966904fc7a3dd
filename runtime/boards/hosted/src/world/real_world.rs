//! Simulator on one thread, robot on two, and between them what a real robot has: UDP over the loopback, serial lines
//! and an SLCAN adapter as pseudo-terminals. Nothing repeats bit for bit here; the verdict must be the same all the same.

use floorguard_core::time::Stamp;
use floorguard_drivers::can::CanFrame;
use floorguard_runtime::clock;
use floorguard_runtime::shared::StopRecord;
use floorguard_sim::FaultLayer;
use floorguard_sim::simulation::{Simulation, Stream};

use super::ends::Ends;
use super::observer::Observer;
use super::operator::Operator;
use super::plan::Plan;
use super::spawn::new_shared;
use crate::executor::{Ring, StopFlag, take_priority};
use crate::robot::{HostedShared, run_rings};

/// How often truth is compared with what the robot does, microseconds.
const JUDGE_US: u64 = 10_000;
/// What the real carriers did to the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CarrierFigures {
    /// The simulator was behind the clock by at most this, microseconds.
    pub latest_us: u64,
    /// Bytes and datagrams that a full line refused.
    pub refused: u64,
}

/// Plays a plan in real time over real carriers. The CAN bus is an interface of the kernel, if one is named, otherwise an
/// SLCAN adapter.
///
/// # Errors
/// A carrier could not be opened, or a ring failed.
pub fn run_real(
    plan: &Plan,
    can_interface: Option<&str>,
    observer: &mut Observer<'_>,
) -> anyhow::Result<CarrierFigures> {
    let mut simulation = Simulation::new(&plan.scenario, plan.seed)?;
    let (mut ends, links) = Ends::open(can_interface)?;
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
