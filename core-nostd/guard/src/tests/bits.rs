//! Every bit of a value, to be flipped one at a time. Values that Rust gives no bits to flip (choices) are replaced by
//! another of their values, as one bit.

use crate::field_selection::FieldSelection;
use crate::motion_checks::MotionChecks;
use crate::protection::{
    CauseRecord, DriveLimits, FaultKind, FieldSet, HeldCause, HeldCauses, ScannerGeometry, SourceRules,
    Thresholds, Travel, Unit,
};
use crate::source_monitor::SourceMonitor;
use crate::state::State;
use crate::*;
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::time::Stamp;

/// Bits that can be flipped.
pub trait Bits {
    /// How many.
    fn bits(&self) -> u32;
    /// Flips one.
    fn flip(&mut self, bit: u32);
}

macro_rules! integers {
    ($($type:ty),*) => { $(impl Bits for $type {
        fn bits(&self) -> u32 { <$type>::BITS }
        fn flip(&mut self, bit: u32) { *self ^= 1 << bit; }
    })* };
}
integers!(u8, u16, u32, u64, usize);

impl Bits for f32 {
    fn bits(&self) -> u32 {
        32
    }
    fn flip(&mut self, bit: u32) {
        *self = Self::from_bits(self.to_bits() ^ (1 << bit));
    }
}

impl Bits for bool {
    fn bits(&self) -> u32 {
        1
    }
    fn flip(&mut self, _: u32) {
        *self = !*self;
    }
}

impl Bits for Stamp {
    fn bits(&self) -> u32 {
        64
    }
    fn flip(&mut self, bit: u32) {
        *self = Self::from_micros(self.as_micros() ^ (1 << bit));
    }
}

/// A choice becomes the other one of two.
macro_rules! choices {
    ($($type:ty: $one:expr, $other:expr;)*) => { $(impl Bits for $type {
        fn bits(&self) -> u32 { 1 }
        fn flip(&mut self, _: u32) { *self = if *self == $one { $other } else { $one }; }
    })* };
}
choices! {
    Cause: Cause::Warning, Cause::ScanProtective;
    Action: Action::Limit, Action::Category2;
    Unit: Unit::Metres, Unit::Seconds;
    Health: Health::Healthy, Health::Stale;
    FaultKind: FaultKind::LinkDown, FaultKind::StandBy;
    Travel: Travel::Straight, Travel::Reverse;
}

/// What stands in the place of nothing when the mark between them flips.
pub trait FlippedValue {
    /// Any value.
    fn flipped_value() -> Self;
}

macro_rules! flipped_values {
    ($($type:ty: $value:expr;)*) => { $(impl FlippedValue for $type {
        fn flipped_value() -> Self { $value }
    })* };
}
flipped_values! {
    Stamp: Stamp::from_micros(1_000);
    FaultKind: FaultKind::LinkDown;
    CauseRecord: CauseRecord::new(Cause::Warning, Stamp::ZERO);
    usize: 0;
    u64: 0;
}

impl<T: Bits + FlippedValue> Bits for Option<T> {
    fn bits(&self) -> u32 {
        1 + self.as_ref().map_or(0, Bits::bits)
    }
    fn flip(&mut self, bit: u32) {
        match self {
            Some(inner) if bit > 0 => inner.flip(bit - 1),
            Some(_) => *self = None,
            None => *self = Some(T::flipped_value()),
        }
    }
}

fn flip_in<'a, T: Bits + 'a>(items: impl Iterator<Item = &'a mut T>, mut bit: u32) {
    for item in items {
        if bit < item.bits() {
            return item.flip(bit);
        }
        bit -= item.bits();
    }
}

impl<T: Bits, const N: usize> Bits for [T; N] {
    fn bits(&self) -> u32 {
        self.iter().map(Bits::bits).sum()
    }
    fn flip(&mut self, bit: u32) {
        flip_in(self.iter_mut(), bit);
    }
}

impl<T: Bits, const N: usize> Bits for heapless::Vec<T, N> {
    fn bits(&self) -> u32 {
        self.iter().map(Bits::bits).sum()
    }
    fn flip(&mut self, bit: u32) {
        flip_in(self.iter_mut(), bit);
    }
}

/// All fields: the pattern without `..` does not compile when one is forgotten.
macro_rules! fields {
    ($($type:ident { $($field:ident),* $(,)? })*) => { $(impl Bits for $type {
        fn bits(&self) -> u32 {
            let $type { $($field),* } = self;
            0 $(+ $field.bits())*
        }
        fn flip(&mut self, bit: u32) {
            let $type { $($field),* } = self;
            let mut left = bit;
            $(if left < $field.bits() {
                return $field.flip(left);
            }
            left -= $field.bits();)*
            panic!("{left} bits too many");
        }
    })* };
}
fields! {
    Point2 { x_m, y_m }
    Pose2 { x_m, y_m, heading_rad }
    Twist2 { linear_mps, angular_radps }
    SourceMonitor { newest, ahead_us, fault, blind, repeats, fingerprint, identical }
    CauseRecord { cause, action, measured, limit, unit, age_us, raised_at, health, ahead_us, speed_limit_mps }
    HeldCause { last_pulse, limit_mps, first }
    HeldCauses { bits, slots }
    DecisionMachine { held, first_stop, reset_since, resets }
    FieldSelection { active, candidate, candidate_clear_since, held_cap_mps, held_until }
    Motion { wheels, gyro_radps, drive, wheels_fastest_mps, drive_fastest_mps }
    Persistence { since }
    Creep { moved_m, turned_rad, measured_at }
    MotionChecks {
        envelope_mps, checked_at, falling, overspeed, speed, turn, steering, is_held, creep_by_wheels, creep_by_drive,
    }
    State {
        monitors, machine, selection, motion, checks, wanted, wanted_fastest_mps, permitted, decided_at, started, scans_with_hit,
        rear_scans_with_hit, packet_returns, silent_cdeg, blocked_forward, blocked_backward,
    }
    SourceRules { fitted, required_at_start, limit_after_us, limit_mps, stop_after_us, frozen_samples }
    DriveLimits { speed_mps, turn_radps, acceleration_mps2, braking_mps2, response_s, wheelbase_m, wheel_lever_m }
    Thresholds {
        scan_adjacent_beams, scan_consecutive, packet_returns, field_activation_us,
        warning_speed_mps, person_speed_mps, person_near_m, memory_reach_m, memory_firings, escape_speed_mps,
        emergency_action, overspeed_us, speed_disagreement_mps, turn_disagreement_radps, disagreement_us,
    }
    UnseenLimits { forward_mps, turning_mps, spinning_mps, reverse_mps, unknown_rear_mps, known_after_m }
    FieldSet { travel, speed_max_mps, protective, warning }
    ScannerGeometry { mounting, first_angle_rad, step_rad, beams, sector_rad }
}
