//! Appearance of a person to a lidar: brightness of trousers and top, and stature. In a crowd that identifies who
//! reappears.
//!
//! Every trait has a value and a variance; a pair of track and detection gets the logarithm of the ratio of two
//! likelihoods: of the same person seen again, and of a random person. Only traits that both sides know take part. A
//! profile that keeps no reflectivities has no trait, and none takes memory or time.

use floorguard_types::profile::{Entry, Keep, Native, Of, Profile, Table};

/// Traits: brightness of trousers and of top (logarithms of the mean reflectivity), stature in metres.
type Traits<P> = <<P as Profile>::Reflectivity as Keep>::Table<Trait, Of<3>>;

/// What is known of one trait.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Trait {
    value: f32,
    /// Above [`UNKNOWN_VARIANCE`] nothing is known.
    variance: f32,
}

impl Entry for Trait {
    const BLANK: Self = Self { value: 0.0, variance: f32::INFINITY };
}

const UNKNOWN_VARIANCE: f32 = 1.0e3;

/// How a trait is spread.
struct Spread {
    /// Over all people: mean and variance.
    people: (f32, f32),
    /// What the same person changes by from side to side, at most, and how fast: variance, and variance per second.
    own: (f32, f32),
}

/// Brightness: clothes from nearly black to white; the same garment's mean changes by a factor of about 1.4 (two by two
/// real frames of one man) from side to side. Stature: women, men and children (ANSUR II); heads nod, people bend, and of
/// somebody who keeps the same distance always the same ring meets the head (of 1,108 people who came out of sight in
/// simulated crowds half were within 8 cm of what was known of them, one in ten was more than 20 cm off).
const SPREADS: [Spread; 3] = [
    Spread { people: (3.1, 0.70), own: (0.12, 0.002) },
    Spread { people: (3.1, 0.70), own: (0.12, 0.002) },
    Spread { people: (1.70, 0.02), own: (0.015, 0.000_05) },
];

/// One trait never says more than this for or against a pair, natural logarithm.
const TRAIT_MAX: f32 = 5.0;
/// Share of the observations that are, in part, of another person: who touches others, and who is half
/// hidden.
const MISTAKEN: f32 = 0.03;
/// Nor do all together.
const TOGETHER_MAX: f32 = 6.0;

/// The appearance of a person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AppearanceOf<P: Profile> {
    traits: Traits<P>,
}

/// An appearance in the memory of the target.
pub type Appearance = AppearanceOf<Native>;

impl<P: Profile> AppearanceOf<P> {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self { traits: Entry::BLANK };

    /// ln of how much more likely a sighting is if it is of this person than if it is of anybody; 0 where nothing is
    /// known.
    pub(crate) fn likeness(&self, seen: &Self) -> f32 {
        let pairs = self.traits.iter().zip(seen.traits.iter()).zip(&SPREADS);
        let sum: f32 = pairs.map(|((own, seen), spread)| own.likeness(seen, spread)).sum();
        sum.clamp(-TOGETHER_MAX, TOGETHER_MAX)
    }

    /// Takes in a sighting, `seconds` after the one before.
    pub(crate) fn learn(&mut self, seen: &Self, seconds: f32) {
        for ((own, seen), spread) in self.traits.iter_mut().zip(seen.traits.iter()).zip(&SPREADS) {
            own.learn(seen, (spread, seconds));
        }
    }
}

impl Trait {
    fn is_known(&self) -> bool {
        self.variance < UNKNOWN_VARIANCE
    }

    fn likeness(&self, seen: &Self, spread: &Spread) -> f32 {
        if !self.is_known() || !seen.is_known() {
            return 0.0;
        }
        let (mean, between) = spread.people;
        let (same, anybody) = (self.variance + spread.own.0 + seen.variance, between + seen.variance);
        let (apart, unusual) = (seen.value - self.value, seen.value - mean);
        let gain = libm::logf(anybody / same) + unusual * unusual / anybody - apart * apart / same;
        let ratio = libm::expf((0.5 * gain).clamp(-TRAIT_MAX, TRAIT_MAX));
        libm::logf(MISTAKEN + (1.0 - MISTAKEN) * ratio)
    }

    fn learn(&mut self, seen: &Self, (spread, seconds): (&Spread, f32)) {
        if !seen.is_known() {
            return;
        }
        if !self.is_known() {
            *self = *seen;
            return;
        }
        let (most, per_s) = spread.own;
        let before = (self.variance + per_s * seconds.max(0.0)).min(most.max(self.variance));
        let gain = before / (before + seen.variance);
        self.value += gain * (seen.value - self.value);
        self.variance = (1.0 - gain) * before;
    }
}

pub(crate) use gathered::Shades;

/// The returns of a candidate on their way to an appearance.
mod gathered {
    use super::{AppearanceOf, Trait};
    use floorguard_types::number::nearest_f32;
    use floorguard_types::profile::{Entry, Keep, Of, Profile, Table};

    /// Index of the stature among the traits; before it are the garments.
    const STATURE: usize = 2;
    /// Trousers and top, metres above the floor: what is between may be either.
    const BANDS_M: [(f32, f32); 2] = [(0.12, 0.60), (0.95, 1.40)];
    /// Fewer returns say nothing of a garment.
    const RETURNS_MIN: u32 = 5;
    /// Variance of the logarithm from return to return (folds), and of a whole look.
    const FOLDS: f32 = 0.5;
    const POLL_PERIOD: f32 = 0.04;
    /// Angle from ring to ring, radians (VLP-16), and the highest one.
    const RING_STEP: f32 = 0.035;
    const RING_TOP: f32 = 0.268;
    /// How much more doubtful is what is half hidden, or shared with somebody: some of its returns are not its own.
    const OCCLUDED: f32 = 2.0;
    /// A look at a head, metres: hair, hats, steps.
    const HEAD_SIGMA_M: f32 = 0.04;

    /// Returns of a garment.
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Garment {
        sum: u32,
        returns: u32,
    }

    impl Entry for Garment {
        const BLANK: Self = Self { sum: 0, returns: 0 };
    }

    /// Sums over the returns of a candidate.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub(crate) struct Shades<P: Profile> {
        garments: <P::Reflectivity as Keep>::Table<Garment, Of<2>>,
    }

    impl<P: Profile> Shades<P> {
        pub(crate) const NEW: Self = Self { garments: Entry::BLANK };

        /// A return at a height above the floor.
        pub(crate) fn add(&mut self, height_m: f32, reflectivity: Option<&u8>) {
            let band = BANDS_M.iter().position(|(low_m, high_m)| (*low_m..*high_m).contains(&height_m));
            let (Some(band), Some(reflectivity)) = (band, reflectivity) else { return };
            if let Some(garment) = self.garments.get_mut(band) {
                garment.sum = garment.sum.saturating_add(u32::from(*reflectivity));
                garment.returns = garment.returns.saturating_add(1);
            }
        }

        /// What they tell; the top of the candidate, how high the sensor is and how far from it the candidate.
        pub(crate) fn appearance(
            &self,
            (top_m, occluded): (f32, bool),
            (sensor_m, distance_m): (f32, f32),
        ) -> AppearanceOf<P> {
            let mut appearance = AppearanceOf::<P>::UNKNOWN;
            let doubt = if occluded { OCCLUDED } else { 1.0 };
            for (slot, Garment { sum, returns }) in
                appearance.traits.iter_mut().zip(self.garments.iter().copied())
            {
                // A recording without reflectivities has zeros.
                if returns >= RETURNS_MIN && sum >= returns {
                    let value = libm::logf(nearest_f32(sum) / nearest_f32(returns));
                    *slot = Trait { value, variance: doubt * (POLL_PERIOD + FOLDS / nearest_f32(returns)) };
                }
            }
            // The head ends somewhere between the highest ring that met it and the next.
            let spacing_m = RING_STEP * distance_m;
            if let Some(stature) = appearance.traits.get_mut(STATURE)
                && top_m + spacing_m < sensor_m + RING_TOP * distance_m
            {
                let variance = doubt * HEAD_SIGMA_M * HEAD_SIGMA_M + doubt * spacing_m * spacing_m / 12.0;
                *stature = Trait { value: top_m + 0.5 * spacing_m, variance };
            }
            appearance
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Somebody 5 m away whose trousers and top throw back so much, seen by 40 returns each.
    fn appearance([trousers, top]: [u8; 2], stature_m: f32) -> Appearance {
        let mut shades = Shades::NEW;
        for _ in 0..40 {
            shades.add(0.4, Some(&trousers));
            shades.add(1.2, Some(&top));
        }
        shades.appearance((stature_m, false), (0.8, 5.0))
    }

    fn known(observed: &[Appearance]) -> Appearance {
        let mut known = Appearance::UNKNOWN;
        observed.iter().for_each(|appearance| known.learn(appearance, 0.1));
        known
    }

    #[test]
    fn people_are_like_themselves_and_unlike_others() {
        let dark = known(&[appearance([8, 10], 1.7); 10]);
        assert!(dark.likeness(&appearance([9, 11], 1.72)) > 1.0);
        assert!(dark.likeness(&appearance([9, 60], 1.72)) < -1.0, "another top");
        assert!(dark.likeness(&appearance([8, 10], 1.1)) < 0.0, "a child");
    }

    #[test]
    fn one_bad_observation_keeps_the_identity() {
        let dark = known(&[appearance([8, 10], 1.7); 10]);
        let [same, bent, other] = [([8, 10], 1.7), ([8, 10], 1.55), ([8, 100], 1.7)]
            .map(|(garments, stature_m)| dark.likeness(&appearance(garments, stature_m)));
        assert!(bent > same - 1.2, "{bent}, {same}");
        assert!(other < -1.0 && other > same - 5.0, "half of it is somebody else's: {other}, {same}");
    }

    #[test]
    fn unknown_traits_add_no_evidence() {
        let dark = known(&[appearance([8, 10], 1.7); 10]);
        assert_eq!(dark.likeness(&Appearance::UNKNOWN), 0.0);
        assert_eq!(Appearance::UNKNOWN.likeness(&dark), 0.0);
        let mut same = dark;
        same.learn(&Appearance::UNKNOWN, 1.0);
        assert_eq!(same, dark);
        // Reflectivities of a recording that has none, and a head above the view.
        let mut blind = Shades::NEW;
        (0..100).for_each(|_| blind.add(1.2, Some(&0)));
        assert_eq!(blind.appearance((1.7, false), (0.8, 1.5)), Appearance::UNKNOWN);
    }

    #[test]
    fn appearance_alone_decides_no_pair() {
        let bright = known(&[appearance([100, 100], 1.9); 50]);
        let likeness = bright.likeness(&appearance([1, 1], 1.0));
        assert!((-TOGETHER_MAX..-3.0).contains(&likeness), "{likeness}");
        assert!(bright.likeness(&appearance([100, 100], 1.9)) <= TOGETHER_MAX);
    }
}
