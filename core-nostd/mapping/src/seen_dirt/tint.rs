//! Which colours the places of this floor have, and how strange one of them is.
//!
//! Chips, flakes and grain average out over a decimetre; what is spilled tints it, even if it is of the colour of some
//! chip and no pixel of it is rare. How much clean places differ, and along which colours, is learned from the places
//! themselves: terrazzo varies along the colours of its chips, wood along its brightness. Lamps and shadows wander over
//! the floor while the robot drives, so a place has only the colour that its views agree on.

use super::cell::WINDOW;
use super::map::KNOWN_MIN;
use super::rank::of_rank;
use floorguard_types::number::{nearest_f32, saturating_i8};

/// Steps of a Lab unit in which a cell keeps a colour: lightness varies most.
const STEPS: [f32; 3] = [8.0, 16.0, 16.0];
/// One of so many views may disagree.
const AGREED_PART: usize = WINDOW;
/// Least spread of a channel, Lab units: less than one sees.
const SPREAD_MIN: [f32; 3] = [0.3, 0.1, 0.1];
/// Before any floor was seen the spread is taken as this, Lab units: a guess that only weighs what is learned first.
const SPREAD_FIRST: [f32; 3] = [1.0, 0.3, 0.3];
/// Squared distance, in spreads, from which on a place says little about what is usual: a thirty-fourth of what is
/// normally distributed in three channels lies beyond.
const USUAL_SQUARED: f32 = 9.0;
/// Places from which on older ones count half.
const PLACES_MAX: f32 = 16_384.0;
/// Natural logarithms for each spread of distance: the slope of a normal distribution's logarithm at three spreads, where
/// limits lie.
const STRANGENESS: f32 = 3.0;

/// A colour relative to its surroundings as a cell keeps it.
pub(super) type KeptTint = [i8; 3];

/// The nearest kept colour; far ones are cut, NaN is as the surroundings.
pub(super) fn kept(colour: [f32; 3]) -> KeptTint {
    let mut tint = [0; 3];
    for ((slot, value), steps) in tint.iter_mut().zip(colour).zip(STEPS) {
        *slot = saturating_i8(libm::roundf(value * steps));
    }
    tint
}

/// The middle of some views, channel by channel, Lab units.
pub(super) fn middle(views: &[KeptTint]) -> [f32; 3] {
    let mut middle = [0.0; 3];
    for (channel, (slot, steps)) in middle.iter_mut().zip(STEPS).enumerate() {
        let mut values = [0_i8; WINDOW];
        for (value, view) in values.iter_mut().zip(views) {
            *value = view.get(channel).copied().unwrap_or(0);
        }
        let values = values.get(..views.len()).unwrap_or(&values);
        *slot = f32::from(of_rank(values, values.len() / 2, Ord::cmp).unwrap_or(0)) / steps;
    }
    middle
}

/// How the colours of a floor's places spread: a covariance in which strange places count little.
#[derive(Clone, Debug)]
pub(super) struct FloorTints {
    /// Weighted sums of products of channels: 00, 11, 22, 01, 02, 12.
    products: [f32; 6],
    weight: f32,
    /// The inverse of the covariance, the same six.
    inverse: [f32; 6],
    /// It was learned from as many places as are a floor to compare with.
    is_known: bool,
}

impl FloorTints {
    /// No floor was seen yet.
    pub(super) const NEW: Self = {
        let [l, a, b] = SPREAD_FIRST;
        let inverse = [1.0 / (l * l), 1.0 / (a * a), 1.0 / (b * b), 0.0, 0.0, 0.0];
        Self { products: [0.0; 6], weight: 0.0, inverse, is_known: false }
    };

    /// A floor whose places spread as the first guess says.
    #[cfg(test)]
    pub(super) const AS_GUESSED: Self = Self { is_known: true, ..Self::NEW };

    /// The inverse of the covariance times a colour: the direction in which it differs from the floor.
    fn direction(&self, [l, a, b]: [f32; 3]) -> [f32; 3] {
        let [ll, aa, bb, la, lb, ab] = self.inverse;
        [ll * l + la * a + lb * b, la * l + aa * a + ab * b, lb * l + ab * a + bb * b]
    }

    /// How strange on this floor the colour is that eight of nine views agree on, or all of fewer, natural logarithms:
    /// as far as they go along with the middle one; and how strange the middle one is. 0 before the floor is known: a
    /// cell that is not seen again keeps its state, and a guess would stay dirt for the whole mission.
    pub(super) fn strangeness(&self, views: &[KeptTint]) -> [f32; 2] {
        if !self.is_known {
            return [0.0; 2];
        }
        let middle = middle(views);
        let direction = self.direction(middle);
        let length = libm::sqrtf(dot(middle, direction).max(0.0));
        let mut along = [0.0_f32; WINDOW];
        for (slot, [l, a, b]) in along.iter_mut().zip(views) {
            let [sl, sa, sb] = STEPS;
            let view = [f32::from(*l) / sl, f32::from(*a) / sa, f32::from(*b) / sb];
            *slot = dot(view, direction) / length.max(f32::MIN_POSITIVE);
        }
        let along = along.get(..views.len()).unwrap_or(&along);
        let agreed = of_rank(along, along.len() / AGREED_PART, f32::total_cmp).unwrap_or(0.0).max(0.0);
        [agreed, length].map(|spreads| STRANGENESS * spreads)
    }

    /// Takes the colour of a place.
    pub(super) fn learn(&mut self, colour: [f32; 3]) {
        let weight = 1.0 / (1.0 + dot(colour, self.direction(colour)).max(0.0) / USUAL_SQUARED);
        let [l, a, b] = colour;
        for (sum, product) in self.products.iter_mut().zip([l * l, a * a, b * b, l * a, l * b, a * b]) {
            *sum += weight * product;
        }
        self.weight += weight;
    }

    /// Uses what was learned.
    pub(super) fn settle(&mut self) {
        if self.weight < 1.0 {
            return;
        }
        let [ll, aa, bb, la, lb, ab] = self.products.map(|sum| sum / self.weight);
        let [min_l, min_a, min_b] = SPREAD_MIN.map(|spread| spread * spread);
        let (ll, aa, bb) = (ll + min_l, aa + min_a, bb + min_b);
        let minors = [aa * bb - ab * ab, ll * bb - lb * lb, ll * aa - la * la];
        let others = [lb * ab - la * bb, la * ab - lb * aa, la * lb - ll * ab];
        let ([first, second, third], [fourth, fifth, sixth]) = (minors, others);
        // At least the product of the least spreads but for rounding.
        let determinant = (ll * first + la * fourth + lb * fifth).max(min_l * min_a * min_b);
        self.inverse = [first, second, third, fourth, fifth, sixth].map(|minor| minor / determinant);
        self.is_known |= self.weight >= nearest_f32(KNOWN_MIN);
        if self.weight > PLACES_MAX {
            self.weight *= 0.5;
            self.products = self.products.map(|sum| 0.5 * sum);
        }
    }
}

fn dot([a, b, c]: [f32; 3], [x, y, z]: [f32; 3]) -> f32 {
    a * x + b * y + c * z
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::random::Pcg32;

    /// A floor that varies in brightness, all channels together, like wood: a brighter place is usual, an equally large
    /// step across is strange. A few spills among the places hardly change that.
    #[test]
    fn strangeness_ignores_the_floors_own_variation() {
        let mut random = Pcg32::new(8, 1);
        let mut floor = FloorTints::NEW;
        for place in 0..4_000 {
            let bright = 2.0 * random.normal();
            let [l, a, b] = [0.1, 0.05, 0.05].map(|spread| spread * random.normal());
            let wood = [bright + l, 0.2 * bright + a, 0.5 * bright + b];
            floor.learn(if place % 50 == 0 { [-3.0, 1.0, 6.0] } else { wood });
            if place % 100 == 0 {
                floor.settle();
            }
        }
        let strange = |colour| {
            let [agreed, middle] = floor.strangeness(&[kept(colour); 5]);
            assert!((agreed - middle).abs() < 1e-3 * middle, "the views are all alike: {agreed} {middle}");
            agreed
        };
        let (along, across) = (strange([4.0, 0.8, 2.0]), strange([0.0, 0.0, -2.0]));
        assert!((4.0..8.0).contains(&along), "two spreads: {along}");
        assert!(across > 20.0, "{across}");
        assert!(strange([-3.0, 1.0, 6.0]) > 40.0);
    }

    /// The covariance times its inverse is one.
    #[test]
    fn the_inverse_is_one() {
        let mut floor = FloorTints::NEW;
        for [l, a, b] in [[1.0, 0.2, 0.1], [-0.5, 0.4, 0.3], [0.2, -0.3, 0.6], [0.1, 0.1, -0.8]] {
            floor.learn([l, a, b]);
        }
        floor.settle();
        let square = |[ll, aa, bb, la, lb, ab]: [f32; 6]| [[ll, la, lb], [la, aa, ab], [lb, ab, bb]];
        let mut covariance = square(floor.products.map(|sum| sum / floor.weight));
        (0..3).for_each(|index| covariance[index][index] += SPREAD_MIN[index] * SPREAD_MIN[index]);
        let inverse = square(floor.inverse);
        for (row, left) in covariance.iter().enumerate() {
            for column in 0..3 {
                let sum: f32 = left.iter().zip(&inverse).map(|(value, right)| value * right[column]).sum();
                assert!((sum - f32::from(u8::from(row == column))).abs() < 1e-4, "{row} {column}: {sum}");
            }
        }
    }

    fn assert_strangeness(views: &[KeptTint], expected: [f32; 2]) {
        let found = FloorTints::AS_GUESSED.strangeness(views);
        let far = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(far < 1e-3, "{found:?} and not {expected:?} of {views:?}");
    }

    /// What counts is how far eight of nine go along with the middle view.
    #[test]
    fn views_agree_on_a_side() {
        let mut views = [[0, 0, 16]; 9];
        views[0] = [0, 0, -16];
        let one = STRANGENESS * 1.0 / SPREAD_FIRST[2];
        assert_strangeness(&views, [one, one]);
        views[1] = [0, 0, 8];
        assert_strangeness(&views, [0.5 * one, one]);
        views[2] = [0, 0, -16];
        assert_strangeness(&views, [0.0, one]);
        assert_strangeness(&[], [0.0; 2]);
        assert_eq!(FloorTints::NEW.strangeness(&[[0, 0, 16]; 9]), [0.0; 2], "nobody knows yet");
        assert_eq!(middle(&[[8, -16, 4], [16, -32, -4], [24, -48, 0]]), [2.0, -2.0, 0.0]);
        assert_eq!(kept([f32::NAN, 100.0, -0.5]), [0, 127, -8]);
    }
}
