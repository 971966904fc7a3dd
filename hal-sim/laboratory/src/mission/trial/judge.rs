//! What the robot claims at the end, against the truth.

use floorguard_cleaning::Verdict;

use super::Mission;
use crate::mission::config::Strategy;
use crate::mission::navigator::VISITS_MAX;
use crate::mission::outcome::TrialResult;

impl Mission<'_> {
    /// Compares the claims with the truth.
    pub(super) fn judge(mut self, dirty: &[bool]) -> TrialResult {
        self.localiser.settle();
        let rule = self.promise.rule(&self.localiser.map);
        let mut result = self.result;
        let tolerated = u32::from(self.config.tolerated_units);
        let (mut left_dirty, mut left_all) = (Vec::new(), Vec::new());
        for (cell, &was_dirty) in dirty.iter().enumerate() {
            let left = self.truth.units(cell);
            result.left.push(left);
            if !self.floor.reachable[cell] {
                result.unreachable_cells += u32::from(was_dirty);
                result.verdicts.push(None);
                continue;
            }
            let verdict = self.localiser.map.get(cell).map(|dirt| rule.verdict(dirt));
            result.verdicts.push(verdict);
            let (claimed, clean) = (verdict == Some(Verdict::Clean), left <= tolerated);
            left_all.push(left);
            result.claimed_all_cells += u32::from(claimed);
            result.uncertain_cells += u32::from(verdict == Some(Verdict::Uncertain));
            result.given_up_cells += u32::from(!claimed && self.navigator.visits()[cell] >= VISITS_MAX);
            if was_dirty {
                left_dirty.push(left);
                result.dirty_cells += 1;
                result.claimed_cells += u32::from(claimed);
                result.falsely_claimed_cells += u32::from(claimed && !clean);
                result.truly_clean_cells += u32::from(clean);
                result.truly_clean_claimed_cells += u32::from(clean && claimed);
            }
        }
        let passed = self.truth.passed.iter().zip(&self.floor.reachable).filter(|&(&p, &r)| p && r).count();
        result.covered_share = passed as f32 / left_all.len().max(1) as f32;
        // Cells that were given up are no reason to call the floor complete.
        result.is_complete &= result.claimed_all_cells as usize == left_all.len();
        result.quantile99 = quantile99(&mut left_dirty);
        result.quantile99_all = quantile99(&mut left_all);
        result.max_left = left_all.last().copied().unwrap_or(0);
        result.success = result.quantile99 <= tolerated;
        result.is_complete &= self.config.strategy == Strategy::Guarantee;
        result.distance_m = self.truth.distance_m;
        result.time_s = self.truth.time_s;
        result.replannings = self.navigator.replannings;
        let updates = result.errors.len().max(1);
        result.mean_error_m = result.errors.iter().map(|e| e.1).sum::<f32>() / updates as f32;
        result.distrusts = self.localiser.distrusts;
        result.visits = self.navigator.visits().iter().map(|&visits| u32::from(visits)).sum();
        result.faults = self.faults.count;
        result.avoidable_contacts = self.crowd.avoidable_contacts;
        result.update_s = self.localiser.busy_s / f64::from(self.localiser.updates.max(1));
        result.planning_s = (self.navigator.first_plan_s, self.navigator.slowest_replan_s);
        result
    }
}

/// The smallest value that at least 99 % of the values do not exceed; sorts them.
fn quantile99(values: &mut [u32]) -> u32 {
    values.sort_unstable();
    let rank = (0.99 * values.len() as f64).ceil() as usize;
    values.get(rank.saturating_sub(1)).copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantile_is_the_maximum_of_few_values() {
        assert_eq!(quantile99(&mut [3, 9, 1]), 9);
        let mut many: Vec<u32> = (1..=200).collect();
        assert_eq!(quantile99(&mut many), 198);
        assert_eq!(quantile99(&mut []), 0);
    }
}
