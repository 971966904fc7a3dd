//! One exported function per stage, so that the linker keeps it and the audit finds it by name.

use core::hint::black_box;

use floorguard_guard::{Advice, Decision, GuardConfig, Supervisor};
use floorguard_types::geometry::Twist2;
use floorguard_types::sensing::{DiscreteInputs, DriveFeedback, ImuSample, LidarPacket, Scan};
use floorguard_types::time::Stamp;

use crate::{drivers, perception};

/// Reaches every root; the linker starts here. The image is read, never run, so the arguments do not matter.
#[unsafe(no_mangle)]
pub extern "C" fn entry(state: Option<&mut ImageState>) {
    let Some(state) = state else { return };
    let now = state.now;
    root_guard_scan(&mut state.guard, &state.scan, now);
    root_guard_packet(&mut state.guard, &state.packet, now);
    root_memory_scan(&mut state.guard, &state.scan);
    root_memory_packet(&mut state.guard, &state.packet);
    root_guard_inputs(&mut state.guard, &state.inputs, now);
    root_guard_motion(state, now);
    root_guard_advice(&mut state.guard, &state.advice, now);
    root_guard_tick(&mut state.guard, now);
    root_guard_start(&mut state.started, &state.config, now);
    drivers::all(&mut state.drivers, now);
    perception::all(&mut state.perception, now);
}

/// All state of the image.
pub struct ImageState {
    guard: Supervisor,
    started: Supervisor,
    config: GuardConfig,
    drivers: drivers::Drivers,
    perception: perception::Perception,
    scan: Scan,
    packet: LidarPacket,
    inputs: DiscreteInputs,
    imu: ImuSample,
    drive: DriveFeedback,
    advice: Advice,
    wanted: Twist2,
    now: Stamp,
}

#[inline(never)]
fn root_guard_scan(guard: &mut Supervisor, scan: &Scan, now: Stamp) -> Decision {
    black_box(guard.on_scan(scan, now))
}

#[inline(never)]
fn root_guard_packet(guard: &mut Supervisor, packet: &LidarPacket, now: Stamp) -> Decision {
    black_box(guard.on_lidar_packet(packet, now))
}

#[inline(never)]
fn root_memory_scan(guard: &mut Supervisor, scan: &Scan) {
    guard.remember_scan(black_box(scan));
}

#[inline(never)]
fn root_memory_packet(guard: &mut Supervisor, packet: &LidarPacket) {
    guard.remember_packet(black_box(packet));
    guard.remember_more(black_box(packet));
}

#[inline(never)]
fn root_guard_inputs(guard: &mut Supervisor, inputs: &DiscreteInputs, now: Stamp) -> Decision {
    black_box(guard.on_discrete(inputs, now))
}

#[inline(never)]
fn root_guard_motion(state: &mut ImageState, now: Stamp) -> Decision {
    state.guard.on_wheels(state.wanted, now, now);
    state.guard.on_imu(&state.imu, now);
    state.guard.on_drive(&state.drive, now);
    black_box(state.guard.on_command(state.wanted, now, now))
}

#[inline(never)]
fn root_guard_advice(guard: &mut Supervisor, advice: &Advice, now: Stamp) -> Decision {
    black_box(guard.on_advice(advice, now))
}

#[inline(never)]
fn root_guard_tick(guard: &mut Supervisor, now: Stamp) -> Decision {
    guard.request_reset(now);
    black_box(guard.tick(now))
}

/// Configuring the guard is start-up work; it is linked so that its code is read too. It happens where the guard stays, as on the
/// boards, which give it a static.
#[inline(never)]
fn root_guard_start(guard: &mut Supervisor, config: &GuardConfig, now: Stamp) {
    let _ = black_box(guard.configure(config.clone(), now));
}
