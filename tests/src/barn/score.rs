//! The benchmark's metric, and the same without its ceiling.

use super::drive::Outcome;
use super::world::World;

/// What a run is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Score {
    /// Success × optimal time / time, clipped to 4 and 8 optimal times: at most 0.25.
    pub clipped: f32,
    /// The same without the lower clip.
    pub open: f32,
}

impl Score {
    /// Of a run in a world.
    #[must_use]
    pub fn of(world: &World, outcome: &Outcome) -> Self {
        let Outcome::Reached { time_s } = *outcome else { return Self::default() };
        let optimal_s = world.optimal_s();
        Self {
            clipped: optimal_s / time_s.clamp(4.0 * optimal_s, 8.0 * optimal_s),
            open: optimal_s / time_s.clamp(optimal_s, 8.0 * optimal_s),
        }
    }
}

/// Many runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// How many.
    pub runs: usize,
    /// Share that reached the goal.
    pub success: f32,
    /// Share that touched a cylinder.
    pub collision: f32,
    /// Share that was still driving after 100 s.
    pub timeout: f32,
    /// Mean scores.
    pub score: Score,
    /// Mean time of those that arrived, seconds.
    pub time_s: f32,
}

/// Means over runs.
#[must_use]
pub fn summarise(runs: &[(World, Outcome)]) -> Summary {
    let count = runs.len().max(1) as f32;
    let share =
        |is: fn(&Outcome) -> bool| runs.iter().filter(|(_, outcome)| is(outcome)).count() as f32 / count;
    let success = share(|outcome| matches!(outcome, Outcome::Reached { .. }));
    let mean = |of: fn(Score) -> f32| {
        runs.iter().map(|(world, outcome)| of(Score::of(world, outcome))).sum::<f32>() / count
    };
    let times = runs.iter().filter_map(|(_, outcome)| match outcome {
        Outcome::Reached { time_s } => Some(*time_s),
        _ => None,
    });
    Summary {
        runs: runs.len(),
        success,
        collision: share(|outcome| matches!(outcome, Outcome::Collided { .. })),
        timeout: share(|outcome| matches!(outcome, Outcome::TimedOut)),
        score: Score { clipped: mean(|score| score.clipped), open: mean(|score| score.open) },
        time_s: times.sum::<f32>() / (success * count).max(1.0),
    }
}
