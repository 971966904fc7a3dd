//! What was published (Hess et al. 2014, table I): ten runs of a real robot.

/// A line of the published Table I.
pub struct PublishedLine {
    /// Name of our counterpart.
    pub strategy: &'static str,
    /// Runs that succeeded, of ten.
    pub successes: u32,
    /// Distance, metres; not given for the vendor's own behaviour.
    pub distance_m: Option<f64>,
    /// Time, s.
    pub time_s: f64,
}

/// The published Table I. The vendor's behaviour ran as long as the published approach; ours drives at random as far.
pub const TABLE_ONE: [PublishedLine; 4] = [
    PublishedLine { strategy: "guarantee", successes: 10, distance_m: Some(20.54), time_s: 321.54 },
    PublishedLine { strategy: "no-replanning", successes: 4, distance_m: Some(10.98), time_s: 138.51 },
    PublishedLine { strategy: "systematic", successes: 6, distance_m: Some(81.12), time_s: 891.85 },
    PublishedLine { strategy: "random", successes: 0, distance_m: None, time_s: 321.54 },
];

/// Distance of the systematic strategy over that of the guarantee, as published.
pub const DISTANCE_RATIO: f64 = 81.12 / 20.54;
