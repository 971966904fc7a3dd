//! Which cells must still be cleaned, and which may be called clean.
//!
//! A cell is clean if P(dirt > τ) ≤ δ. For a Poisson belief that is one comparison, λ ≤ λ*(τ, δ). Where the belief is
//! a mixture of particles, its own tail must be small as well: the mean alone hides the particles that missed the
//! cell (book, Cleaning: Policy). The guarantee is per cell; `joint` shares δ among all dirty cells.

use floorguard_mapping::threshold_rate;
use floorguard_mapping::{DirtCell, NO_SLOT};
use floorguard_types::number::{nearest_f32, nearest_f32_of_f64, nearest_f64};

/// When a cell counts as clean.
///
/// ```
/// use floorguard_cleaning::{CleanRule, Verdict};
/// use floorguard_mapping::{DirtCell, poisson_tail};
///
/// // Clean: more than five units with a probability of at most 1 %.
/// let rule = CleanRule::per_cell(5, 0.01);
/// let cell = |mean: f32| DirtCell::poisson(mean, poisson_tail(5, f64::from(mean)) as f32);
/// assert_eq!(rule.verdict(&cell(1.785)), Verdict::Clean);
/// assert_eq!(rule.verdict(&cell(1.786)), Verdict::Dirty);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CleanRule {
    threshold_units: f32,
    delta: f32,
    checks_mixture: bool,
}

/// The status of a cell.
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
            threshold_units: nearest_f32_of_f64(threshold_rate(u32::from(tolerated_units), delta)),
            delta: nearest_f32_of_f64(delta),
            checks_mixture: true,
        }
    }

    /// At most `tolerated_units` in all of `dirty_cells` cells at once, with a confidence of 1 − `delta` (union bound).
    #[must_use]
    pub fn joint(tolerated_units: u8, delta: f64, dirty_cells: usize) -> Self {
        Self::per_cell(tolerated_units, delta / nearest_f64(dirty_cells).max(1.0))
    }

    /// The published rule, which uses the mean alone.
    #[must_use]
    pub const fn mean_only(self) -> Self {
        Self { checks_mixture: false, ..self }
    }

    /// λ*, units.
    #[must_use]
    pub const fn threshold_units(&self) -> f32 {
        self.threshold_units
    }

    /// The status of a cell.
    #[inline]
    #[must_use]
    pub fn verdict(&self, cell: &DirtCell) -> Verdict {
        if cell.slot != NO_SLOT {
            Verdict::Active
        } else if cell.expected_units.is_nan() || cell.expected_units > self.threshold_units {
            Verdict::Dirty
        } else if self.checks_mixture && cell.heavy_units > 0 && cell.tail_probability() > self.delta {
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

/// Steps of the limit for a single cell, each [`STEP`] of the one before: from δ down to a millionth of it.
const STEPS: usize = 48;
const STEP: f64 = 0.75;

/// The risk of a mission, shared among its cells by what each still needs.
///
/// The published criterion of success is the 99 % quantile over the cells that were dirty at the start: one cell in a
/// hundred may hold more than τ. With n cells the number that fails is taken as Poisson (its tail is the heavier one),
/// so the mission may expect at most λ*(⌊n/100⌋, risk) failing cells in all. Most cleaned cells need next to nothing of
/// that; the remainder goes to those whose last doubt is expensive to remove, so that no cell is visited again for a
/// risk that the mission can bear. No single cell gets more than δ.
#[derive(Clone, Debug, PartialEq)]
pub struct MissionRisk {
    allowance: f32,
    dirty_cells: f32,
    steps: [CleanRule; STEPS],
}

/// Probabilities that a mission is judged by, 0…1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiskLimits {
    /// That a cell holds more than is tolerated (δ): no cell gets more.
    pub of_a_cell: f64,
    /// That the mission misses its criterion.
    pub of_the_mission: f64,
}

impl MissionRisk {
    /// A mission with `dirty_cells` cells that were not clean at the start.
    #[must_use]
    pub fn new(tolerated_units: u8, limits: RiskLimits, dirty_cells: usize) -> Self {
        let cells = u32::try_from(dirty_cells).unwrap_or(u32::MAX);
        let mut limit = limits.of_a_cell;
        let steps = core::array::from_fn(|_| {
            let rule = CleanRule::per_cell(tolerated_units, limit);
            limit *= STEP;
            rule
        });
        Self {
            allowance: nearest_f32_of_f64(threshold_rate(cells / 100, limits.of_the_mission)),
            dirty_cells: nearest_f32(cells.max(1)),
            steps,
        }
    }

    /// The rule for a single cell at this moment, from what is believed of the `dirty` ones now: the loosest with which
    /// the cells that it calls clean keep to their part of the mission's risk.
    #[must_use]
    pub fn rule<'a>(&self, dirty: impl Iterator<Item = &'a DirtCell>) -> CleanRule {
        // Risk of the cells that a step calls clean and the next one does not.
        let mut risks = [0.0_f32; STEPS];
        let mut decided = 0.0_f32;
        for cell in dirty {
            let clean_at = self.steps.iter().take_while(|rule| rule.verdict(cell) == Verdict::Clean).count();
            let Some(last) = clean_at.checked_sub(1) else { continue };
            decided += 1.0;
            if let (Some(risk), Some(rule)) = (risks.get_mut(last), self.steps.get(last)) {
                // Cells far below the last step are worth nothing.
                *risk += if clean_at < STEPS { rule.delta } else { 0.0 };
            }
        }
        // Cells that are still to be cleaned keep their part.
        let allowance = self.allowance * (decided / self.dirty_cells).min(1.0);
        let mut sum = 0.0_f32;
        let mut loosest = STEPS.saturating_sub(1);
        for (index, risk) in risks.iter().enumerate().rev() {
            sum += *risk;
            if sum > allowance {
                break;
            }
            loosest = index;
        }
        self.steps.get(loosest).copied().unwrap_or(CleanRule {
            threshold_units: 0.0,
            delta: 0.0,
            checks_mixture: true,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_mapping::poisson_tail;

    const LIMITS: RiskLimits = RiskLimits { of_a_cell: 0.01, of_the_mission: 0.01 };

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

    /// 100 cells may expect 0.149 failures: 0.0015 for each alike. Where 90 of them need nothing, the last ten get more.
    #[test]
    fn risk_goes_to_expensive_cells() {
        let risk = MissionRisk::new(5, LIMITS, 100);
        let all = |few: f32, rest: f32| -> std::vec::Vec<DirtCell> {
            (0..100).map(|i| cell(if i < 10 { few } else { rest })).collect()
        };
        let threshold = |cells: &[DirtCell]| risk.rule(cells.iter()).threshold_units();
        let alike = CleanRule::per_cell(5, threshold_rate(1, 0.01) / 100.0).threshold_units();
        let shared = threshold(&all(1.7, 0.1));
        assert!(shared > 1.7 && shared > 1.4 * alike, "{shared} {alike}");
        // All of them at 0.0075 would be 0.75 failures: none of them is clean enough.
        assert!(threshold(&all(1.7, 1.7)) < 1.7);
        // No single cell gets more than δ, and one that may not be clean at all takes nothing from the others.
        assert!(threshold(&all(9.0, 0.1)) <= CleanRule::per_cell(5, 0.01).threshold_units());
        assert!(threshold(&all(9.0, 0.1)) > 1.7);
        assert_eq!(
            MissionRisk::new(5, LIMITS, 0).rule([].iter()).threshold_units(),
            CleanRule::per_cell(5, 0.01).threshold_units()
        );
    }

    /// The sum of what is granted never exceeds the mission's allowance, whatever the beliefs are.
    #[test]
    fn sum_of_risks_stays_within_allowance() {
        let mut random = floorguard_types::random::Pcg32::new(3, 3);
        for count in [25_u32, 120, 400] {
            let risk = MissionRisk::new(5, LIMITS, count as usize);
            let allowance = threshold_rate(count / 100, 0.01) as f32;
            for _ in 0..50 {
                let cells: std::vec::Vec<DirtCell> =
                    (0..count).map(|_| cell(random.uniform_between(0.0, 2.5))).collect();
                let rule = risk.rule(cells.iter());
                let granted: f32 = cells
                    .iter()
                    .filter(|c| rule.verdict(c) == Verdict::Clean)
                    .map(|c| poisson_tail(5, f64::from(c.expected_units)) as f32)
                    .sum();
                assert!(granted <= allowance, "{granted} of {allowance}");
            }
        }
    }

    #[test]
    fn the_joint_rule_is_stricter() {
        let (one, all) = (CleanRule::per_cell(5, 0.01), CleanRule::joint(5, 0.01, 25));
        assert!(all.threshold_units() < one.threshold_units());
        assert!((poisson_tail(5, f64::from(all.threshold_units())) - 0.0004).abs() < 1e-6);
    }
}
