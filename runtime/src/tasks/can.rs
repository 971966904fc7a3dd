//! The CAN bus: encoders, drives and safety inputs in, the permitted command out.
//!
//! A decision below the last command to the drives goes out at once; one that allows more waits for the next 10 ms.

use embassy_futures::select::{Either3, select3};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::{Duration, Ticker, Timer};
use floorguard_drivers::can::CanFrame;
use floorguard_drivers::three_wheel_base::BaseEvent;
use floorguard_guard::{FaultKind, Source};
use heapless::Vec;

use super::bus_base::{BaseKinematics, BusBase};
use super::drive_order::DriveOrder;
use super::supervise::TICK_MS;
use crate::clock;
use crate::io::CanBus;
use crate::shared::{BusReport, Shared};

/// Frames that one poll may send: SYNC, heartbeat, two commands, and two for each of five devices that start.
const FRAMES_MAX: usize = 16;
/// Pause after a failure of the link, milliseconds.
const RETRY_MS: u64 = 20;

type Frames = Vec<CanFrame, FRAMES_MAX>;

/// Guard ring. Runs for ever.
pub async fn can_bus<M: RawMutex, B: BusBase, K: BaseKinematics<Command = B::Command>>(
    shared: &Shared<M>,
    mut bus: impl CanBus,
    (mut base, kinematics): (B, K),
) {
    let mut ticker = Ticker::every(Duration::from_millis(TICK_MS));
    let mut order = DriveOrder::new(kinematics);
    let mut reported = None;
    loop {
        let mut frames = Frames::new();
        // The bus gives way before it takes a frame: a decision and a tick that are due come first. Asked before it, decisions
        // that follow each other closely would keep it from taking any.
        match select3(bus.receive(), shared.decision.next(), ticker.next()).await {
            Either3::First(Ok(frame)) => {
                let now = clock::now();
                base.on_frame(&frame, now, &mut |mut event| {
                    if let BaseEvent::Drive(drive) = &mut event {
                        order.steering_rad = drive.steering_rad;
                        *drive = kinematics.heard(*drive);
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
                if let Some(command) = order.command().filter(|new| K::is_tighter(*new, base.commanded())) {
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
fn report_changes<M: RawMutex>(shared: &Shared<M>, base: &impl BusBase, reported: &mut Option<BusReport>) {
    let report = Some(base.report());
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
fn command_of_tick<M: RawMutex, B: BusBase, K: BaseKinematics<Command = B::Command>>(
    shared: &Shared<M>,
    (base, order): (&B, &DriveOrder<K>),
) -> B::Command {
    order.command().filter(|_| base.is_whole()).unwrap_or_else(|| {
        shared.decide(|guard| guard.on_corruption(clock::now()));
        K::TORQUE_OFF
    })
}
