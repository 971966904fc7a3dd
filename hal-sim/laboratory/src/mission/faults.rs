//! What goes wrong in a mission, seeded: wheels that slip, pushes, packets that are lost, power that fails.

use floorguard_types::random::Pcg32;

/// Fault rates, events a minute.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaultRates {
    /// Slip for one second, with 30 % of the travel lost or more.
    pub slips: f32,
    /// Pushes by about 0.1 m and 6°.
    pub jumps: f32,
    /// Outages of scan and dirt packets for one to three seconds.
    pub outages: f32,
    /// Power cuts: the belief in memory is lost, the stored one is loaded.
    pub resets: f32,
}

impl FaultRates {
    /// Something goes wrong about every twenty seconds.
    pub const ROUGH: Self = Self { slips: 1.5, jumps: 0.5, outages: 0.75, resets: 0.25 };

    /// The rough rates of some kinds only.
    #[must_use]
    pub fn of(kinds: &[FaultKind]) -> Self {
        let rate = |kind, rate: f32| {
            let is_asked = kinds.iter().any(|&k| k == kind || k == FaultKind::All);
            if is_asked { rate } else { 0.0 }
        };
        Self {
            slips: rate(FaultKind::Slip, Self::ROUGH.slips),
            jumps: rate(FaultKind::Jump, Self::ROUGH.jumps),
            outages: rate(FaultKind::Loss, Self::ROUGH.outages),
            resets: rate(FaultKind::Reset, Self::ROUGH.resets),
        }
    }

    /// Nothing goes wrong.
    pub fn are_zero(&self) -> bool {
        *self == Self::default()
    }
}

/// What can go wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum FaultKind {
    /// All of it.
    All,
    /// Wheels slip.
    Slip,
    /// The robot is pushed.
    Jump,
    /// Packets of scanner and dirt sensor are lost.
    Loss,
    /// Power is cut.
    Reset,
}

/// What goes wrong at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaultStep {
    /// Share of the motion that is real.
    pub grip: f32,
    /// The robot is pushed now.
    pub jumps: bool,
    /// No packets arrive.
    pub is_silent: bool,
    /// Power fails now.
    pub resets: bool,
}

/// Draws faults over time.
pub struct Faults {
    rates: FaultRates,
    random: Pcg32,
    slip_left_s: f32,
    grip: f32,
    silence_left_s: f32,
    /// Faults so far.
    pub count: u32,
}

impl Faults {
    /// Faults with these rates.
    pub fn new(rates: FaultRates, random: Pcg32) -> Self {
        Self { rates, random, slip_left_s: 0.0, grip: 1.0, silence_left_s: 0.0, count: 0 }
    }

    /// The next step of `period_s`.
    pub fn step(&mut self, period_s: f32) -> FaultStep {
        if self.rates.are_zero() {
            return FaultStep { grip: 1.0, ..FaultStep::default() };
        }
        self.slip_left_s -= period_s;
        self.silence_left_s -= period_s;
        let per_step = period_s / 60.0;
        let mut happens = |rate: f32| self.random.bernoulli(rate * per_step);
        let (slips, jumps, outage, resets) = (
            happens(self.rates.slips),
            happens(self.rates.jumps),
            happens(self.rates.outages),
            happens(self.rates.resets),
        );
        if slips {
            self.slip_left_s = 1.0;
            self.grip = self.random.uniform_between(0.0, 0.7);
        }
        if outage {
            self.silence_left_s = self.random.uniform_between(1.0, 3.0);
        }
        self.count += [slips, jumps, outage, resets].iter().filter(|&&f| f).count() as u32;
        FaultStep {
            grip: if self.slip_left_s > 0.0 { self.grip } else { 1.0 },
            jumps,
            is_silent: self.silence_left_s > 0.0,
            resets,
        }
    }
}
