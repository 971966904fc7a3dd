//! Every bit of every number in the guard's state, flipped at several moments of a mission, one at a time.
//!
//! Classes: no effect, stop within the same decision, silent unsafe. The last must not occur. Values that have no
//! bits of their own to flip without leaving Rust's rules (flags, choices) are replaced by their other values.

use std::boxed::Box;
use std::vec::Vec;

use super::fixtures::Rig;
use crate::geometry::{Point2, Twist2};
use crate::guard::state::State;
use crate::guard::*;
use crate::sensing::SafetyInput;
use crate::time::Stamp;

type Flip = Box<dyn Fn(&mut State)>;

fn flip_f32(number: &mut f32, bit: u32) {
    *number = f32::from_bits(number.to_bits() ^ (1 << bit));
}

fn flip_stamp(stamp: &mut Stamp, bit: u32) {
    *stamp = Stamp::from_micros(stamp.as_micros() ^ (1 << bit));
}

fn flip_twist(twist: &mut Twist2, bit: u32) {
    flip_f32(if bit < 32 { &mut twist.linear_mps } else { &mut twist.angular_radps }, bit % 32);
}

fn flips() -> Vec<Flip> {
    let mut flips: Vec<Flip> = Vec::new();
    flips.push(Box::new(|state| state.started = !state.started));
    for bit in 0..64_u32 {
        flips.push(Box::new(move |state| flip_twist(&mut state.wanted, bit)));
        flips.push(Box::new(move |state| flip_twist(&mut state.permitted, bit)));
        flips.push(Box::new(move |state| flip_twist(&mut state.motion.wheels, bit)));
        flips.push(Box::new(move |state| flip_stamp(&mut state.decided_at, bit)));
        for source in Source::ALL {
            flips.push(Box::new(move |state| {
                let newest = &mut state.monitors[source.index()].newest;
                newest.iter_mut().for_each(|stamp| flip_stamp(stamp, bit));
            }));
            flips.push(Box::new(move |state| state.monitors[source.index()].ahead_us ^= 1 << bit));
        }
        for cause in Cause::all() {
            flips.push(Box::new(move |state| state.machine.flip_pulse(cause, bit)));
        }
    }
    for bit in 0..32_u32 {
        flips.push(Box::new(move |state| flip_f32(&mut state.motion.gyro_radps, bit)));
        flips.push(Box::new(move |state| flip_f32(&mut state.motion.drive_mps, bit)));
        flips.push(Box::new(move |state| flip_f32(&mut state.motion.steering_rad, bit)));
        flips.push(Box::new(move |state| state.silent_cdeg ^= 1 << bit));
        flips.push(Box::new(move |state| state.selection.active ^= 1 << bit));
    }
    for bit in 0..8_u32 {
        flips.push(Box::new(move |state| state.scans_with_hit ^= 1 << bit));
        flips.push(Box::new(move |state| state.packet_returns ^= 1 << bit));
    }
    for source in Source::ALL {
        flips.push(Box::new(move |state| {
            let monitor = &mut state.monitors[source.index()];
            monitor.blind = !monitor.blind;
        }));
        flips.push(Box::new(move |state| {
            let fault = &mut state.monitors[source.index()].fault;
            *fault = if fault.is_some() { None } else { Some(FaultKind::LinkDown) };
        }));
    }
    for cause in Cause::all() {
        flips.push(Box::new(move |state| state.machine.flip_held(cause)));
    }
    flips
}

/// Moments of a mission: starting, cruising, slowed, stopped by an obstacle, latched.
fn moments() -> Vec<Supervisor> {
    let mut moments = Vec::new();
    for offset_ms in [0, 10, 20, 30] {
        let mut starting = Rig::new();
        starting.run_ms(200 + offset_ms);
        let mut rig = Rig::cruising();
        rig.run_ms(10 + offset_ms);
        let cruising = rig.guard.clone();
        rig.obstacles.push(Point2::new(3.0, 0.0));
        rig.run_ms(500 + offset_ms);
        let slowed = rig.guard.clone();
        rig.obstacles = std::vec![Point2::new(1.1, 0.0)];
        rig.run_ms(500 + offset_ms);
        let stopped = rig.guard.clone();
        rig.inputs.emergency_stop = SafetyInput::Active;
        rig.run_ms(500);
        rig.inputs.emergency_stop = SafetyInput::Clear;
        rig.run_ms(2_000 + offset_ms);
        moments.extend([starting.guard, cruising, slowed, stopped, rig.guard]);
    }
    moments
}

#[test]
fn fg_req_008_no_flipped_bit_of_the_state_is_silently_unsafe() {
    let (mut no_effect, mut stops) = (0_u32, 0_u32);
    let flips = flips();
    for mut guard in moments() {
        // Only the state and its copy change: the tables need not be cloned for each flip.
        let (state, copy) = (guard.state, guard.copy);
        let now = state.decided_at.plus_micros(10_000);
        let expected = guard.tick(now);
        for (flip, in_copy) in flips.iter().flat_map(|flip| [(flip, false), (flip, true)]) {
            (guard.state, guard.copy) = (state, copy);
            flip(if in_copy { &mut guard.copy } else { &mut guard.state });
            let decision = guard.tick(now);
            if decision == expected {
                no_effect += 1;
            } else {
                let stands = decision.permitted == Twist2::ZERO && decision.action == Action::Category0;
                assert!(stands, "silent unsafe: {decision:?} instead of {expected:?}");
                stops += 1;
            }
        }
    }
    assert!(stops > 50_000, "{no_effect} without effect, {stops} stops");
    std::println!("{no_effect} without effect, {stops} stops within the decision, 0 silent unsafe");
}
