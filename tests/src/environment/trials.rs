//! Prediction errors of the model and of others, in places that are watched always or now and then.

use std::fmt::Write as _;

use floorguard_mapping::environment::{HOURS_OF_WEEK, LocalTime, Place, SLICE_S, WallTime};
use floorguard_robot::environment::{HOURS, PERIODS};
use floorguard_types::random::Pcg32;
use rayon::prelude::*;

use super::patterns::{PATTERNS, Pattern};

/// A Monday, 00:00 UTC.
const MONDAY_S: i64 = 1_775_433_600;
/// Slices of a week.
const SLICES: i64 = 604_800 / SLICE_S;
/// Weeks of learning that are compared.
const WEEKS: [i64; 4] = [1, 2, 4, 8];

/// When the place is watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watching {
    /// Always.
    Always,
    /// A robot passes: one slice in twelve, at random, for three of its ten minutes.
    Patrol,
}

impl Watching {
    const fn name(self) -> &'static str {
        match self {
            Self::Always => "always",
            Self::Patrol => "patrol",
        }
    }
}

/// Errors of one place after some weeks.
#[derive(Clone, Debug)]
pub struct Row {
    /// The place.
    pub pattern: &'static str,
    /// How it was watched.
    pub watching: Watching,
    /// For how many weeks.
    pub weeks: i64,
    /// Mean absolute error of the rate over a week, visitors an hour: of the mean, the plain histogram of the day, that
    /// of the week, the spectrum with four periods, and what the model answers.
    pub errors: [f64; 5],
    /// Share of the week in which the true rate of the hour lies within the model's interval of 95 %.
    pub coverage: f64,
    /// Mean true rate, visitors an hour.
    pub mean_rate: f64,
}

/// Visits of a Poisson process in a time of expected count `expected`.
fn poisson(random: &mut Pcg32, expected: f32) -> u16 {
    let mut product = 1.0_f64;
    let limit = f64::from(-expected).exp();
    for count in 0..1_000 {
        product *= f64::from(random.uniform_between(0.0, 1.0));
        if product <= limit {
            return count;
        }
    }
    1_000
}

/// The plain histograms.
struct Plain {
    visits: [f64; HOURS_OF_WEEK],
    hours: [f64; HOURS_OF_WEEK],
}

impl Plain {
    fn ratio(&self, chosen: impl Fn(usize) -> bool) -> Option<f64> {
        let sum = |values: &[f64; HOURS_OF_WEEK]| -> f64 {
            values.iter().enumerate().filter(|(hour, _)| chosen(*hour)).map(|(_, value)| value).sum()
        };
        let hours = sum(&self.hours);
        (hours > 0.0).then(|| sum(&self.visits) / hours)
    }
}

/// Learns `weeks` weeks, then compares all predictors with the true rate at every quarter of an hour of the next.
#[must_use]
pub fn trial(pattern: &Pattern, watching: Watching, (weeks, seed): (i64, u64)) -> Row {
    let mut random = Pcg32::new(seed, 54);
    let mut place = Place::<HOURS, PERIODS>::EMPTY;
    let mut plain = Plain { visits: [0.0; HOURS_OF_WEEK], hours: [0.0; HOURS_OF_WEEK] };
    for slice in 0..weeks * SLICES {
        let at = WallTime::from_seconds(MONDAY_S + slice * SLICE_S + SLICE_S / 2);
        let watched_s = match watching {
            Watching::Always => SLICE_S as f32,
            Watching::Patrol if random.below(12) == 0 => 180.0,
            Watching::Patrol => continue,
        };
        let local = at.local(0);
        let visits = poisson(&mut random, pattern.rate(local) * watched_s / 3_600.0);
        place.watch((at, 0), (watched_s * 100.0) as u32);
        (0..visits).for_each(|_| place.note((at, 0), true, 20));
        plain.visits[usize::from(local.hour_of_week())] += f64::from(visits);
        plain.hours[usize::from(local.hour_of_week())] += f64::from(watched_s) / 3_600.0;
    }
    place.close(0);
    judge(pattern, (&place, &plain), (watching, weeks))
}

fn judge(
    pattern: &Pattern,
    (place, plain): (&Place<HOURS, PERIODS>, &Plain),
    (watching, weeks): (Watching, i64),
) -> Row {
    let forecast = place.forecast();
    let mean = plain.ratio(|_| true).unwrap_or(0.0);
    let day: Vec<f64> = (0..24).map(|hour| plain.ratio(|bin| bin % 24 == hour).unwrap_or(mean)).collect();
    let week: Vec<f64> =
        (0..HOURS_OF_WEEK).map(|hour| plain.ratio(|bin| bin == hour).unwrap_or(mean)).collect();
    let (mut errors, mut covered, mut sum) = ([0.0; 5], 0_usize, 0.0);
    let quarters = 7 * 96;
    for quarter in 0..quarters {
        let local = WallTime::from_seconds(MONDAY_S + weeks * 604_800 + quarter * 900 + 450).local(0);
        let truth = f64::from(pattern.rate(local));
        let answer = forecast.rate(local);
        let predicted = [
            mean,
            day[usize::from(local.hour())],
            week[usize::from(local.hour_of_week())],
            f64::from(place.spectrum.predict(local, 4)).max(0.0),
            f64::from(answer.per_hour),
        ];
        errors.iter_mut().zip(predicted).for_each(|(error, value)| *error += (value - truth).abs());
        let hourly = hourly_rate(pattern, local);
        covered += usize::from(f64::from(answer.low) <= hourly && hourly <= f64::from(answer.high));
        sum += truth;
    }
    let share = 1.0 / quarters as f64;
    Row {
        pattern: pattern.name,
        watching,
        weeks,
        errors: errors.map(|error| error * share),
        coverage: covered as f64 * share,
        mean_rate: sum * share,
    }
}

/// The true mean rate of the hour around a moment: what a histogram of hours can know at best.
fn hourly_rate(pattern: &Pattern, at: LocalTime) -> f64 {
    let start = at.as_seconds().div_euclid(3_600) * 3_600;
    let minutes = (0..60).map(|minute| pattern.rate(LocalTime::from_seconds(start + minute * 60 + 30)));
    minutes.map(f64::from).sum::<f64>() / 60.0
}

/// The mean of `runs` runs of every place, way of watching and number of weeks.
#[must_use]
pub fn trials(runs: u64, seed: u64) -> Vec<Row> {
    let mut all = Vec::new();
    for watching in [Watching::Always, Watching::Patrol] {
        for pattern in &PATTERNS {
            all.extend(WEEKS.iter().map(|weeks| (pattern, watching, *weeks)));
        }
    }
    all.into_par_iter()
        .map(|(pattern, watching, weeks)| {
            let rows: Vec<Row> =
                (0..runs).map(|run| trial(pattern, watching, (weeks, seed.wrapping_add(run)))).collect();
            average(rows)
        })
        .collect()
}

fn average(rows: Vec<Row>) -> Row {
    let share = 1.0 / rows.len().max(1) as f64;
    let mut mean = Row {
        pattern: rows.first().map_or("", |row| row.pattern),
        watching: rows.first().map_or(Watching::Always, |row| row.watching),
        weeks: rows.first().map_or(0, |row| row.weeks),
        errors: [0.0; 5],
        coverage: 0.0,
        mean_rate: rows.first().map_or(0.0, |row| row.mean_rate),
    };
    for row in rows {
        mean.errors.iter_mut().zip(row.errors).for_each(|(sum, error)| *sum += error * share);
        mean.coverage += row.coverage * share;
    }
    mean
}

/// The table.
#[must_use]
pub fn table(rows: &[Row], runs: u64) -> String {
    let mut text = format!(
        "Mean absolute error of the predicted rate in the week after learning, visitors an hour; {runs} runs each.\n\
         histogram: plain, of the 24 hours of the day; week: plain, of the 168 hours of the week; spectrum: FreMEn with\n\
         four periods; ours: what `ask` uses; covered: share of the week with the hour's true rate within our 95 % interval\n\
         {:<16} {:<7} {:>5} {:>6} | {:>6} {:>9} {:>6} {:>8} {:>6} | {:>8} {:>8}\n",
        "place",
        "watched",
        "weeks",
        "rate",
        "mean",
        "histogram",
        "week",
        "spectrum",
        "ours",
        "of hist.",
        "covered"
    );
    for row in rows {
        let [mean, histogram, week, spectrum, ours] = row.errors;
        let _infallible = writeln!(
            text,
            "{:<16} {:<7} {:>5} {:>6.2} | {mean:>6.2} {histogram:>9.2} {week:>6.2} {spectrum:>8.2} {ours:>6.2} | {:>6.0} % {:>6.1} %",
            row.pattern,
            row.watching.name(),
            row.weeks,
            row.mean_rate,
            100.0 * ours / histogram.max(1e-9),
            100.0 * row.coverage,
        );
    }
    let [mean, histogram, week, spectrum, ours] = totals(rows);
    let _infallible = writeln!(
        text,
        "{:<16} {:<7} {:>5} {:>6} | {mean:>6.2} {histogram:>9.2} {week:>6.2} {spectrum:>8.2} {ours:>6.2} | {:>6.0} % {:>6.1} %",
        "all",
        "",
        "",
        "",
        100.0 * ours / histogram,
        100.0 * rows.iter().map(|row| row.coverage).sum::<f64>() / rows.len().max(1) as f64
    );
    text
}

/// Mean errors over all rows.
#[must_use]
pub fn totals(rows: &[Row]) -> [f64; 5] {
    let mut sum = [0.0; 5];
    for row in rows {
        sum.iter_mut().zip(row.errors).for_each(|(sum, error)| *sum += error / rows.len() as f64);
    }
    sum
}

/// Ours errs by less than 0.7 of the plain histogram of the day overall, and nowhere by more than a quarter more.
#[must_use]
pub fn holds(rows: &[Row]) -> bool {
    let [_, histogram, _, _, ours] = totals(rows);
    ours < 0.7 * histogram && rows.iter().all(|row| row.errors[4] < 1.25 * row.errors[1])
}
