//! One place of 2 m: how many visitors an hour, when, and how surely; how dirty it gets.
//!
//! What is seen is gathered for ten minutes, then every model predicts it, is judged, and learns it. Rates, not
//! yes-or-no, because a robot that watched for two minutes has not seen that nobody came in ten: the visits are a
//! Poisson process whose rate is the signal (after Jovan et al. 2016), and a slice weighs as much as it was watched.

use floorguard_types::number::{nearest_f32, truncating_u8};

use super::contest::Contest;
use super::correction::{Correction, Fit, HourlyVisits};
use super::dirt_seen::DirtSeen;
use super::evidence::Rate;
use super::rhythm::Rhythm;
use super::spectrum::{ORDER_MAX, Spectrum, Tone};
use super::wall_time::{LocalTime, WallTime};
use super::week::{Evidence, Week};

/// Length of a slice, s (book, Environment: Places).
pub const SLICE_S: i64 = 600;
/// Slices watched for less teach nothing, hundredths of a second.
const WATCHED_CS_MIN: u32 = 1_500;
/// The rhythm, the spectrum's orders 0 to 4, the day and the week.
pub const FORMULAS: usize = ORDER_MAX + 4;
/// A predicted rate is at least this share of the mean: a spectrum rings below zero around sharp edges.
const FLOOR: f32 = 0.05;
/// 1970-01-05, a Monday.
const MONDAY_S: i64 = 345_600;
/// Nothing is ever impossible: one visit in a thousand hours.
const RATE_MIN: f32 = 0.001;
/// An hour of the day watched for less was not really seen, h.
const SEEN_HOURS: f32 = 0.25;
/// An answer about an unobserved hour is at most a guess, h.
const UNSEEN_EVIDENCE_HOURS: f32 = 0.5;

/// Which model predicts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RateModel {
    /// Hours of the day and weekdays, each believed as far as the data carry it.
    Rhythm,
    /// The same at all times.
    Mean,
    /// A spectrum with this many periods.
    Spectrum(u8),
    /// A histogram of the hours of the day.
    Day,
    /// A histogram of the hours of the week.
    Week,
}

impl RateModel {
    fn of(formula: usize) -> Self {
        match formula {
            0 => Self::Rhythm,
            1 => Self::Mean,
            place @ 2..=5 => Self::Spectrum(truncating_u8(place.saturating_sub(1))),
            6 => Self::Day,
            _ => Self::Week,
        }
    }

    /// The name, for reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rhythm => "hours and weekdays",
            Self::Mean => "mean",
            Self::Spectrum(_) => "spectrum",
            Self::Day => "hours of the day",
            Self::Week => "hours of the week",
        }
    }
}

/// What was seen in the ten minutes that are going on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlaceSlice {
    /// Number of the slice since 1970.
    pub number: i64,
    /// Visits.
    pub visits: u16,
    /// Time watched, hundredths of a second.
    pub watched_cs: u32,
}

/// A place: `HOURS` bins and `PERIODS` periods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<const HOURS: usize, const PERIODS: usize> {
    /// The histogram.
    pub week: Week<HOURS>,
    /// The spectrum of the rate, visits an hour; samples weigh the hours watched.
    pub spectrum: Spectrum<PERIODS>,
    /// Whose predictions are best.
    pub contest: Contest<FORMULAS>,
    /// Sum of the squared errors by their Poisson variance, and how many: how much visits come in groups.
    pub spread: (f32, f32),
    /// Visits whose length is known, and the time they took, tenths of a second.
    pub stays: (u32, u32),
    /// Dirt that was picked up.
    pub dirt: DirtSeen,
    /// When it was last cleaned, and the units that were left.
    pub cleaned: Option<(WallTime, f32)>,
    slice: PlaceSlice,
}

impl<const HOURS: usize, const PERIODS: usize> Default for Place<HOURS, PERIODS> {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl<const HOURS: usize, const PERIODS: usize> Place<HOURS, PERIODS> {
    /// A place of which nothing is known.
    pub const EMPTY: Self = Self {
        week: Week::EMPTY,
        spectrum: Spectrum::weekly(),
        contest: Contest::EMPTY,
        spread: (0.0, 0.0),
        stays: (0, 0),
        dirt: DirtSeen { units: 0.0, hours: 0.0 },
        cleaned: None,
        slice: PlaceSlice { number: 0, visits: 0, watched_cs: 0 },
    };

    /// What is going on.
    #[must_use]
    pub const fn slice(&self) -> PlaceSlice {
        self.slice
    }

    /// The same, from a file.
    pub const fn restore_slice(&mut self, slice: PlaceSlice) {
        self.slice = slice;
    }

    /// Somebody was there, and entered if `is_visit`.
    pub fn note(&mut self, (at, offset_s): (WallTime, i32), is_visit: bool, dwell_ds: u32) {
        self.turn_to(at, offset_s);
        self.slice.visits = self.slice.visits.saturating_add(u16::from(is_visit));
        let (visits, dwell) =
            (self.stays.0.checked_add(u32::from(is_visit)), self.stays.1.checked_add(dwell_ds));
        self.stays = visits.zip(dwell).unwrap_or((self.stays.0 / 2, self.stays.1 / 2));
    }

    /// It was watched for `watched_cs` hundredths of a second that ended now.
    pub fn watch(&mut self, (at, offset_s): (WallTime, i32), watched_cs: u32) {
        self.turn_to(at, offset_s);
        self.slice.watched_cs = self.slice.watched_cs.saturating_add(watched_cs);
    }

    /// Learns the slice that is over, if it is.
    pub fn turn_to(&mut self, at: WallTime, offset_s: i32) {
        let number = at.as_seconds().div_euclid(SLICE_S);
        if number > self.slice.number {
            self.close(offset_s);
            self.slice.number = number;
        }
    }

    /// Learns what was seen of the slice that is going on, because the watching ends here.
    pub fn close(&mut self, offset_s: i32) {
        let slice = self.slice;
        self.slice = PlaceSlice { number: slice.number, visits: 0, watched_cs: 0 };
        if slice.watched_cs >= WATCHED_CS_MIN {
            self.learn(slice, offset_s);
        }
    }

    fn learn(&mut self, slice: PlaceSlice, offset_s: i32) {
        let middle_s = slice.number.saturating_mul(SLICE_S).saturating_add(SLICE_S / 2);
        let at = WallTime::from_seconds(middle_s).local(offset_s);
        let hours = nearest_f32(slice.watched_cs) * (1.0 / 360_000.0);
        let visits = f32::from(slice.visits);
        let forecast = self.forecast();
        let rates = forecast.all(at);
        if self.week.total().hours > 0.0 {
            // The Poisson score: its expectation is smallest at the true rate, which that of the absolute error is not.
            let losses = rates.map(|rate| rate * hours - visits * libm::logf(rate * hours));
            let expected = forecast.rate(at).per_hour * hours;
            self.contest.add(&losses);
            let error = visits - expected;
            let kept = 0.999;
            self.spread =
                (self.spread.0 * kept + error * error / expected.max(0.05), self.spread.1 * kept + 1.0);
        }
        self.spectrum.add(at, visits / hours, hours);
        self.week.add(at, slice.visits, slice.watched_cs / 10);
    }

    /// How much more visits vary than independent people would: 1 or more.
    #[must_use]
    pub fn spread(&self) -> f32 {
        let (sum, count) = self.spread;
        if count > 10.0 { (sum / count).max(1.0) } else { 1.0 }
    }

    /// Hours that a visit lasts, on average; a second each if none is known.
    #[must_use]
    pub fn stay_hours(&self) -> f32 {
        let (visits, dwell_ds) = self.stays;
        if visits == 0 { 1.0 / 3_600.0 } else { nearest_f32(dwell_ds) / nearest_f32(visits) / 36_000.0 }
    }

    /// Predicts, with what does not depend on the moment worked out once.
    #[must_use]
    pub fn forecast(&self) -> Forecast<'_, HOURS, PERIODS> {
        let model = RateModel::of(self.contest.best());
        let (mean, spread) = (Rate::mean_of(self.week.total()), self.spread());
        let (tones, rhythm) = (self.spectrum.tones(), Rhythm::new(&self.week, spread));
        let of_rhythm = rhythm.correction(&self.week, spread);
        let mut forecast =
            Forecast { place: self, tones, rhythm, correction: of_rhythm, of_rhythm, mean, model };
        if let RateModel::Spectrum(order) = model {
            let fitted = 1.0 + 2.0 * f32::from(order);
            forecast.correction =
                Correction::new(&self.week, Fit { spread, fitted }, |index| forecast.swing(index, order));
        }
        forecast
    }
}

/// Predictions of one place.
#[derive(Clone, Copy, Debug)]
pub struct Forecast<'a, const HOURS: usize, const PERIODS: usize> {
    place: &'a Place<HOURS, PERIODS>,
    tones: [Tone; ORDER_MAX],
    rhythm: Rhythm,
    /// What puts the chosen formula right, and what puts the rhythm right.
    correction: Correction,
    of_rhythm: Correction,
    mean: f32,
    model: RateModel,
}

impl<const HOURS: usize, const PERIODS: usize> Forecast<'_, HOURS, PERIODS> {
    /// The model that predicts.
    #[must_use]
    pub const fn model(&self) -> RateModel {
        self.model
    }

    /// Hours watched in all.
    #[must_use]
    pub fn watched_hours(&self) -> f32 {
        self.place.week.total().hours
    }

    /// The spectrum's rate at some orders, never far below the mean.
    fn orders(&self, at: LocalTime) -> [f32; ORDER_MAX] {
        let floor = FLOOR * self.mean;
        let [_, one, two, three, four] = self.place.spectrum.predict_all(at, &self.tones);
        [one, two, three, four].map(|rate| rate.max(floor))
    }

    fn order(&self, at: LocalTime, order: u8) -> f32 {
        let index = usize::from(order).saturating_sub(1);
        self.orders(at).get(index).copied().unwrap_or(self.mean)
    }

    /// The spectrum's rate in the middle of an hour of the week.
    fn swing(&self, hour_of_week: usize, order: u8) -> f32 {
        let second =
            i64::try_from(hour_of_week).unwrap_or_default().saturating_mul(3_600).saturating_add(1_800);
        self.order(LocalTime::from_seconds(second.saturating_add(MONDAY_S)), order)
    }

    /// Rates of all formulas, visits an hour: the rhythm, orders 0 to 4, the day, the week.
    #[must_use]
    pub fn all(&self, at: LocalTime) -> [f32; FORMULAS] {
        let week = &self.place.week;
        let usual = |seen: Evidence| {
            if seen.hours > 0.0 { Rate::of(seen, self.mean, 1.0).per_hour } else { self.mean }
        };
        let rhythm = self.rhythm.rate(week, &self.of_rhythm, at).per_hour;
        let [one, two, three, four] = self.orders(at);
        [rhythm, self.mean, one, two, three, four, usual(week.around_any_day(at)), usual(week.around(at))]
            .map(|rate| rate.max(RATE_MIN))
    }

    /// Visits an hour with the model that has predicted best so far. Unknown where not observed; a guess for an
    /// unobserved hour of the day.
    #[must_use]
    pub fn rate(&self, at: LocalTime) -> Rate {
        let (week, spread) = (&self.place.week, self.place.spread());
        let (day, total) = (week.around_any_day(at), week.total());
        let is_seen = day.hours >= SEEN_HOURS;
        let HourlyVisits { per_hour, watched_hours } = match self.model {
            RateModel::Spectrum(order) if is_seen => self.correction.apply(week, at, self.order(at, order)),
            RateModel::Mean => HourlyVisits { per_hour: self.mean, watched_hours: total.hours },
            RateModel::Day if is_seen => return Rate::of(day, self.mean, spread),
            RateModel::Week if week.around(at).hours >= SEEN_HOURS => {
                return Rate::of(week.around(at), self.mean, spread);
            }
            // A spectrum predicts unobserved hours, but not reliably.
            _ => self.rhythm.rate(week, &self.of_rhythm, at),
        };
        let hours = if is_seen { watched_hours } else { total.hours.min(UNSEEN_EVIDENCE_HOURS) };
        Rate::with_doubt(per_hour.max(RATE_MIN), hours, spread)
    }
}

#[cfg(test)]
#[path = "place_tests.rs"]
mod tests;
