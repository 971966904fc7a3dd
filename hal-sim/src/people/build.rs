//! What makes a person different from others of the same kind: stature, breadth, and what the clothes throw back.
//!
//! Without it all adults are one and the same for a lidar. Everything is drawn from the person's own seed, so that the
//! paths of a crowd do not depend on it.

use floorguard_types::random::Pcg32;
use serde::{Deserialize, Serialize};

use super::PersonKind;

/// Which bodies the people of a scenario have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Bodies {
    /// All of a kind are the same.
    #[default]
    Same,
    /// Everybody has a body and clothes of their own.
    Varied,
}

/// How a person differs from the kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Build {
    /// Height as a share of the kind's.
    pub stature: f32,
    /// Breadth of body and limbs as a share of what goes with the kind.
    pub breadth: f32,
    /// What the clothes throw back; `None`: [`PLAIN`], everywhere.
    pub clothes: Option<Clothes>,
}

/// Reflectivity of people without clothes of their own, on the VLP-16's scale.
pub const PLAIN: u8 = 35;

impl Build {
    /// As the kind says.
    pub const SAME: Self = Self { stature: 1.0, breadth: 1.0, clothes: None };

    /// Somebody of a kind. Adults: barefoot stature and breadth over the shoulders of women and men of ANSUR II
    /// (Gordon et al. 2014, survey of U.S. Army personnel, NATICK/TR-15/007, mean and standard
    /// deviation, rounded to centimetres) in shoes of 2.5 cm; half of them women. Children are 4 to 10 years old: about
    /// 1.03 m and 6 cm for each further year, ± 5 cm.
    #[must_use]
    pub fn drawn(kind: PersonKind, random: &mut Pcg32) -> Self {
        let (tall, broad, years) = (random.normal(), random.normal(), random.uniform_between(0.0, 6.0));
        let ([stature_m, stature_sigma_m], [breadth_m, breadth_sigma_m]) = if random.bernoulli(0.5) {
            ([1.63, 0.064], [0.45, 0.030])
        } else {
            ([1.76, 0.069], [0.51, 0.033])
        };
        let clothes = Some(Clothes::drawn(random));
        if kind == PersonKind::Child {
            let height_m = 1.03 + 0.06 * years + 0.05 * tall.clamp(-2.5, 2.5);
            return Self { stature: height_m / kind.height_m(), breadth: 1.0 + 0.07 * broad, clothes };
        }
        // The bodies of this simulator are made for the mean of both sexes.
        let stature = (stature_m + 0.025 + stature_sigma_m * tall.clamp(-2.5, 2.5)) / 1.75;
        let breadth = (breadth_m + breadth_sigma_m * broad.clamp(-2.5, 2.5)) / 0.48;
        Self { stature, breadth, clothes }
    }
}

/// What a laser meets on a person: two garments, their folds, and the side that is seen.
///
/// No published distribution for 905 nm was found. The spread is an assumption guided by two real VLP-16 frames of one
/// man (ACFR): single returns of one garment differ by more than half of their mean, and the same garment's mean by a
/// factor of two from pose to pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clothes {
    /// Reflectivity of trousers and top, on the VLP-16's scale.
    pub garments: [f32; 2],
    /// Picks the pattern of the folds and the brighter side.
    pub pattern: u32,
}

/// Median of a garment's reflectivity, and the spread of its logarithm between garments.
const GARMENT: (f32, f32) = (22.0, 0.8);
/// Spread of the logarithm from patch to patch, and between the brighter side and the mean.
const FOLDS: f32 = 0.5;
const SIDES: f32 = 0.35;
/// Patches: 5 cm high, 24 around the body.
const PATCH_M: f32 = 0.05;
const PATCHES_AROUND: f32 = 24.0;
/// Hair and skin, and what people push and pull.
const HEAD: u8 = 40;
const OBJECT: u8 = 45;

impl Clothes {
    fn drawn(random: &mut Pcg32) -> Self {
        let garment =
            |random: &mut Pcg32| (GARMENT.0 * libm::expf(GARMENT.1 * random.normal())).clamp(2.0, 90.0);
        Self { garments: [garment(random), garment(random)], pattern: random.next_u32() }
    }

    /// Reflectivity where a beam meets a part of the body (in the order in which bodies are built), at a height, at an
    /// angle around the body from where the person looks.
    #[must_use]
    pub fn reflectivity(&self, part: usize, height_m: f32, around_rad: f32) -> u8 {
        let [trousers, top] = self.garments;
        let garment = match part {
            0 | 1 => trousers,
            2 | 3 => top,
            4 => return HEAD,
            _ => return OBJECT,
        };
        let brighter_rad = self.pattern as f32 / u32::MAX as f32 * core::f32::consts::TAU;
        let turn = (around_rad / core::f32::consts::TAU).rem_euclid(1.0);
        let patch = (height_m / PATCH_M) as u64 * 64 + (turn * PATCHES_AROUND) as u64;
        let folds = FOLDS * Pcg32::new(u64::from(self.pattern), 64 * 4_096 * part as u64 + patch).normal();
        let side = SIDES * core::f32::consts::SQRT_2 * libm::cosf(around_rad - brighter_rad);
        (garment * libm::expf(folds + side)).clamp(1.0, 100.0) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and standard deviation.
    fn spread(values: &[f32]) -> (f32, f32) {
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        let squares = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f32>();
        (mean, (squares / values.len() as f32).sqrt())
    }

    #[test]
    fn adults_are_as_tall_as_people() {
        let mut random = Pcg32::new(3, 1);
        let statures: Vec<f32> =
            (0..4_000).map(|_| 1.75 * Build::drawn(PersonKind::Adult, &mut random).stature).collect();
        let (mean_m, sigma_m) = spread(&statures);
        assert!((mean_m - 1.72).abs() < 0.01, "{mean_m}");
        // Two sexes 13 cm apart, 6.5 cm each.
        assert!((sigma_m - 0.093).abs() < 0.01, "{sigma_m}");
        assert!(statures.iter().all(|height_m| (1.4..2.0).contains(height_m)));
    }

    /// A person is not the same from all sides, but more like itself than like others.
    #[test]
    fn garments_differ_more_than_their_sides() {
        let mut random = Pcg32::new(5, 1);
        let (mut means, mut own) = (Vec::new(), Vec::new());
        for _ in 0..300 {
            let clothes = Clothes::drawn(&mut random);
            let view = |from_rad: f32| {
                let patches = (0..100).map(|at| {
                    let (height_m, aside) = (1.0 + 0.04 * (at / 10) as f32, 0.2 * (at % 10) as f32 - 1.0);
                    f32::from(clothes.reflectivity(2, height_m, from_rad + aside))
                });
                (patches.sum::<f32>() / 100.0).ln()
            };
            let views = [0.0, 1.5, 3.0, 4.5].map(view);
            means.push(spread(&views).0);
            own.push(spread(&views).1);
        }
        let (between, within) = (spread(&means).1, spread(&own).0);
        assert!((0.6..0.9).contains(&between) && (0.2..0.5).contains(&within), "{between} {within}");
    }
}
