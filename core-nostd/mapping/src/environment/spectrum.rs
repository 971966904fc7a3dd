//! How a signal varies with the time, as its mean and a few periods: FreMEn in fixed memory (book, Environment:
//! Spectrum).
//!
//! Krajník et al. 2014 and Krajník et al. 2017 keep a running Fourier sum for each candidate period and predict with
//! the strongest ones. Here the sums are exact and incremental (no stale mean), and a sample may carry a weight,
//! because a robot watches a place for a minute here and ten minutes there. The candidates are the harmonics of one
//! base period, which makes an update one sine and a recurrence.

use floorguard_types::number::{nearest_f32_of_f64, truncating_u16, truncating_u64};

use super::wall_time::LocalTime;

/// Most periods that a prediction uses (the largest adaptive order of the reference; book, Environment: Spectrum).
pub const ORDER_MAX: usize = 4;
/// Weight at which old evidence is halved, so that sums keep their precision and habits may change.
const WEIGHT_MAX: f32 = 65_536.0;
/// A prediction of a probability never reaches 0 or 1 (ε; book, Environment: Spectrum).
pub const PROBABILITY_MARGIN: f32 = 0.02;

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f32,
    /// Imaginary part.
    pub im: f32,
}

/// One period of a prediction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tone {
    /// Which harmonic of the base period, ≥ 1; 0 for none.
    pub harmonic: u16,
    /// |γ|: half the swing that this period contributes.
    pub amplitude: f32,
    /// arg γ for the e^(−jωt) convention, radians.
    pub phase_rad: f32,
}

/// The sums of a [`Spectrum`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumParts<const PERIODS: usize> {
    /// Weight of all samples.
    pub weight: f32,
    /// Σ w·s.
    pub sum: f32,
    /// First and last sample, seconds of local time.
    pub span: Option<(i64, i64)>,
    /// Σ w·s·e^(−jωt).
    pub signal: [Complex; PERIODS],
    /// Σ w·e^(−jωt).
    pub sampling: [Complex; PERIODS],
}

/// Sums of a signal over `PERIODS` harmonics of a base period. Time counts from Monday 00:00 local time, so the base
/// must divide a week.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum<const PERIODS: usize> {
    base_s: u32,
    weight: f32,
    sum: f32,
    /// First and last sample, seconds of local time.
    span: Option<(i64, i64)>,
    /// Σ w·s·e^(−jωt).
    signal: [Complex; PERIODS],
    /// Σ w·e^(−jωt): what the sampling times alone would show.
    sampling: [Complex; PERIODS],
}

impl<const PERIODS: usize> Spectrum<PERIODS> {
    /// Periods of a day and its parts: 86,400 s / (i + 1).
    #[must_use]
    pub const fn daily() -> Self {
        Self::of_base(86_400)
    }

    /// Periods of a week and its parts: 604,800 s / (i + 1).
    #[must_use]
    pub const fn weekly() -> Self {
        Self::of_base(604_800)
    }

    const fn of_base(base_s: u32) -> Self {
        let zero = [Complex { re: 0.0, im: 0.0 }; PERIODS];
        Self { base_s, weight: 0.0, sum: 0.0, span: None, signal: zero, sampling: zero }
    }

    /// All sums, to be kept in a file: weight, Σ w·s, first and last second, Σ w·s·e^(−jωt), Σ w·e^(−jωt).
    #[must_use]
    pub const fn parts(&self) -> SpectrumParts<PERIODS> {
        let Self { weight, sum, span, signal, sampling, .. } = *self;
        SpectrumParts { weight, sum, span, signal, sampling }
    }

    /// Takes the sums that [`Self::parts`] gave.
    pub const fn restore(&mut self, parts: SpectrumParts<PERIODS>) {
        self.weight = parts.weight;
        self.sum = parts.sum;
        self.span = parts.span;
        self.signal = parts.signal;
        self.sampling = parts.sampling;
    }

    /// Weight of all samples.
    #[must_use]
    pub const fn weight(&self) -> f32 {
        self.weight
    }

    /// Weighted mean p₀; 0 without samples.
    #[must_use]
    pub fn mean(&self) -> f32 {
        if self.weight > 0.0 { self.sum / self.weight } else { 0.0 }
    }

    /// Seconds between the first and the last sample.
    #[must_use]
    pub fn span_s(&self) -> u64 {
        self.span.map_or(0, |(first, last)| truncating_u64(last.saturating_sub(first).max(0)))
    }

    /// Takes a sample of the signal. A value that is not finite, or a weight that is not positive, changes nothing.
    pub fn add(&mut self, at: LocalTime, value: f32, weight: f32) {
        if !(value.is_finite() && weight > 0.0 && weight < WEIGHT_MAX) {
            return;
        }
        if self.weight >= WEIGHT_MAX {
            self.scale(0.5);
        }
        let second = at.as_seconds();
        let (first, last) = self.span.unwrap_or((second, second));
        self.span = Some((first.min(second), last.max(second)));
        self.weight += weight;
        self.sum += weight * value;
        let angle = self.angle(at);
        let (step_re, step_im) = (libm::cos(angle), -libm::sin(angle));
        let (mut re, mut im) = (f64::from(weight), 0.0_f64);
        for (signal, sampling) in self.signal.iter_mut().zip(self.sampling.iter_mut()) {
            (re, im) = (re * step_re - im * step_im, re * step_im + im * step_re);
            sampling.re += nearest_f32_of_f64(re);
            sampling.im += nearest_f32_of_f64(im);
            signal.re += value * nearest_f32_of_f64(re);
            signal.im += value * nearest_f32_of_f64(im);
        }
    }

    /// Lets old evidence fade: everything is multiplied by `share`, within (0, 1].
    pub fn scale(&mut self, share: f32) {
        let share = if share > 0.0 { share.min(1.0) } else { 1.0 };
        self.weight *= share;
        self.sum *= share;
        for sums in self.signal.iter_mut().chain(self.sampling.iter_mut()) {
            sums.re *= share;
            sums.im *= share;
        }
    }

    /// The time within the base period as an angle, [0, 2π).
    fn angle(&self, at: LocalTime) -> f64 {
        let within = at.second_of_week() % self.base_s.max(1);
        f64::from(within) / f64::from(self.base_s.max(1)) * core::f64::consts::TAU
    }

    /// γ of the i-th period: α/n − p₀·β/n. The second term takes out, to first order, what uneven sampling alone
    /// would show.
    #[must_use]
    pub fn coefficient(&self, index: usize) -> Complex {
        let (Some(signal), Some(sampling)) = (self.signal.get(index), self.sampling.get(index)) else {
            return Complex::default();
        };
        if self.weight <= 0.0 {
            return Complex::default();
        }
        let mean = self.mean();
        Complex {
            re: (signal.re - mean * sampling.re) / self.weight,
            im: (signal.im - mean * sampling.im) / self.weight,
        }
    }

    /// The strongest periods, strongest first; of equals the longer one. A period longer than the time watched is not
    /// used: no repetition was observed.
    #[must_use]
    pub fn tones(&self) -> [Tone; ORDER_MAX] {
        let span_s = self.span_s();
        let mut best = [(0.0_f32, 0_u16); ORDER_MAX];
        for index in 0..PERIODS {
            let harmonic = truncating_u16(index.saturating_add(1).min(usize::from(u16::MAX)));
            if u64::from(self.base_s / u32::from(harmonic)) > span_s {
                continue;
            }
            let gamma = self.coefficient(index);
            let mut held = (gamma.re * gamma.re + gamma.im * gamma.im, harmonic);
            for place in &mut best {
                if held.0 > place.0 {
                    core::mem::swap(place, &mut held);
                }
            }
        }
        best.map(|(_, harmonic)| self.tone(harmonic))
    }

    fn tone(&self, harmonic: u16) -> Tone {
        if harmonic == 0 {
            return Tone::default();
        }
        let gamma = self.coefficient(usize::from(harmonic).saturating_sub(1));
        Tone {
            harmonic,
            amplitude: libm::hypotf(gamma.re, gamma.im),
            phase_rad: libm::atan2f(gamma.im, gamma.re),
        }
    }

    /// The signal predicted with the strongest `order` periods, not limited to any range.
    #[must_use]
    pub fn predict(&self, at: LocalTime, order: usize) -> f32 {
        self.predict_all(at, &self.tones()).get(order.min(ORDER_MAX)).copied().unwrap_or_default()
    }

    /// As a probability: within [ε, 1 − ε].
    #[must_use]
    pub fn predict_probability(&self, at: LocalTime, order: usize) -> f32 {
        self.predict(at, order).clamp(PROBABILITY_MARGIN, 1.0 - PROBABILITY_MARGIN)
    }

    /// The prediction with 0, 1 … [`ORDER_MAX`] of the given periods.
    #[must_use]
    pub fn predict_all(&self, at: LocalTime, tones: &[Tone; ORDER_MAX]) -> [f32; ORDER_MAX + 1] {
        let angle = self.angle(at);
        let mut value = self.mean();
        let mut all = [value; ORDER_MAX + 1];
        for (slot, tone) in all.iter_mut().skip(1).zip(tones) {
            let turn = angle * f64::from(tone.harmonic) + f64::from(tone.phase_rad);
            value += 2.0 * tone.amplitude * nearest_f32_of_f64(libm::cos(turn));
            *slot = value;
        }
        all
    }
}

#[cfg(test)]
#[path = "spectrum_tests.rs"]
mod tests;
