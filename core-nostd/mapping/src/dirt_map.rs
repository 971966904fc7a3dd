//! How much dirt is expected where, and how surely.

use super::grid::Grid;
use floorguard_types::number::saturating_u16;

/// `DirtCell::slot` of a cell that the particle filter does not hold at the moment.
pub const NO_SLOT: u16 = u16::MAX;

/// What is believed of one cell. Dirt is counted in units of one sensor hit (book, Cleaning: Dirt model).
///
/// ```
/// use floorguard_mapping::DirtCell;
///
/// let cell = DirtCell::poisson(2.0, 0.017);
/// // A claim never gains from the encoding.
/// assert!(cell.tail_probability() >= 0.017 && cell.tail_probability() < 0.017_02);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirtCell {
    /// Mean of the dirt in the cell, λ, units ≥ 0.
    pub expected_units: f32,
    /// Probability that more than the tolerated units lie here, in 1/65,535, rounded up.
    pub tail: u16,
    /// Where the particle filter keeps this cell, or [`NO_SLOT`].
    pub slot: u16,
    /// Mean of the dirt given that more than the tolerated units lie here; 0 while the cell is plainly Poisson.
    pub heavy_units: u8,
}

impl DirtCell {
    /// A cell without dirt.
    pub const CLEAN: Self = Self { expected_units: 0.0, tail: 0, slot: NO_SLOT, heavy_units: 0 };

    /// A cell whose dirt is Poisson with this mean; `tail` is the probability of more than the tolerated units.
    #[must_use]
    pub fn poisson(expected_units: f32, tail: f32) -> Self {
        let expected_units = if expected_units.is_finite() { expected_units.max(0.0) } else { 0.0 };
        Self { expected_units, tail: Self::encode_tail(tail), slot: NO_SLOT, heavy_units: 0 }
    }

    /// Probability that more than the tolerated units lie here.
    #[must_use]
    pub fn tail_probability(&self) -> f32 {
        f32::from(self.tail) * (1.0 / 65_535.0)
    }

    /// Rounds up: a claim must never gain from the encoding. A probability that is not a number counts as 1.
    #[must_use]
    pub fn encode_tail(probability: f32) -> u16 {
        if probability.is_nan() {
            return u16::MAX;
        }
        saturating_u16(libm::ceilf(probability.clamp(0.0, 1.0) * 65_535.0))
    }
}

impl Default for DirtCell {
    fn default() -> Self {
        Self::CLEAN
    }
}

/// A belief about dirt for every cell, 0.10 m a side in the published work.
pub type DirtMap<S> = Grid<DirtCell, S>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_are_rounded_up() {
        assert_eq!(DirtCell::encode_tail(0.0), 0);
        assert_eq!(DirtCell::encode_tail(1e-9), 1);
        assert_eq!(DirtCell::encode_tail(1.0), u16::MAX);
        assert_eq!(DirtCell::encode_tail(f32::NAN), u16::MAX);
        assert!(DirtCell::poisson(3.0, 0.01).tail_probability() >= 0.01);
        assert_eq!(DirtCell::poisson(f32::NAN, 0.0).expected_units, 0.0);
    }
}
