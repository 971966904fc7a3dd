//! The CAN bus: encoders, drives and safety inputs in, the permitted command out.
//!
//! A decision below the last command to the drives goes out at once; one that allows more waits for the next 10 ms.

use embassy_futures::select::{Either3, select3};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::{Duration, Ticker, Timer};
use floorguard_drivers::can::CanFrame;
use floorguard_drivers::three_wheel_base::{BaseEvent, DriveCommand, StopKind, ThreeWheelBase};
use floorguard_guard::{FaultKind, Source};
use floorguard_localisation::odometry::Tricycle;
use heapless::Vec;

use super::drive_order::DriveOrder;
use super::supervise::TICK_MS;
use crate::clock;
use crate::io::CanBus;
use crate::shared::{BusReport, Shared};

/// Frames that one poll may send: SYNC, heartbeat, two commands, and two for each of five devices that start.
const FRAMES_MAX: usize = 16;
/// Pause after a failure of the link, milliseconds.
const RETRY_MS: u64 = 20;
/// A command that differs by less is the same, m/s.
const SAME_MPS: f32 = 1.0e-3;

type Frames = Vec<CanFrame, FRAMES_MAX>;

/// Guard ring. Runs for ever.
pub async fn can_bus<M: RawMutex>(
    shared: &Shared<M>,
    mut bus: impl CanBus,
    (mut base, tricycle): (ThreeWheelBase, Tricycle),
) {
    let mut ticker = Ticker::every(Duration::from_millis(TICK_MS));
    let mut order = DriveOrder::new(tricycle);
    let mut reported = None;
    loop {
        let mut frames = Frames::new();
        // The bus gives way before it takes a frame: a decision and a tick that are due come first. Asked before it, decisions
        // that follow each other closely would keep it from taking any.
        match select3(bus.receive(), shared.decision.next(), ticker.next()).await {
            Either3::First(Ok(frame)) => {
                let now = clock::now();
                base.on_frame(&frame, now, &mut |event| {
                    if let BaseEvent::Drive(drive) = &event {
                        order.steering_rad = drive.steering_rad;
                    }
                    take_in(shared, &event);
                });
            }
            Either3::First(Err(_)) => {
                fail(shared);
                Timer::after_millis(RETRY_MS).await;
            }
            Either3::Second(decision) => {
                order.follow(&decision);
                if let Some(command) = order.command().filter(|new| is_tighter(*new, base.commanded())) {
                    base.command(command);
                    base.send_command(&mut |frame| collect(&mut frames, frame));
                }
            }
            // A decision is taken up before the tick: the order is that of the newest one.
            Either3::Third(()) => {
                base.command(command_of_tick(shared, (&base, &order)));
                if shared.drive_reset.signaled() {
                    shared.drive_reset.reset();
                    base.reset_faults();
                }
                let send = &mut |frame: &CanFrame| collect(&mut frames, frame);
                base.poll(clock::now(), &mut |event| take_in(shared, &event), send);
                report_changes(shared, &base, &mut reported);
            }
        }
        for frame in &frames {
            if bus.send(frame).await.is_err() {
                fail(shared);
            }
        }
        let sent = frames.len() as u32;
        shared.count(|links| links.can_sent = links.can_sent.saturating_add(sent));
    }
}

/// Publishes the devices' progress when it changes.
fn report_changes<M: RawMutex>(shared: &Shared<M>, base: &ThreeWheelBase, reported: &mut Option<BusReport>) {
    let report = Some(BusReport::of(base));
    if *reported != report {
        *reported = report;
        report.into_iter().for_each(|report| shared.bus.publish(report));
    }
}

fn collect(frames: &mut Frames, frame: &CanFrame) {
    // Five devices that all start at once fill the list; what does not fit is asked again by time-out.
    let _ = frames.push(*frame);
}

fn fail<M: RawMutex>(shared: &Shared<M>) {
    shared.count(|links| links.can_errors = links.can_errors.saturating_add(1));
    let now = clock::now();
    shared.decide(|guard| guard.on_source_fault(Source::Drive, FaultKind::LinkDown, now));
}

fn take_in<M: RawMutex>(shared: &Shared<M>, event: &BaseEvent) {
    let now = clock::now();
    match event {
        BaseEvent::Wheels(sample) => {
            let (motion, is_whole) = shared.move_by(|motion| (motion.on_wheels(sample), motion.is_whole()));
            if let Some(motion) = motion {
                shared.decide(|guard| guard.on_wheels(motion.twist, motion.stamp, now));
            }
            if !is_whole {
                shared.decide(|guard| guard.on_corruption(now));
            }
        }
        BaseEvent::Drive(feedback) => {
            shared.decide(|guard| guard.on_drive(feedback, now));
        }
        BaseEvent::Inputs(inputs) => {
            shared.decide(|guard| guard.on_discrete(inputs, now));
        }
        BaseEvent::Dirt(reading) => shared.dirt.publish(*reading),
        BaseEvent::FoundRunning => {
            shared.decide(|guard| guard.on_found_running(now));
        }
        // The drives' reports carry the code; what a lost device no longer says grows old by itself.
        BaseEvent::Emergency(..) | BaseEvent::NodeLost(_) => {}
    }
}

/// What goes out with the tick. No torque, until the computer was restarted, when something of the base or of the order differs
/// from its copy (FG-REQ-058).
fn command_of_tick<M: RawMutex>(
    shared: &Shared<M>,
    (base, order): (&ThreeWheelBase, &DriveOrder),
) -> DriveCommand {
    order.command().filter(|_| base.is_whole()).unwrap_or_else(|| {
        shared.decide(|guard| guard.on_corruption(clock::now()));
        DriveCommand::Stop(StopKind::TorqueOff)
    })
}

/// Slower, or a stop of a severer kind.
fn is_tighter(new: DriveCommand, old: DriveCommand) -> bool {
    let rank = |command| match command {
        DriveCommand::Move { .. } => 0,
        DriveCommand::Stop(StopKind::Hold) => 1,
        DriveCommand::Stop(StopKind::Ramp) => 2,
        DriveCommand::Stop(StopKind::TorqueOff) => 3,
    };
    match (new, old) {
        (DriveCommand::Move { wheel_mps: new, .. }, DriveCommand::Move { wheel_mps: old, .. }) => {
            libm::fabsf(new) < libm::fabsf(old) - SAME_MPS
        }
        (new, old) => rank(new) > rank(old),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_asks_for_less_is_urgent() {
        let go = |wheel_mps| DriveCommand::Move { wheel_mps, steering_rad: 0.0 };
        let stop = DriveCommand::Stop;
        assert!(is_tighter(go(0.3), go(0.5)) && is_tighter(stop(StopKind::Hold), go(0.0)));
        assert!(is_tighter(stop(StopKind::TorqueOff), stop(StopKind::Ramp)));
        assert!(is_tighter(go(-0.1), go(0.5)));
        assert!(!is_tighter(go(0.5), go(0.3)) && !is_tighter(go(0.5), stop(StopKind::Hold)));
    }
}
