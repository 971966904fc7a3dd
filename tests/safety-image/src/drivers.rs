//! Every driver: bytes in, events out, and what it sends.

use core::hint::black_box;

use floorguard_drivers::can::{CanFrame, SlcanReceiver, encode_slcan};
use floorguard_drivers::canopen::{HeartbeatMonitor, NetworkCommand, SdoRequest, decode_sdo, network_frame};
use floorguard_drivers::inertial::InertialSensor;
use floorguard_drivers::lidar::{AnyDecoder, LidarDecoder};
use floorguard_drivers::microscan3;
use floorguard_drivers::s300;
use floorguard_drivers::three_wheel_base::{BaseConfiguration, DriveCommand, ThreeWheelBase};
use floorguard_drivers::velocity_link::{
    Acceptance, Arrival, LineReceiver, MotionReport, Permit, VelocityRequest,
};
use floorguard_drivers::velodyne::{Decoder, Gprmc, PositionPacket, SweepBuilder};
use floorguard_drivers::xsens;
use floorguard_types::sensing::{LidarPacket, Sweep};
use floorguard_types::time::Stamp;

/// State of the drivers.
pub struct Drivers {
    decoder: Decoder,
    any_lidar: AnyDecoder,
    sweeps: SweepBuilder,
    packet: LidarPacket,
    sweep: Sweep,
    receiver: s300::Receiver,
    microscan: microscan3::Receiver,
    lines: SlcanReceiver,
    base: ThreeWheelBase,
    configuration: BaseConfiguration,
    heartbeat: HeartbeatMonitor,
    request: SdoRequest,
    imu: xsens::Device,
    command: DriveCommand,
    frame: CanFrame,
    acceptance: Acceptance,
    line: LineReceiver,
    request_out: VelocityRequest,
    permit: Permit,
    bytes: [u8; 1_206],
}

/// Reaches every root.
#[inline(always)]
pub fn all(state: &mut Drivers, now: Stamp) {
    // Of unknown length: what is known to be a lidar packet would never reach the branches for everything else.
    let copy = state.bytes;
    let bytes: &[u8] = black_box(&copy);
    root_velodyne(&mut state.decoder, bytes, now);
    root_any_lidar((&mut state.any_lidar, &mut state.packet), bytes, now);
    root_sweep(&mut state.sweeps, &state.packet, &mut state.sweep);
    root_position(bytes);
    root_s300(&mut state.receiver, bytes, now);
    root_microscan3(&mut state.microscan, bytes, now);
    root_slcan(&mut state.lines, bytes);
    root_base_start(&mut state.base, state.configuration);
    root_base_frame(&mut state.base, &state.frame, now);
    root_base_poll(&mut state.base, state.command, now);
    root_xsens(&mut state.imu, bytes, now);
    root_canopen(state, now);
    root_velocity_request(state, bytes, now);
    root_velocity_permit(&state.permit, bytes);
}

#[inline(never)]
fn root_velodyne(decoder: &mut Decoder, bytes: &[u8], now: Stamp) {
    let _ = black_box(decoder.decode(bytes, now).is_ok());
}

#[inline(never)]
fn root_any_lidar((decoder, packet): (&mut AnyDecoder, &mut LidarPacket), bytes: &[u8], now: Stamp) {
    decoder.limit_lasers(16);
    let taken = decoder.decode_datagram(bytes, now, packet).is_ok();
    black_box((taken, decoder.left_out_block().is_some(), decoder.known_closed_sector().is_some()));
}

#[inline(never)]
fn root_sweep(sweeps: &mut SweepBuilder, packet: &LidarPacket, sweep: &mut Sweep) {
    sweeps.add(packet, black_box(1), sweep, |complete| {
        black_box(complete);
    });
}

#[inline(never)]
fn root_position(bytes: &[u8]) {
    if let Ok(packet) = PositionPacket::new_checked(bytes) {
        black_box((packet.stamp_us(), Gprmc::parse(packet.sentence()).is_ok()));
    }
}

#[inline(never)]
fn root_s300(receiver: &mut s300::Receiver, bytes: &[u8], now: Stamp) {
    receiver.push(bytes, now, |event| {
        black_box(&event);
    });
}

#[inline(never)]
fn root_microscan3(receiver: &mut microscan3::Receiver, datagram: &[u8], now: Stamp) {
    receiver.push(datagram, now, |event| {
        black_box(&event);
    });
}

#[inline(never)]
fn root_slcan(lines: &mut SlcanReceiver, bytes: &[u8]) {
    lines.push(bytes, |event| {
        black_box(&event);
    });
}

#[inline(never)]
fn root_base_start(base: &mut ThreeWheelBase, configuration: BaseConfiguration) {
    *base = ThreeWheelBase::new(configuration);
}

#[inline(never)]
fn root_base_frame(base: &mut ThreeWheelBase, frame: &CanFrame, now: Stamp) {
    base.on_frame(frame, now, &mut |event| {
        black_box(&event);
    });
}

#[inline(never)]
fn root_base_poll(base: &mut ThreeWheelBase, command: DriveCommand, now: Stamp) {
    base.command(command);
    base.reset_faults();
    let mut send = |frame: &CanFrame| {
        black_box(encode_slcan(frame));
    };
    base.send_command(&mut send);
    base.poll(
        now,
        &mut |event| {
            black_box(&event);
        },
        &mut send,
    );
}

#[inline(never)]
fn root_canopen(state: &mut Drivers, now: Stamp) {
    let copy = state.bytes;
    let bytes: &[u8] = black_box(&copy);
    black_box(decode_sdo(bytes));
    black_box(state.request.frame(black_box(1)));
    black_box(network_frame(black_box(NetworkCommand::Start), black_box(1)));
    black_box(state.heartbeat.state(now, black_box(100_000)));
}

#[inline(never)]
fn root_xsens(imu: &mut xsens::Device, bytes: &[u8], now: Stamp) {
    imu.take(bytes, now, &mut |event| {
        black_box(&event);
    });
    imu.request(now, &mut |bytes| {
        black_box(bytes);
    });
    black_box(imu.complaint());
}

#[inline(never)]
fn root_velocity_request(state: &mut Drivers, bytes: &[u8], now: Stamp) {
    black_box(state.line.byte(black_box(0)).is_some());
    let arrival = black_box(Arrival { peer: 0, at: now });
    let _ = black_box(state.acceptance.offer(bytes, arrival).is_ok());
    black_box((state.acceptance.requested(now), state.acceptance.holder(now), state.request_out.encode()));
}

#[inline(never)]
fn root_velocity_permit(permit: &Permit, bytes: &[u8]) {
    black_box(permit.encode());
    black_box((Permit::decode(bytes).is_ok(), MotionReport::decode(bytes).is_ok()));
}
