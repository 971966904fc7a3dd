//! A committee of single comparisons (AdaBoost on decision stumps). Source: book, Legs: Committees.

use super::cues::LegCues;
use super::features::LegFeatures;
use super::leg_table::{NEAR_FLOOR, WITH_MAP, WITH_MAP_AND_PLACES, WITH_PLACES, WITHOUT_MAP};

/// One comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stump {
    /// Index of its feature.
    pub feature: u8,
    /// What it compares it with.
    pub threshold: f32,
    /// Its vote where the number is above the threshold; the opposite where it is not.
    pub vote: f32,
}

/// Sum of the votes.
#[must_use]
pub fn score(stumps: &[Stump], features: &[f32]) -> f32 {
    let vote = |stump: &Stump| {
        let value = features.get(usize::from(stump.feature)).copied().unwrap_or(0.0);
        if value > stump.threshold { stump.vote } else { -stump.vote }
    };
    stumps.iter().map(vote).sum()
}

/// What is known of the places of a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnownPlaces {
    /// A map explains furniture, which is not asked about.
    pub map: bool,
    /// Earlier scans showed what stood at the place and what was seen through.
    pub before: bool,
}

/// Sum of the votes of this build's committee for what is known; above 0 it is a leg. The probability is the logistic of
/// twice the sum (Friedman et al. 2000).
#[must_use]
pub fn leg_score(cues: &LegCues, known: KnownPlaces) -> f32 {
    let committee: &[Stump] = match (known.map, known.before) {
        (true, true) => &WITH_MAP_AND_PLACES,
        (true, false) => &WITH_MAP,
        (false, true) => &WITH_PLACES,
        (false, false) => &WITHOUT_MAP,
    };
    score(committee, cues)
}

/// The same for a coarse scanner near the floor, where two legs are often one segment, and without a map.
#[must_use]
pub fn leg_score_near_floor(features: &LegFeatures) -> f32 {
    score(&NEAR_FLOOR, features)
}

/// The committee of [`leg_score_near_floor`], so that a table with other committees can be written around it.
#[must_use]
pub fn near_floor_committee() -> &'static [Stump] {
    &NEAR_FLOOR
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn votes_are_added_with_their_sign() {
        let stumps = [
            Stump { feature: 0, threshold: 1.0, vote: 0.5 },
            Stump { feature: 1, threshold: 2.0, vote: -0.25 },
        ];
        assert_eq!(score(&stumps, &[2.0, 3.0]), 0.25);
        assert_eq!(score(&stumps, &[0.0, 0.0]), -0.25);
        assert_eq!(score(&stumps, &[f32::NAN]), -0.5 + 0.25);
    }
}
