//! What was latched, in memory that outlives a reset of the computer (FG-REQ-070).

use core::sync::atomic::{AtomicU32, Ordering};

use floorguard_guard::Cause;

/// "FGLT".
const MAGIC: u32 = 0x544c_4746;

/// Latched without a memory of why: an operator must look. The cause is that of safety inputs that were not read, since a
/// button that was pressed meanwhile was not heard.
#[must_use]
pub fn unknown_latches() -> u64 {
    1_u64.wrapping_shl(Cause::InputUnknown.index() as u32)
}

/// The latched causes, twice. Place it where neither start-up code nor loader writes; any bits are a valid value.
pub struct KeptLatches {
    magic: AtomicU32,
    words: [AtomicU32; 2],
    /// The words, inverted.
    check: [AtomicU32; 2],
}

impl KeptLatches {
    /// What was latched before the reset. Memory that was without power remembers nothing; memory in which the two copies
    /// differ is [`unknown_latches`]. Call once, before anything is kept.
    pub fn begin(&self) -> u64 {
        let [low, high] = self.words.each_ref().map(|word| word.load(Ordering::Relaxed));
        let [low_check, high_check] = self.check.each_ref().map(|word| word.load(Ordering::Relaxed));
        let latches =
            match (self.magic.load(Ordering::Relaxed) == MAGIC, [low_check, high_check] == [!low, !high]) {
                (false, _) => 0,
                (true, true) => u64::from(low) | (u64::from(high) << 32),
                (true, false) => unknown_latches(),
            };
        self.keep(latches);
        self.magic.store(MAGIC, Ordering::Relaxed);
        latches
    }

    /// Remembers. A reset between two words leaves copies that differ.
    pub fn keep(&self, latches: u64) {
        let words = [latches as u32, (latches >> 32) as u32];
        for ((slot, check), word) in self.words.iter().zip(&self.check).zip(words) {
            slot.store(word, Ordering::Relaxed);
            check.store(!word, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn memory(fill: u32) -> KeptLatches {
        let word = || AtomicU32::new(fill);
        KeptLatches { magic: word(), words: [word(), word()], check: [word(), word()] }
    }

    #[test]
    fn fg_req_070_kept_state_survives_reset_not_power() {
        for fill in [0, u32::MAX, 0xA5A5_5A5A] {
            let kept = memory(fill);
            assert_eq!(kept.begin(), 0, "memory that was without power");
            for latches in [1, 0x8000_0000_0000_0001, 0, u64::MAX] {
                kept.keep(latches);
                assert_eq!((kept.begin(), kept.begin()), (latches, latches));
            }
        }
    }

    #[test]
    fn fg_req_070_any_flipped_bit_asks_for_the_operator() {
        let kept = memory(0);
        for bit in 0..64_u32 {
            kept.begin();
            kept.keep(0b1000);
            let words = if bit < 32 { &kept.words } else { &kept.check };
            let slot = &words[(bit % 2) as usize];
            slot.store(slot.load(Ordering::Relaxed) ^ (1 << (bit % 32)), Ordering::Relaxed);
            assert_eq!(kept.begin(), unknown_latches(), "bit {bit}");
        }
    }
}
