//! Which cells must still be cleaned, and which may be called clean.
//!
//! A cell is clean if P(dirt > τ) ≤ δ. For a Poisson belief that is one comparison, λ ≤ λ*(τ, δ). Where the belief is
//! a mixture of particles, its own tail must be small as well: the mean alone hides the particles that missed the
//! cell (algorithms I.6, I.7). The guarantee is per cell; `joint` shares δ among all dirty cells (AMB-34).

use super::poisson::threshold_rate;
use crate::maps::{DirtCell, NO_SLOT};

/// When a cell counts as clean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CleanRule {
    threshold_units: f32,
    delta: f32,
    looks_at_mixture: bool,
}

/// What may be said about a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The belief says so with the confidence asked.
    Clean,
    /// More dirt is expected than allowed.
    Dirty,
    /// Little dirt is expected, but too many of the possible paths missed the cell.
    Uncertain,
    /// The brush is there: not decided yet, and never claimed.
    Active,
}

impl CleanRule {
    /// At most `tolerated_units` with a confidence of 1 − `delta` for every cell.
    #[must_use]
    pub fn per_cell(tolerated_units: u8, delta: f64) -> Self {
        Self {
            threshold_units: threshold_rate(u32::from(tolerated_units), delta) as f32,
            delta: delta as f32,
            looks_at_mixture: true,
        }
    }

    /// At most `tolerated_units` in all of `dirty_cells` cells at once, with a confidence of 1 − `delta` (union bound).
    #[must_use]
    pub fn joint(tolerated_units: u8, delta: f64, dirty_cells: usize) -> Self {
        Self::per_cell(tolerated_units, delta / (dirty_cells as f64).max(1.0))
    }

    /// As much of δ for every cell as lets all but one cell in a hundred of `dirty_cells` hold at most
    /// `tolerated_units` with a confidence of 1 − `delta`: the published criterion of success, the 99 % quantile over
    /// the dirty cells. The number of cells that fail is taken as Poisson, whose tail is the heavier one.
    #[must_use]
    pub fn mission(tolerated_units: u8, delta: f64, dirty_cells: usize) -> Self {
        let cells = u32::try_from(dirty_cells).unwrap_or(u32::MAX);
        let share = threshold_rate(cells / 100, delta) / f64::from(cells).max(1.0);
        Self::per_cell(tolerated_units, share.min(delta))
    }

    /// The published rule, which looks at the mean alone.
    #[must_use]
    pub const fn mean_only(self) -> Self {
        Self { looks_at_mixture: false, ..self }
    }

    /// λ*, units.
    #[must_use]
    pub const fn threshold_units(&self) -> f32 {
        self.threshold_units
    }

    /// What may be said about a cell.
    #[inline]
    #[must_use]
    pub fn verdict(&self, cell: &DirtCell) -> Verdict {
        if cell.slot != NO_SLOT {
            Verdict::Active
        } else if cell.expected_units.is_nan() || cell.expected_units > self.threshold_units {
            Verdict::Dirty
        } else if self.looks_at_mixture && cell.heavy_units > 0 && cell.tail_probability() > self.delta {
            Verdict::Uncertain
        } else {
            Verdict::Clean
        }
    }

    /// The cell belongs to the policy: it must be visited.
    #[inline]
    #[must_use]
    pub fn needs_cleaning(&self, cell: &DirtCell) -> bool {
        matches!(self.verdict(cell), Verdict::Dirty | Verdict::Uncertain)
    }
}

#[cfg(test)]
mod tests {
    use super::super::poisson::poisson_tail;
    use super::*;

    fn cell(rate: f32) -> DirtCell {
        DirtCell::poisson(rate, poisson_tail(5, f64::from(rate)) as f32)
    }

    #[test]
    fn the_threshold_decides() {
        let rule = CleanRule::per_cell(5, 0.01);
        assert_eq!(rule.verdict(&cell(1.785)), Verdict::Clean);
        assert_eq!(rule.verdict(&cell(1.786)), Verdict::Dirty);
        assert_eq!(rule.verdict(&DirtCell { slot: 3, ..cell(0.1) }), Verdict::Active);
        let nan = DirtCell { expected_units: f32::NAN, ..DirtCell::CLEAN };
        assert_eq!(rule.verdict(&nan), Verdict::Dirty);
    }

    /// 95 % of the particles say 0, 5 % say 20: a mean of 1 passes, the mixture does not.
    #[test]
    fn a_mixture_does_not_hide_behind_its_mean() {
        let rule = CleanRule::per_cell(5, 0.01);
        let mixed = DirtCell {
            expected_units: 1.0,
            tail: DirtCell::encode_tail(0.05),
            heavy_units: 20,
            slot: NO_SLOT,
        };
        assert_eq!(rule.verdict(&mixed), Verdict::Uncertain);
        assert_eq!(rule.mean_only().verdict(&mixed), Verdict::Clean);
    }

    /// Few cells: none may fail, as in the joint rule. Many: one in a hundred may, and nearly all of δ is left for each.
    #[test]
    fn the_rule_of_a_mission_lies_between() {
        let threshold = |dirty_cells| CleanRule::mission(5, 0.01, dirty_cells).threshold_units();
        let joint = |dirty_cells| CleanRule::joint(5, 0.01, dirty_cells).threshold_units();
        assert!((threshold(25) - joint(25)).abs() < 1e-3);
        assert!(threshold(200) > joint(200) && threshold(2_000) > threshold(200));
        let one = CleanRule::per_cell(5, 0.01).threshold_units();
        assert!(threshold(60_000) < one && threshold(60_000) > 0.9 * one);
        assert_eq!(threshold(0), one);
    }

    #[test]
    fn the_joint_rule_is_stricter() {
        let (one, all) = (CleanRule::per_cell(5, 0.01), CleanRule::joint(5, 0.01, 25));
        assert!(all.threshold_units() < one.threshold_units());
        assert!((poisson_tail(5, f64::from(all.threshold_units())) - 0.0004).abs() < 1e-6);
    }
}
