//! The times of one stream: whether they grow, how fast, and where there are gaps.

use floorguard_host::words::counted;
use serde::Serialize;

/// A gap is longer than so many usual steps …
const GAP_STEPS: f64 = 3.0;
/// … and than this, seconds.
const GAP_S: f64 = 0.05;
/// So many steps tell what is usual.
const STEPS_KEPT: usize = 100_000;

/// Times while they are read.
#[derive(Debug, Default)]
pub struct Timeline {
    first_us: Option<u64>,
    last_us: u64,
    count: u64,
    equal: u64,
    backwards: u64,
    steps_us: Vec<u64>,
    /// The longest step, and when it began.
    longest_us: (u64, u64),
}

/// What they came to.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Times {
    /// Of the first one, seconds of the recording's clock.
    pub first_s: Option<f64>,
    /// From the first to the last, seconds.
    pub duration_s: f64,
    /// By the step in the middle of all steps.
    pub rate_hz: Option<f64>,
    /// By the number and the whole time.
    pub mean_rate_hz: Option<f64>,
    /// As the one before.
    pub equal: u64,
    /// Earlier than the one before.
    pub backwards: u64,
    /// Steps that are far longer than usual.
    pub gaps: u64,
    /// The longest step, seconds.
    pub longest_s: f64,
    /// When it began, seconds after the first one.
    pub longest_at_s: f64,
}

impl Timeline {
    /// The next one.
    pub fn add(&mut self, time_us: u64) {
        if self.first_us.is_none() {
            self.first_us = Some(time_us);
        } else if time_us == self.last_us {
            self.equal += 1;
        } else if time_us < self.last_us {
            self.backwards += 1;
        } else {
            let step_us = time_us - self.last_us;
            if step_us > self.longest_us.0 {
                self.longest_us = (step_us, self.last_us);
            }
            if self.steps_us.len() < STEPS_KEPT {
                self.steps_us.push(step_us);
            }
        }
        self.last_us = time_us;
        self.count += 1;
    }

    /// How many.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// What they come to.
    pub fn times(&self) -> Times {
        let seconds = |us: u64| us as f64 * 1.0e-6;
        let mut steps = self.steps_us.clone();
        steps.sort_unstable();
        let usual_s = steps.get(steps.len() / 2).map(|step| seconds(*step));
        let is_gap = |step: &u64| seconds(*step) > (usual_s.unwrap_or(0.0) * GAP_STEPS).max(GAP_S);
        let first_us = self.first_us.unwrap_or(0);
        let duration_s = seconds(self.last_us.saturating_sub(first_us));
        Times {
            first_s: self.first_us.map(seconds),
            duration_s,
            mean_rate_hz: (self.count > 1 && duration_s > 0.0).then(|| (self.count - 1) as f64 / duration_s),
            rate_hz: usual_s.map(|step_s| 1.0 / step_s),
            equal: self.equal,
            backwards: self.backwards,
            gaps: steps.iter().filter(|step| is_gap(step)).count() as u64,
            longest_s: seconds(self.longest_us.0),
            longest_at_s: seconds(self.longest_us.1.saturating_sub(first_us)),
        }
    }
}

impl Times {
    /// What is wrong with them, in words, where pauses of that many seconds are right.
    pub fn faults(&self, count: u64, pauses_s: f64) -> Vec<String> {
        let mut faults = Vec::new();
        if self.equal > 0 && self.equal + 1 == count {
            faults.push(format!("all {count} bear one time"));
        } else if self.equal > 0 {
            faults.push(format!("{} of {count} bear the time of the one before", self.equal));
        }
        if self.backwards > 0 {
            faults.push(format!("{} of {count} are earlier than the one before", self.backwards));
        }
        if self.gaps > 0 && self.longest_s > pauses_s {
            let Self { longest_s, longest_at_s, .. } = self;
            let gaps = counted(self.gaps, "gap");
            faults.push(format!("{gaps}, the longest {longest_s:.2} s at {longest_at_s:.1} s"));
        }
        faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_of_times_are_named() {
        let of = |times: &[u64]| {
            let mut line = Timeline::default();
            times.iter().for_each(|time_us| line.add(*time_us));
            line.times().faults(line.count(), 0.0).join("; ")
        };
        assert_eq!(of(&[7, 7, 7]), "all 3 bear one time");
        assert_eq!(
            of(&[1_000, 2_000, 2_000, 1_500]),
            "1 of 4 bear the time of the one before; 1 of 4 are earlier than the one before"
        );
        assert_eq!(of(&[0, 100_000, 200_000, 900_000, 1_000_000]), "1 gap, the longest 0.70 s at 0.2 s");
        assert_eq!(of(&[0, 100_000, 200_000]), "");
    }

    /// A lidar with a closed sector is silent once a turn.
    #[test]
    fn pauses_of_closed_sector_are_no_gaps() {
        let mut line = Timeline::default();
        for turn in 0..10 {
            (0..20).for_each(|packet| line.add(turn * 100_000 + packet * 1_000));
        }
        let (times, count) = (line.times(), line.count());
        assert_eq!(times.faults(count, 0.0).len(), 1);
        assert!(times.faults(count, 0.1).is_empty());
    }
}
