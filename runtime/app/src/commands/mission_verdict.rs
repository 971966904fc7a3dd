//! What a campaign of missions comes to: good, or why not.

use floorguard_laboratory::mission::{Strategy, StrategySummary};

use super::VerdictFailed;

/// Whatever the strategy, claims that are false beyond doubt are a negative verdict, and so is a robot that ends
/// elsewhere than it believes: what it claims from there is worth nothing. One that drives at random claims nothing of
/// a place.
pub(super) fn verdict(summaries: &[StrategySummary], delta: f64) -> anyhow::Result<()> {
    for s in summaries.iter().filter(|s| s.strategy != Strategy::Random.name()) {
        if s.ended_astray > 0 {
            return Err(VerdictFailed(format!(
                "{}: {} of {} missions ended off their place, up to {:.1} m: {} of {} claimed cells are not clean",
                s.strategy, s.ended_astray, s.trials, s.farthest_astray_m, s.falsely_claimed_cells, s.claimed_cells
            ))
            .into());
        }
        if s.falsely_claimed_interval95.0 > delta {
            return Err(VerdictFailed(format!(
                "{}: {} of {} claimed cells are not clean: {:.2} % where {:.2} % are allowed",
                s.strategy,
                s.falsely_claimed_cells,
                s.claimed_cells,
                100.0 * s.falsely_claimed_share,
                100.0 * delta
            ))
            .into());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_laboratory::mission::{StrategyTrials, TrialResult};

    /// Ten missions, one of which ended so far off its place and claimed so many cells that are dirty.
    fn verdict_of(strategy: Strategy, (off_m, false_claims): (f32, u32)) -> Result<(), String> {
        let good = TrialResult { claimed_cells: 253, errors: vec![(900.0, 0.03)], ..TrialResult::default() };
        let mut trials = vec![good; 10];
        trials[4].errors.push((901.0, off_m));
        trials[4].falsely_claimed_cells = false_claims;
        let summary = StrategyTrials { strategy, trials }.summary();
        verdict(&[summary], 0.01).map_err(|error| error.to_string())
    }

    /// A mission in lanes that lost its place, and its claims with it.
    #[test]
    fn lost_pose_and_false_claims_are_negative() {
        for strategy in [Strategy::Systematic, Strategy::Guarantee, Strategy::NoReplanning] {
            assert_eq!(verdict_of(strategy, (0.04, 0)), Ok(()));
            let lost = verdict_of(strategy, (11.5, 117)).unwrap_err();
            for words in ["1 of 10 missions", "11.5 m", "117 of 2530"] {
                assert!(lost.contains(words), "{lost}");
            }
            let false_claims = verdict_of(strategy, (0.04, 117)).unwrap_err();
            assert!(false_claims.contains("4.62 % where 1.00 % are allowed"), "{false_claims}");
            assert_eq!(verdict_of(strategy, (0.04, 20)), Ok(()), "within chance of what is allowed");
        }
        assert_eq!(verdict_of(Strategy::Random, (11.5, 0)), Ok(()));
    }
}
