//! The questions of an operator, as pure functions: when, where, wet or dry (book, Environment: Questions).

use floorguard_types::number::nearest_f32;

use super::evidence::{Confidence, Rate};
use super::place::Place;
use super::wall_time::WallTime;

/// Steps of a profile: a week in quarters of an hour, and a day beyond for work that starts late.
pub const PROFILE_STEPS: usize = 768;
/// Start times that are compared: a week (book, Environment: Questions).
pub const STARTS_MAX: usize = 672;
/// Length of a step, s.
pub const PROFILE_STEP_S: i64 = 900;
/// Time that a wet floor needs to dry, hours (book, Environment: Questions).
pub const DRYING_HOURS: f32 = 1.0 / 6.0;
/// Encounters that are as good as none when zones are compared.
const EPSILON: f32 = 0.05;
/// A person doubles, triples, quadruples the cost of a path (κ; book, Environment: Questions).
const KAPPA: f32 = 3.0;

/// What is expected in a zone in a quarter of an hour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProfileStep {
    /// People who come to where the robot works, an hour: the mean over the places that are known.
    pub rate: Rate,
    /// Probability that somebody comes to a place within ten minutes: the mean over the places.
    pub presence: f32,
    /// The same at the upper end of the doubt.
    pub presence_high: f32,
    /// People in the zone at a moment.
    pub people: f32,
}

/// What is expected in a zone from a moment on.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// The first moment.
    pub start: WallTime,
    /// Quarter by quarter.
    pub steps: [ProfileStep; PROFILE_STEPS],
    /// Places of the zone.
    pub places: u32,
    /// Places that have been watched.
    pub known_places: u32,
    /// Hours that the places were watched, mean over those known.
    pub watched_hours: f32,
}

impl Profile {
    /// Works out the profile of some places; the clock on the wall is `offset_s` ahead of UTC. The doubts of places
    /// are averaged as if they all erred the same way, because the same people walk through them.
    pub fn new<'a, const HOURS: usize, const PERIODS: usize>(
        places: impl Iterator<Item = &'a Place<HOURS, PERIODS>>,
        start: WallTime,
        offset_s: i32,
    ) -> Self {
        let steps = [ProfileStep::default(); PROFILE_STEPS];
        let mut profile = Self { start, steps, places: 0, known_places: 0, watched_hours: 0.0 };
        for place in places {
            profile.places = profile.places.saturating_add(1);
            profile.add(place, offset_s);
        }
        let share = 1.0 / nearest_f32(profile.known_places).max(1.0);
        profile.watched_hours *= share;
        for step in &mut profile.steps {
            let Rate { per_hour, low, high, hours } = step.rate;
            step.rate = Rate {
                per_hour: per_hour * share,
                low: low * share,
                high: high * share,
                hours: hours * share,
            };
            step.presence *= share;
            step.presence_high *= share;
        }
        profile
    }

    fn add<const HOURS: usize, const PERIODS: usize>(
        &mut self,
        place: &Place<HOURS, PERIODS>,
        offset_s: i32,
    ) {
        let forecast = place.forecast();
        let hours = forecast.watched_hours();
        if hours <= 0.0 {
            return;
        }
        self.known_places = self.known_places.saturating_add(1);
        self.watched_hours += hours;
        let mut at = self.start;
        for step in &mut self.steps {
            let rate = forecast.rate(at.local(offset_s));
            step.rate.per_hour += rate.per_hour;
            step.rate.low += rate.low;
            step.rate.high += rate.high;
            step.rate.hours += rate.hours;
            step.presence += rate.presence(DRYING_HOURS);
            step.presence_high += 1.0 - libm::expf(-rate.high * DRYING_HOURS);
            step.people += rate.per_hour * place.stay_hours();
            at = at.plus_micros(PROFILE_STEP_S.saturating_mul(1_000_000));
        }
    }

    /// The expected encounters of work that begins at a step and lasts for some; interval and evidence with it.
    #[must_use]
    pub fn encounters(&self, first: usize, steps: usize) -> Rate {
        let quarter = nearest_f32(PROFILE_STEP_S) / 3_600.0;
        let mut sum = Rate { hours: f32::INFINITY, ..Rate::default() };
        for step in self.steps.iter().skip(first).take(steps.max(1)) {
            sum.per_hour += step.rate.per_hour * quarter;
            sum.low += step.rate.low * quarter;
            sum.high += step.rate.high * quarter;
            sum.hours = sum.hours.min(step.rate.hours);
        }
        if sum.hours.is_finite() { sum } else { Rate::default() }
    }
}

/// When to start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestTime {
    /// Steps from the start of the profile.
    pub step: usize,
    /// The moment.
    pub start: WallTime,
    /// People met, with doubt; `per_hour` and the interval are counts here.
    pub encounters: Rate,
    /// The same for starting at once.
    pub encounters_now: Rate,
}

/// The start among the first `starts` steps with the fewest encounters during `duration_steps`, where every hour of
/// waiting costs as much as `delay_cost` encounters; of equals the earliest. `None` if nothing is known.
#[must_use]
pub fn best_time(
    profile: &Profile,
    starts: usize,
    duration_steps: usize,
    delay_cost: f32,
) -> Option<BestTime> {
    let delay_cost = if delay_cost.is_finite() { delay_cost.max(0.0) } else { 0.0 };
    let mut best: Option<(f32, usize, Rate)> = None;
    for step in 0..starts.clamp(1, STARTS_MAX) {
        let encounters = profile.encounters(step, duration_steps);
        if encounters.confidence() == Confidence::Unknown {
            continue;
        }
        let waited_hours = nearest_f32(step) * (nearest_f32(PROFILE_STEP_S) / 3_600.0);
        let cost = encounters.per_hour + delay_cost * waited_hours;
        if best.is_none_or(|(least, ..)| cost < least) {
            best = Some((cost, step, encounters));
        }
    }
    let (_, step, encounters) = best?;
    let wait_us =
        i64::try_from(step).unwrap_or_default().saturating_mul(PROFILE_STEP_S.saturating_mul(1_000_000));
    let start = profile.start.plus_micros(wait_us);
    Some(BestTime { step, start, encounters, encounters_now: profile.encounters(0, duration_steps) })
}

/// How to clean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wetness {
    /// The floor dries before anybody is likely to step on it.
    Wet,
    /// Somebody is likely to step on it.
    Dry,
    /// Wet would probably do, but too little is known to say so: dry.
    DryToBeSafe,
    /// Not observed: dry.
    DryUnknown,
}

/// Wet only if even the upper end of the presence while the floor dries is below `threshold`.
#[must_use]
pub fn wetness(step: &ProfileStep, threshold: f32) -> Wetness {
    if step.rate.confidence() == Confidence::Unknown {
        Wetness::DryUnknown
    } else if step.presence_high < threshold {
        Wetness::Wet
    } else if step.presence < threshold {
        Wetness::DryToBeSafe
    } else {
        Wetness::Dry
    }
}

/// Presence over some steps: the mean (book, Environment: Questions).
#[must_use]
pub fn presence(profile: &Profile, first: usize, steps: usize) -> f32 {
    let taken = || profile.steps.iter().skip(first).take(steps.max(1));
    taken().map(|step| step.presence).sum::<f32>() / nearest_f32(taken().count()).max(1.0)
}

/// What a zone is worth cleaning now: units removed for each encounter.
#[must_use]
pub fn removal_per_encounter(expected_units: f32, encounters: f32) -> f32 {
    expected_units.max(0.0) / (encounters.max(0.0) + EPSILON)
}

/// What the navigation multiplies the cost of a cell with.
#[must_use]
pub fn cost_multiplier(presence: f32) -> f32 {
    1.0 + KAPPA * presence.clamp(0.0, 1.0)
}

#[cfg(test)]
#[path = "questions_tests.rs"]
mod tests;
