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
        Random {
            state: self.seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ trial.wrapping_mul(0xd134_2543_de82_ef95),
        }
    }
}

/// Tells the campaign command what was counted.
pub fn report(counts: &[(&str, u64)]) {
    for (name, count) in counts {
        println!("campaign: {name} = {count}");
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014): a campaign needs no more than that.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The next 64 bits.
    pub const fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Less than `end`, which must not be 0.
    pub const fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    /// True once in `one_in`.
    pub const fn seldom(&mut self, one_in: u64) -> bool {
        self.below(one_in) == 0
    }
}
