//! A long campaign is a test that reads from its environment which part of it to run.
//!
//! Without the environment it is a short slice with seed 1, as CI runs it. `cargo xtask campaign` starts the same test
//! once for each block on all cores, and adds up what it prints.

use std::ops::Range;

/// Which trials to run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Slice {
    /// Seed of the campaign.
    pub seed: u64,
    /// Numbers of the trials.
    pub trials: Range<u64>,
}

impl Slice {
    /// What the environment asks for; otherwise seed 1 and the first `trials`.
    ///
    /// # Panics
    /// A variable is set and is no number.
    #[must_use]
    pub fn from_environment(trials: u64) -> Self {
        let number = |name: &str| {
            std::env::var(name)
                .ok()
                .map(|text| text.parse().unwrap_or_else(|_| panic!("{name}={text}: no number")))
        };
        Self {
            seed: number("FLOORGUARD_CAMPAIGN_SEED").unwrap_or(1),
            trials: number("FLOORGUARD_CAMPAIGN_FROM").unwrap_or(0)
                ..number("FLOORGUARD_CAMPAIGN_TO").unwrap_or(trials),
        }
    }

    /// Random numbers of a trial: the same for every way to cut the campaign into blocks.
    #[must_use]
    pub const fn random(&self, trial: u64) -> Random {
        let state = self.seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ trial.wrapping_mul(0xd134_2543_de82_ef95);
        Random { given: Vec::new(), state }
    }
}

/// Tells the campaign command what was counted.
pub fn report(counts: &[(&str, u64)]) {
    for (name, count) in counts {
        println!("campaign: {name} = {count}");
    }
}

/// SplitMix64 (Steele et al. 2014): a campaign needs no more than that.
#[derive(Clone, Debug)]
pub struct Random {
    /// Bytes that somebody chose, the last ones first.
    given: Vec<u8>,
    state: u64,
}

impl Random {
    /// Numbers that a fuzzer chooses: those that `bytes` hold, then others.
    #[must_use]
    pub fn given(bytes: &[u8]) -> Self {
        Self { given: bytes.iter().rev().copied().collect(), state: 0 }
    }

    /// The next 64 bits.
    #[expect(clippy::should_implement_trait, reason = "numbers that never end are no list to walk")]
    pub fn next(&mut self) -> u64 {
        if let Some(rest) = self.given.len().checked_sub(8) {
            let chosen: Vec<u8> = self.given.drain(rest..).rev().collect();
            return chosen.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte));
        }
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Less than `end`, which must not be 0.
    pub fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    /// True once in `one_in`.
    pub fn seldom(&mut self, one_in: u64) -> bool {
        self.below(one_in) == 0
    }
}

#[cfg(test)]
mod tests {
    use super::Random;

    #[test]
    fn a_fuzzer_chooses_the_first_numbers() {
        let mut random = Random::given(&[1, 2, 0, 0, 0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0, 9]);
        assert_eq!((random.next(), random.below(5)), (0x0201, 2));
        let (mut plain, mut other) = (Random::given(&[]), random.clone());
        assert_eq!((random.next(), other.next()), (plain.next(), Random::given(&[]).next()));
    }
}
