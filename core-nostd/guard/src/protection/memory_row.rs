//! A row of cells of the memory: which are kept, the heights in which the lidar met something, and the sum of it all.

use super::local_memory::SIDE;
use floorguard_types::number::{count_u32, exact_usize, saturating_u8};

/// A step of the heights that are kept, metres: 255 of them reach to 1.53 m.
const HEIGHT_STEP_M: f32 = 0.006;

/// A step of height: 1…255.
#[must_use]
pub fn height_step(height_m: f32) -> u8 {
    saturating_u8(height_m * (1.0 / HEIGHT_STEP_M)).saturating_add(1)
}

/// The height at which a step ends, metres.
#[must_use]
pub fn height_of_step_m(step: u8) -> f32 {
    f32::from(step) * HEIGHT_STEP_M
}

/// Heights that belong together: lowest and highest, in steps; 0: nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Run {
    low: u8,
    top: u8,
}

impl Run {
    const fn is_empty(self) -> bool {
        self.top == 0
    }

    /// Takes in a height: what lies within `gap` of the run belongs to it, of two runs the lower one stays.
    const fn with(self, step: u8, gap: u8) -> Self {
        let alone = Self { low: step, top: step };
        if self.is_empty() {
            return alone;
        }
        let joins = step >= self.low.saturating_sub(gap) && step <= self.top.saturating_add(gap);
        if !joins {
            return if step < self.low { alone } else { self };
        }
        let low = if step < self.low { step } else { self.low };
        let top = if step > self.top { step } else { self.top };
        Self { low, top }
    }

    /// A single height, but for what a range is uncertain.
    pub(super) const fn is_thin(self) -> bool {
        self.top.saturating_sub(self.low) < 2
    }

    /// Its highest return is lower, metres.
    pub(crate) fn ends_below_m(self, height_m: f32) -> bool {
        self.top <= height_step(height_m)
    }

    /// The same for a height in metres.
    pub(crate) fn is_refuted_at_m(self, height_m: f32) -> bool {
        self.is_refuted_at(height_step(height_m))
    }

    const fn word(self, index: usize) -> u32 {
        u32::from_le_bytes([self.low, self.top, 0, 0]).rotate_left(count_u32(index) % 32)
    }

    /// A ray at this height goes through the run: between its ends, or through one that has no between.
    const fn is_refuted_at(self, step: u8) -> bool {
        if self.is_empty() {
            return false;
        }
        // A step beside a thin one: while the robot moves, no ray comes back to exactly the same height.
        let is_at_it = step >= self.low.saturating_sub(1) && step <= self.top.saturating_add(1);
        (step > self.low && step < self.top) || (self.is_thin() && is_at_it)
    }
}

/// A row of cells, with the sum of all its words.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub(crate) by_lidar: u64,
    pub(crate) by_scanner: u64,
    /// What the lidar met in this span of [`AGREE_US`], in the one before, and in either of the two before: what it meets in
    /// this one and in either of those is kept.
    pub(crate) lately: [u64; 3],
    /// Cells that the first or the last beam of a scanner has passed through.
    pub(crate) passed: u64,
    /// Cells whose floor, or what lies low above it, the lowest ring of the lidar has seen.
    pub(crate) floor: u64,
    pub(crate) runs: [Run; SIDE],
    sum: u32,
}

impl Row {
    /// Nothing but zeros, which take no space in a program.
    pub(super) const EMPTY: Self = Self {
        by_lidar: 0,
        by_scanner: 0,
        lately: [0; 3],
        passed: 0,
        floor: 0,
        runs: [Run { low: 0, top: 0 }; SIDE],
        sum: 0,
    };

    /// Nothing is there, and it was looked through. The sum of a full word is nothing.
    pub(super) const LOOKED_AT: Self = Self { passed: u64::MAX, floor: u64::MAX, ..Self::EMPTY };

    pub(super) fn run(&self, index: usize) -> Run {
        self.runs.get(index).copied().unwrap_or_default()
    }

    /// Cells that are kept, of both sensors.
    pub(super) const fn kept(&self) -> u64 {
        self.by_lidar | self.by_scanner
    }

    /// Its floor was seen, or something was met in it.
    pub(super) const fn is_known(&self, index: usize) -> bool {
        has_bit(self.floor | self.kept(), index)
    }

    /// The highest step at which the lidar met something here, if it alone did.
    pub(super) fn top_by_lidar(&self, index: usize) -> Option<u8> {
        has_bit(self.by_lidar & !self.by_scanner, index).then(|| self.run(index).top)
    }

    /// The highest step at which the lidar met something here, kept or not yet, if it alone did.
    pub(super) fn top_met(&self, index: usize) -> Option<u8> {
        (self.holds(index) && !has_bit(self.by_scanner, index)).then(|| self.run(index).top)
    }

    /// Of these cells, those in which the lidar met a single height.
    pub(super) fn thin_of(&self, cells: u64) -> u64 {
        let (mut thin, mut left) = (0, cells);
        for _ in 0..SIDE {
            if left == 0 {
                break;
            }
            let index = exact_usize(left.trailing_zeros());
            left &= left.wrapping_sub(1);
            if self.run(index).is_thin() {
                set_bit(&mut thin, index, true);
            }
        }
        thin
    }

    /// Heights in which the lidar met something lately, or at any time if it is kept.
    pub(super) const fn holds(&self, index: usize) -> bool {
        let [now, _, before] = self.lately;
        has_bit(self.by_lidar | now | before, index)
    }

    /// The lidar met something in this span or in either of the two before.
    pub(super) const fn is_met(&self, index: usize) -> bool {
        let [now, _, before] = self.lately;
        has_bit(now | before, index)
    }

    /// The lidar met something in this span or in the one before.
    pub(super) const fn is_fresh(&self, index: usize) -> bool {
        let [now, last, _] = self.lately;
        has_bit(now | last, index)
    }

    pub(super) fn meet(&mut self, index: usize, (step, gap): (u8, u8)) {
        let run = if self.holds(index) { self.run(index) } else { Run::default() };
        let grown = run.with(step, gap);
        let [now, ..] = self.lately;
        // Most returns repeat what this span holds already.
        if grown == run && has_bit(now, index) {
            return;
        }
        self.set_run(index, grown);
        let [now, _, before] = &mut self.lately;
        if has_bit(*before, index) {
            self.sum ^= folded(set_bit(&mut self.by_lidar, index, true));
        }
        self.sum ^= folded(set_bit(now, index, true)).rotate_left(13);
    }

    fn set_run(&mut self, index: usize, new: Run) {
        let Some(slot) = self.runs.get_mut(index) else { return };
        self.sum ^= slot.word(index) ^ new.word(index);
        *slot = new;
    }

    pub(super) fn set_scanned(&mut self, index: usize, on: bool) {
        // Bits of both kinds at the same place would cancel each other out in the sum.
        self.sum ^= folded(set_bit(&mut self.by_scanner, index, on)).rotate_left(7);
    }

    /// A beam has passed through a cell.
    pub(super) fn set_passed(&mut self, index: usize) {
        if !has_bit(self.passed, index) {
            self.sum ^= folded(set_bit(&mut self.passed, index, true)).rotate_left(3);
        }
    }

    /// The floor of a cell was seen.
    pub(super) fn set_floor(&mut self, index: usize) {
        if !has_bit(self.floor, index) {
            self.sum ^= folded(set_bit(&mut self.floor, index, true)).rotate_left(29);
        }
    }

    /// A new span of time begins.
    pub(super) fn begin_span(&mut self) {
        let [now, last, _] = self.lately;
        let begun = [0, now, now | last];
        self.sum ^= sum_of_spans(self.lately) ^ sum_of_spans(begun);
        self.lately = begun;
    }

    pub(super) fn clear_lidar(&mut self, index: usize) {
        self.set_run(index, Run::default());
        let others = !1_u64.wrapping_shl(count_u32(index));
        let cleared = self.lately.map(|span| span & others);
        self.sum ^= folded(self.by_lidar & !others) ^ sum_of_spans(self.lately) ^ sum_of_spans(cleared);
        self.by_lidar &= others;
        self.lately = cleared;
    }

    /// Nothing is there; `passed`: a look has been through it.
    pub(super) fn clear(&mut self, index: usize, passed: bool) {
        self.clear_lidar(index);
        self.set_scanned(index, false);
        self.sum ^= folded(set_bit(&mut self.passed, index, passed)).rotate_left(3);
        self.sum ^= folded(set_bit(&mut self.floor, index, passed)).rotate_left(29);
    }

    pub(super) fn is_whole(&self) -> bool {
        let runs = self.runs.iter().enumerate().fold(0, |sum, (index, run)| sum ^ run.word(index));
        let lately = sum_of_spans(self.lately);
        let scanned = folded(self.by_scanner).rotate_left(7) ^ folded(self.passed).rotate_left(3);
        let lidar = folded(self.by_lidar) ^ folded(self.floor).rotate_left(29);
        runs ^ lidar ^ scanned ^ lately == self.sum
    }
}

const fn has_bit(word: u64, index: usize) -> bool {
    word.wrapping_shr(count_u32(index)) & 1 != 0
}

const fn sum_of_spans([now, last, before]: [u64; 3]) -> u32 {
    folded(now).rotate_left(13) ^ folded(last).rotate_left(25) ^ folded(before).rotate_left(19)
}

/// Both halves of a word in one.
const fn folded(word: u64) -> u32 {
    let [a, b, c, d, e, f, g, h] = word.to_le_bytes();
    u32::from_le_bytes([a, b, c, d]) ^ u32::from_le_bytes([e, f, g, h]).rotate_left(3)
}

/// Sets or clears a bit; gives the bits of the word that changed.
const fn set_bit(word: &mut u64, index: usize, on: bool) -> u64 {
    let bit = 1_u64.wrapping_shl(count_u32(index));
    let before = *word;
    *word = if on { before | bit } else { before & !bit };
    before ^ *word
}
