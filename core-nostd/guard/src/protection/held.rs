//! The causes that hold, each with its record: a bit tells whether it holds, so that looking at those few, comparing and
//! copying them costs nothing for the others.

use super::cause::{CAUSES, Cause};
use super::record::CauseRecord;
use floorguard_types::number::{exact_usize, truncating_u32};
use floorguard_types::time::Stamp;

/// A cause that holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldCause {
    /// Newest evidence.
    pub last_pulse: Stamp,
    /// Limit of the newest evidence, m/s.
    pub limit_mps: f32,
    /// As it began; never overwritten while it holds (FG-REQ-004).
    pub first: CauseRecord,
}

/// All causes that hold. What is stored of others has no meaning and takes no part in a comparison.
#[derive(Clone, Copy, Debug)]
pub struct HeldCauses {
    pub(crate) bits: u64,
    pub(crate) slots: [HeldCause; CAUSES],
}

const _: () = assert!(CAUSES <= 64);

impl PartialEq for HeldCauses {
    fn eq(&self, other: &Self) -> bool {
        self.bits == other.bits
            && indices(self.bits).all(|index| self.slots.get(index) == other.slots.get(index))
    }
}

/// Positions of the bits that are set, lowest first.
fn indices(bits: u64) -> impl Iterator<Item = usize> {
    let mut left = bits;
    (0..CAUSES).map_while(move |_| {
        let index = exact_usize(left.trailing_zeros());
        left &= left.wrapping_sub(1);
        (index < CAUSES).then_some(index)
    })
}

impl HeldCauses {
    /// None holds.
    #[must_use]
    pub const fn new() -> Self {
        let first = CauseRecord::new(Cause::StartUp, Stamp::ZERO);
        Self { bits: 0, slots: [HeldCause { last_pulse: Stamp::ZERO, limit_mps: 0.0, first }; CAUSES] }
    }

    /// Evidence for a cause: it holds from now on.
    pub fn pulse(&mut self, record: CauseRecord) {
        let index = record.cause.index();
        let Some(slot) = self.slots.get_mut(index) else { return };
        let bit = 1_u64.wrapping_shl(truncating_u32(index));
        // A slot that a flipped bit took for held must not keep the rules of another cause.
        if self.bits & bit == 0 || slot.first.cause != record.cause {
            slot.first = record;
        }
        self.bits |= bit;
        (slot.last_pulse, slot.limit_mps) = (record.raised_at, record.speed_limit_mps);
    }

    /// A cause holds.
    #[must_use]
    pub fn holds(&self, cause: Cause) -> bool {
        self.bits.wrapping_shr(truncating_u32(cause.index())) & 1 != 0
    }

    /// The causes that hold, in the order of [`Cause::index`].
    pub fn iter(&self) -> impl Iterator<Item = &HeldCause> {
        indices(self.bits).filter_map(|index| self.slots.get(index))
    }

    /// Lets one go.
    pub fn release(&mut self, cause: Cause) {
        self.bits &= !1_u64.wrapping_shl(truncating_u32(cause.index()));
    }

    /// Lets go those that are not to be kept.
    pub fn retain(&mut self, mut keep: impl FnMut(&HeldCause) -> bool) {
        for index in indices(self.bits) {
            if !self.slots.get(index).is_some_and(&mut keep) {
                self.bits &= !1_u64.wrapping_shl(truncating_u32(index));
            }
        }
    }

    /// Becomes equal to another one.
    pub fn follow(&mut self, other: &Self) {
        self.bits = other.bits;
        for index in indices(other.bits) {
            if let (Some(slot), Some(held)) = (self.slots.get_mut(index), other.slots.get(index)) {
                *slot = *held;
            }
        }
    }
}

impl Default for HeldCauses {
    fn default() -> Self {
        Self::new()
    }
}
