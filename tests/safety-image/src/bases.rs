//! A base with a CiA 402 drive on each wheel: it runs on a Linux computer, and is read like the rest.

use core::hint::black_box;

use floorguard_drivers::can::{CanFrame, encode_slcan};
use floorguard_drivers::wheel_drives::{WheelCommand, WheelDrives, WheelDrivesConfiguration};
use floorguard_types::time::Stamp;

/// State of the base.
pub struct Bases {
    wheels: WheelDrives,
    wheels_configuration: WheelDrivesConfiguration,
    command: WheelCommand,
    frame: CanFrame,
}

/// Reaches every root.
#[inline(always)]
pub fn all(state: &mut Bases, now: Stamp) {
    root_wheels_start(&mut state.wheels, state.wheels_configuration);
    root_wheels_frame(&mut state.wheels, &state.frame, now);
    root_wheels_poll(&mut state.wheels, state.command, now);
}

fn send(frame: &CanFrame) {
    black_box(encode_slcan(frame));
}

#[inline(never)]
fn root_wheels_start(base: &mut WheelDrives, configuration: WheelDrivesConfiguration) {
    *base = WheelDrives::new(configuration);
}

#[inline(never)]
fn root_wheels_frame(base: &mut WheelDrives, frame: &CanFrame, now: Stamp) {
    base.on_frame(frame, now, &mut |event| {
        black_box(&event);
    });
}

#[inline(never)]
fn root_wheels_poll(base: &mut WheelDrives, command: WheelCommand, now: Stamp) {
    base.command(command);
    base.reset_faults();
    base.send_command(&mut send);
    let mut event = |event| {
        black_box(&event);
    };
    base.poll(now, &mut event, &mut send);
}
