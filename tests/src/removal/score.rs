//! The judge of removers: what share of the static points stays, and what share of the people's points goes.
//!
//! Static accuracy, dynamic accuracy and their harmonic mean as in the benchmark of Zhang et al. 2023, counted over single
//! returns with labels of the simulator. A remover that removes nothing or everything scores 0.

/// Returns by label and verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Score {
    /// Static returns that stay.
    pub static_kept: u64,
    /// Static returns that were removed.
    pub static_removed: u64,
    /// Returns of people that stay.
    pub people_kept: u64,
    /// Returns of people that were removed.
    pub people_removed: u64,
}

impl Score {
    /// Enters a return: its label, and what the remover did.
    pub fn enter(&mut self, is_person: bool, is_removed: bool) {
        let count = match (is_person, is_removed) {
            (false, false) => &mut self.static_kept,
            (false, true) => &mut self.static_removed,
            (true, false) => &mut self.people_kept,
            (true, true) => &mut self.people_removed,
        };
        *count += 1;
    }

    /// Both together.
    pub fn add(&mut self, other: &Self) {
        self.static_kept += other.static_kept;
        self.static_removed += other.static_removed;
        self.people_kept += other.people_kept;
        self.people_removed += other.people_removed;
    }

    /// Share of the static returns that stay; 0 without any.
    #[must_use]
    pub fn static_accuracy(&self) -> f64 {
        share(self.static_kept, self.static_removed)
    }

    /// Share of the people's returns that are removed; 0 without any.
    #[must_use]
    pub fn dynamic_accuracy(&self) -> f64 {
        share(self.people_removed, self.people_kept)
    }

    /// Harmonic mean of both; 0 if either is.
    #[must_use]
    pub fn harmonic_mean(&self) -> f64 {
        let (a, b) = (self.static_accuracy(), self.dynamic_accuracy());
        if a + b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 }
    }
}

fn share(part: u64, rest: u64) -> f64 {
    if part + rest == 0 { 0.0 } else { part as f64 / (part + rest) as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1,000 returns, 50 of them of people.
    fn of(remover: impl Fn(bool) -> bool) -> Score {
        let mut score = Score::default();
        (0..1_000).map(|number| number % 20 == 0).for_each(|person| score.enter(person, remover(person)));
        score
    }

    #[test]
    fn removing_nothing_or_everything_scores_nothing() {
        let idle = of(|_| false);
        assert_eq!((idle.static_accuracy(), idle.dynamic_accuracy(), idle.harmonic_mean()), (1.0, 0.0, 0.0));
        let all = of(|_| true);
        assert_eq!((all.static_accuracy(), all.dynamic_accuracy(), all.harmonic_mean()), (0.0, 1.0, 0.0));
        let inverted = of(|person| !person);
        assert_eq!(inverted.harmonic_mean(), 0.0);
        let right = of(|person| person);
        assert_eq!(right.harmonic_mean(), 1.0);
        assert_eq!(Score::default().harmonic_mean(), 0.0);
    }

    #[test]
    fn shares_are_of_each_kind_alone() {
        let score = Score { static_kept: 95, static_removed: 5, people_kept: 1, people_removed: 3 };
        assert_eq!((score.static_accuracy(), score.dynamic_accuracy()), (0.95, 0.75));
        assert!((score.harmonic_mean() - 2.0 * 0.95 * 0.75 / 1.7).abs() < 1.0e-12);
    }
}
