//! A weekly pattern that was built in, found again: the strongest periods, and the week as a curve.

use std::fmt::Write as _;
use std::path::Path;

use floorguard_laboratory::mission::pictures::{Series, line_plot};
use floorguard_mapping::environment::{LocalTime, ORDER_MAX, Place, SLICE_S, Tone, WallTime};
use floorguard_robot::environment::{HOURS, PERIODS};
use floorguard_types::random::Pcg32;

use super::patterns::Pattern;

/// A Monday, 00:00 UTC.
const MONDAY_S: i64 = 1_775_433_600;
/// Weeks watched.
const WEEKS: i64 = 8;
const SLICES: i64 = 604_800 / SLICE_S;

/// What was found again of a pattern.
pub struct Recovery {
    /// The pattern.
    pub pattern: Pattern,
    /// Its strongest periods by a Fourier sum over the true rate.
    pub built_in: [Tone; ORDER_MAX],
    /// Those that the model found.
    pub found: [Tone; ORDER_MAX],
    /// Swing of the pattern's spectrum that its strongest periods do not cover, and noise of one coefficient: a period
    /// below it cannot be found.
    pub noise: f64,
    place: Box<Place<HOURS, PERIODS>>,
}

/// Watches a pattern for eight weeks.
#[must_use]
pub fn recovery(pattern: &Pattern, seed: u64) -> Recovery {
    let mut random = Pcg32::new(seed, 11);
    let mut place = Box::new(Place::<HOURS, PERIODS>::EMPTY);
    let mut sum = 0.0;
    for slice in 0..WEEKS * SLICES {
        let at = WallTime::from_seconds(MONDAY_S + slice * SLICE_S + SLICE_S / 2);
        let expected = pattern.rate(at.local(0)) * (SLICE_S as f32 / 3_600.0);
        // A Poisson number, wait by wait.
        let mut waited = -libm::logf(1.0 - random.uniform_between(0.0, 0.999_999));
        place.watch((at, 0), (SLICE_S * 100) as u32);
        while waited < expected {
            place.note((at, 0), true, 20);
            waited -= libm::logf(1.0 - random.uniform_between(0.0, 0.999_999));
        }
        sum += f64::from(expected);
    }
    place.close(0);
    // The variance of a rate seen for h hours is rate/h; of a coefficient, half of that of the mean.
    let hours = (WEEKS * 168) as f64;
    let noise = (sum / hours / hours * 0.5).sqrt();
    Recovery { pattern: *pattern, built_in: strongest(pattern), found: place.spectrum.tones(), noise, place }
}

/// A plain Fourier sum over the true rate, minute by minute, in double precision.
fn strongest(pattern: &Pattern) -> [Tone; ORDER_MAX] {
    let minutes = 7 * 1_440;
    let mut tones: Vec<Tone> = (1..=PERIODS as u16)
        .map(|harmonic| {
            let (mut re, mut im) = (0.0_f64, 0.0_f64);
            for minute in 0..minutes {
                let seconds = f64::from(minute) * 60.0 + 30.0;
                let turn = core::f64::consts::TAU * f64::from(harmonic) * seconds / 604_800.0;
                let local = LocalTime::from_seconds(MONDAY_S + i64::from(minute) * 60 + 30);
                let rate = f64::from(pattern.rate(local));
                re += rate * turn.cos();
                im -= rate * turn.sin();
            }
            let (re, im) = (re / f64::from(minutes), im / f64::from(minutes));
            Tone { harmonic, amplitude: re.hypot(im) as f32, phase_rad: im.atan2(re) as f32 }
        })
        .collect();
    tones.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    let mut best = [Tone::default(); ORDER_MAX];
    best.iter_mut().zip(tones).for_each(|(slot, tone)| *slot = tone);
    best
}

impl Recovery {
    /// Largest distance, over the built-in periods that stand out of the noise, between the coefficient built in and
    /// the coefficient found, in deviations of the noise; 0 if there is none.
    #[must_use]
    pub fn worst_deviations(&self) -> f64 {
        let standing = self.built_in.iter().filter(|tone| f64::from(tone.amplitude) > 6.0 * self.noise);
        standing
            .map(|tone| {
                let found = self.place.spectrum.coefficient(usize::from(tone.harmonic) - 1);
                let re = f64::from(found.re - tone.amplitude * tone.phase_rad.cos());
                let im = f64::from(found.im - tone.amplitude * tone.phase_rad.sin());
                re.hypot(im) / self.noise
            })
            .fold(0.0, f64::max)
    }

    /// The strongest period is the one built in, and all that stand out of the noise are found within five deviations
    /// of it; a place without a pattern shows none.
    #[must_use]
    pub fn holds(&self) -> bool {
        let [strongest, ..] = self.built_in;
        let [found, ..] = self.found;
        if f64::from(strongest.amplitude) < 6.0 * self.noise {
            return f64::from(found.amplitude) < 6.0 * self.noise;
        }
        found.harmonic == strongest.harmonic && self.worst_deviations() < 5.0
    }

    /// The week as it is and as it is predicted.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn draw(&self, path: &Path) -> anyhow::Result<()> {
        let forecast = self.place.forecast();
        let curve = |value: &dyn Fn(LocalTime) -> f32| {
            let at = |quarter: i64| LocalTime::from_seconds(MONDAY_S + quarter * 900 + 450);
            (0..672).map(|quarter| (quarter as f64 / 96.0, f64::from(value(at(quarter))))).collect()
        };
        let series = [
            Series { name: "built in".into(), points: curve(&|at| self.pattern.rate(at)) },
            Series {
                name: "spectrum, 4 periods".into(),
                points: curve(&|at| self.place.spectrum.predict(at, 4).max(0.0)),
            },
            Series { name: "ours".into(), points: curve(&|at| forecast.rate(at).per_hour) },
        ];
        let title = format!("{}: eight weeks watched", self.pattern.name);
        line_plot(path, (&title, "days since Monday", "visitors an hour"), &series)
    }
}

/// The table.
#[must_use]
pub fn table(all: &[Recovery]) -> String {
    let mut text = String::from(
        "Weekly patterns found again after eight weeks: strongest periods of the rate, hours and half swing (visitors an hour)\n",
    );
    for one in all {
        let words = |tones: &[Tone; ORDER_MAX]| -> String {
            let each = tones.iter().filter(|tone| tone.harmonic > 0);
            let each: Vec<String> = each
                .map(|tone| format!("{:.1} h {:.2}", 168.0 / f32::from(tone.harmonic), tone.amplitude))
                .collect();
            each.join(", ")
        };
        let _infallible = writeln!(
            text,
            "{:<16} built in: {}\n{:<16} found:    {}; at most {:.1} deviations of the noise off ({:.2}): {}",
            one.pattern.name,
            words(&one.built_in),
            "",
            words(&one.found),
            one.worst_deviations(),
            one.noise,
            if one.holds() { "found" } else { "NOT FOUND" }
        );
    }
    text
}
