//! Limits by direction where no sensor sees all of what the body goes into, and turns beside a rear that nobody has looked at.

use super::fixtures::{Rig, config, forward};
use crate::*;
use floorguard_types::geometry::Twist2;

const SPIN: Twist2 = Twist2 { linear_mps: 0.0, angular_radps: 0.5 };
const LIMITS: UnseenLimits = UnseenLimits {
    forward_mps: 0.9,
    turning_mps: 0.5,
    spinning_mps: 0.35,
    reverse_mps: 0.1,
    unknown_rear_mps: 0.15,
    known_after_m: 1.0,
};

fn rig(unseen: UnseenLimits) -> Rig {
    let mut rig = Rig::with(GuardConfig { unseen, ..config() });
    rig.wanted = Twist2::ZERO;
    rig.run_ms(3_000);
    rig
}

fn fastest(twist: Twist2) -> f32 {
    fastest_mps(&config().footprint, twist)
}

/// Milliseconds of driving straight, forward or back, then the speed of the fastest point in a spin.
fn spin_after(rig: &mut Rig, mps: f32, ms: u64) -> f32 {
    rig.wanted = forward(mps);
    rig.run_ms(ms);
    rig.wanted = Twist2::ZERO;
    rig.run_ms(2_000);
    rig.wanted = SPIN;
    fastest(rig.run_ms(2_000).permitted)
}

#[test]
fn fg_req_063_each_direction_has_its_limit() {
    let known = UnseenLimits { known_after_m: 0.0, ..LIMITS };
    let motions = [
        (forward(1.0), 0.9),
        (Twist2 { linear_mps: 1.0, angular_radps: 0.29 }, 0.9),
        (Twist2 { linear_mps: 1.0, angular_radps: -0.31 }, 0.5),
        (Twist2 { linear_mps: 0.04, angular_radps: 0.6 }, 0.35),
        (Twist2 { linear_mps: -0.2, angular_radps: 0.3 }, 0.1),
        (forward(-0.2), 0.1),
        (forward(0.8), 0.8),
        (Twist2::ZERO, 0.0),
    ];
    for (wanted, expected_mps) in motions {
        let limited = known.limited(wanted, (&config().footprint, &SeenBeside::NOTHING));
        assert!((fastest(limited) - expected_mps).abs() < 1.0e-4, "{wanted:?}: {limited:?}");
        let cross = limited.linear_mps * wanted.angular_radps - limited.angular_radps * wanted.linear_mps;
        assert!(cross.abs() < 1.0e-6, "the curve of {wanted:?} changed");
        let free = UnseenLimits::NONE.limited(wanted, (&config().footprint, &SeenBeside::NOTHING));
        assert_eq!(free, wanted);
    }
}

#[test]
fn fg_req_063_guard_permits_no_more_than_its_direction() {
    let mut limited = rig(UnseenLimits { forward_mps: 0.4, known_after_m: 0.0, ..LIMITS });
    limited.wanted = forward(0.8);
    assert!((limited.run_ms(3_000).permitted.linear_mps - 0.4).abs() < 1.0e-3);
    let mut free = rig(UnseenLimits::NONE);
    free.wanted = forward(0.8);
    assert!(free.run_ms(3_000).permitted.linear_mps > 0.75);
}

#[test]
fn fg_req_064_turn_is_slow_until_rear_is_known() {
    let mut rig = rig(LIMITS);
    assert!((spin_after(&mut rig, 0.0, 10) - 0.15).abs() < 1.0e-3, "switched on");
    assert!((spin_after(&mut rig, 0.5, 1_500) - 0.15).abs() < 1.0e-3, "half a metre is too little");
    assert!((spin_after(&mut rig, 0.5, 3_000) - 0.35).abs() < 1.0e-3, "it has looked there");
    assert!((spin_after(&mut rig, -0.1, 2_000) - 0.35).abs() < 1.0e-3, "a little way back");
    assert!((spin_after(&mut rig, -0.1, 3_000) - 0.15).abs() < 1.0e-3, "too far back");
    assert!((spin_after(&mut rig, 0.5, 4_000) - 0.35).abs() < 1.0e-3, "ahead again");
    rig.wanted = Twist2::ZERO;
    rig.run_ms(31_000);
    assert!((spin_after(&mut rig, 0.0, 10) - 0.15).abs() < 1.0e-3, "somebody may have come");
}

#[test]
fn fg_req_064_flipped_bit_makes_the_rear_unknown() {
    let mut rig = rig(LIMITS);
    spin_after(&mut rig, 0.5, 4_000);
    for bit in 0..32 {
        let mut seen = rig.guard.seen;
        let limit = |seen: &SeenBeside| fastest(LIMITS.limited(SPIN, (&config().footprint, seen)));
        assert!((limit(&seen) - 0.35).abs() < 1.0e-3);
        seen.ahead_m = f32::from_bits(seen.ahead_m.to_bits() ^ (1 << bit));
        assert!((limit(&seen) - 0.15).abs() < 1.0e-3, "bit {bit}");
    }
}

#[test]
fn fg_req_060_limits_by_direction_are_positive() {
    let with = |unseen: UnseenLimits| GuardConfig { unseen, ..config() }.validate().is_ok();
    assert!(with(LIMITS) && with(UnseenLimits::NONE));
    for wrong in [0.0, -0.1, f32::NAN, f32::INFINITY] {
        assert!(!with(UnseenLimits { forward_mps: wrong, ..LIMITS }), "{wrong}");
        assert!(!with(UnseenLimits { unknown_rear_mps: wrong, ..LIMITS }), "{wrong}");
        assert!(wrong == 0.0 || !with(UnseenLimits { known_after_m: wrong, ..LIMITS }), "{wrong}");
    }
}
