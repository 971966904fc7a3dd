//! The dirt that the particles carry: only of cells under the brushes, each with a value a particle.
//!
//! A particle that has not touched a cell holds no value for it ("lazily instantiated"): it still believes what the
//! map says. When the brushes of all particles have left a cell, its values fall together into the map again
//! ("emptying", book, Cleaning: Active cells). So memory and time depend on the brush and the doubt, not on the size of
//! the floor.

use super::dirt_model::CellDirt;
use floorguard_mapping::{DirtCell, DirtMap, NO_SLOT};
use floorguard_types::number::{exact_usize, nearest_f32, saturating_u8, truncating_u8};
use floorguard_types::random::Pcg32;

/// Value of a particle that has not touched the cell.
const UNTOUCHED: u8 = u8::MAX;
/// Most dirt that a particle can hold in a cell.
const UNITS_MAX: u32 = 254;
/// Marks a free slot.
const NO_CELL: u32 = u32::MAX;
/// Bits of the mask of a swept cell.
const SAMPLES: f32 = 64.0;
/// Expected dirt below this is not worth a slot: its tail beyond any tolerated amount is nil.
const NEGLIGIBLE_UNITS: f32 = 1e-3;

/// One cell that is held by the particles.
#[derive(Clone, Copy, Debug)]
pub struct ActiveCell<const PARTICLES: usize> {
    cell: u32,
    prior: DirtCell,
    light_units: f32,
    exp_of_minus_light: f32,
    units: [u8; PARTICLES],
    covered: [u64; PARTICLES],
}

impl<const PARTICLES: usize> ActiveCell<PARTICLES> {
    /// A free slot.
    pub const EMPTY: Self = Self {
        cell: NO_CELL,
        prior: DirtCell::CLEAN,
        light_units: 0.0,
        exp_of_minus_light: 1.0,
        units: [UNTOUCHED; PARTICLES],
        covered: [0; PARTICLES],
    };

    fn take(&mut self, cell: u32, prior: DirtCell) {
        self.cell = cell;
        self.prior = prior;
        // Where the belief is a mixture, the light part keeps the mean: λ = tail·heavy + (1 − tail)·light.
        let tail = if prior.heavy_units > 0 { prior.tail_probability() } else { 0.0 };
        let heavy = tail * f32::from(prior.heavy_units);
        let light = (prior.expected_units - heavy) / (1.0 - tail).max(1e-3);
        self.light_units = light.clamp(0.0, 80.0);
        self.exp_of_minus_light = libm::expf(-self.light_units);
        self.units = [UNTOUCHED; PARTICLES];
        self.covered = [0; PARTICLES];
    }

    #[inline]
    fn draw(&self, random: &mut Pcg32) -> u8 {
        let heavy = self.prior.heavy_units;
        if heavy > 0 && random.bernoulli(self.prior.tail_probability()) {
            return truncating_u8(random.poisson(f32::from(heavy)).min(UNITS_MAX));
        }
        truncating_u8(random.poisson_with(self.light_units, self.exp_of_minus_light).min(UNITS_MAX))
    }
}

/// How the particles' values of a cell become the map's belief again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Collapse {
    /// The paper's equation (6): the mean, taken as Poisson. Thins the tail when some particles missed the cell.
    Poisson,
    /// The mean, with the particles' own probability of more than τ beside it; the guarantee uses both.
    #[default]
    Mixture,
}

/// The cells that are held by the particles, in storage `S`.
#[derive(Clone, Debug)]
pub struct ActiveCells<S, const PARTICLES: usize> {
    storage: S,
    /// One past the last slot in use.
    used: usize,
    refused: u32,
}

impl<S: AsMut<[ActiveCell<PARTICLES>]>, const PARTICLES: usize> ActiveCells<S, PARTICLES> {
    /// No cell held. The storage's length is the capacity, at most 65,534 slots.
    #[must_use]
    pub fn new(mut storage: S) -> Self {
        for slot in storage.as_mut() {
            slot.cell = NO_CELL;
        }
        Self { storage, used: 0, refused: 0 }
    }

    /// Number of cells that are held.
    #[must_use]
    pub fn count(&mut self) -> usize {
        self.slots().iter().filter(|slot| slot.cell != NO_CELL).count()
    }

    /// Cells that did not fit, counted. It then keeps its dirt: nothing is claimed for it.
    #[must_use]
    pub const fn refused(&self) -> u32 {
        self.refused
    }

    fn slots(&mut self) -> &mut [ActiveCell<PARTICLES>] {
        let used = self.used;
        self.storage.as_mut().get_mut(..used).unwrap_or(&mut [])
    }

    /// The value of a particle for a cell, drawn from the map's belief at first touch. `None` where there is nothing
    /// to clean, or the list is full.
    #[inline]
    pub fn touch<'s, M: AsRef<[DirtCell]> + AsMut<[DirtCell]>>(
        &'s mut self,
        map: &mut DirtMap<M>,
        cell: usize,
        (particle, random): (usize, &mut Pcg32),
    ) -> Option<TouchedCell<'s>> {
        let belief = map.get_mut(cell)?;
        if belief.slot == NO_SLOT {
            if belief.expected_units < NEGLIGIBLE_UNITS {
                return None;
            }
            belief.slot = self.allocate(cell, *belief)?;
        }
        let slot = self.storage.as_mut().get_mut(usize::from(belief.slot))?;
        if *slot.units.get(particle)? == UNTOUCHED {
            let drawn = slot.draw(random);
            *slot.units.get_mut(particle)? = drawn;
        }
        Some(TouchedCell { units: slot.units.get_mut(particle)?, covered: slot.covered.get_mut(particle)? })
    }

    fn allocate(&mut self, cell: usize, prior: DirtCell) -> Option<u16> {
        let free =
            self.storage.as_mut().iter().take(usize::from(NO_SLOT)).position(|slot| slot.cell == NO_CELL);
        let Some(index) = free else {
            self.refused = self.refused.saturating_add(1);
            return None;
        };
        self.storage.as_mut().get_mut(index)?.take(u32::try_from(cell).ok()?, prior);
        self.used = self.used.max(index.saturating_add(1));
        u16::try_from(index).ok()
    }

    /// Lets every cell that `is_left` fall back into the map, weighted by the particles' `weights` (which sum to 1).
    pub fn empty<M: AsRef<[DirtCell]> + AsMut<[DirtCell]>>(
        &mut self,
        map: &mut DirtMap<M>,
        (weights, tolerated_units): (&[f32; PARTICLES], u8),
        is_left: impl Fn(usize) -> bool,
    ) {
        for slot in self.slots() {
            let cell = exact_usize(slot.cell);
            if slot.cell == NO_CELL || !is_left(cell) {
                continue;
            }
            if let Some(belief) = map.get_mut(cell) {
                *belief = collapse(slot, weights, tolerated_units);
            }
            slot.cell = NO_CELL;
        }
        self.shrink();
    }

    /// Calls `visit(cell, the map's prior, share of the cell that the brush has swept since)` for every cell that is
    /// held; the share is the mean over the particles, within [0, 1].
    pub fn visit(&mut self, weights: &[f32; PARTICLES], mut visit: impl FnMut(usize, &DirtCell, f32)) {
        for slot in self.slots() {
            if slot.cell == NO_CELL {
                continue;
            }
            let swept = |(weight, mask): (&f32, &u64)| weight * nearest_f32(mask.count_ones()) / SAMPLES;
            let share: f32 = weights.iter().zip(&slot.covered).map(swept).sum();
            let prior = DirtCell { slot: NO_SLOT, ..slot.prior };
            visit(exact_usize(slot.cell), &prior, share);
        }
    }

    /// Gives up what was cleaned since the cells became active: they fall back to the map's prior. For a robot
    /// that finds that it was not where it believed to be.
    pub fn distrust<M: AsRef<[DirtCell]> + AsMut<[DirtCell]>>(&mut self, map: &mut DirtMap<M>) {
        for slot in self.slots() {
            if slot.cell == NO_CELL {
                continue;
            }
            if let Some(belief) = map.get_mut(exact_usize(slot.cell)) {
                *belief = DirtCell { slot: NO_SLOT, ..slot.prior };
            }
            slot.cell = NO_CELL;
        }
        self.shrink();
    }

    fn shrink(&mut self) {
        let last = self.slots().iter().rposition(|slot| slot.cell != NO_CELL);
        self.used = last.map_or(0, |index| index.saturating_add(1));
    }

    /// After resampling: particle k continues with the values of `parents[k]`.
    pub fn inherit(&mut self, parents: &[u16; PARTICLES]) {
        for slot in self.slots() {
            if slot.cell == NO_CELL {
                continue;
            }
            let (units, covered) = (slot.units, slot.covered);
            for ((value, mask), &parent) in slot.units.iter_mut().zip(&mut slot.covered).zip(parents) {
                *value = units.get(usize::from(parent)).copied().unwrap_or(UNTOUCHED);
                *mask = covered.get(usize::from(parent)).copied().unwrap_or(0);
            }
        }
    }
}

fn collapse<const PARTICLES: usize>(
    slot: &ActiveCell<PARTICLES>,
    weights: &[f32; PARTICLES],
    tolerated_units: u8,
) -> DirtCell {
    let prior = &slot.prior;
    let (mut mean, mut tail, mut heavy) = (0.0, 0.0, 0.0);
    let prior_tail = prior.tail_probability();
    let prior_heavy = if prior.heavy_units > 0 {
        f32::from(prior.heavy_units)
    } else {
        prior.expected_units.max(f32::from(tolerated_units) + 1.0)
    };
    for (&weight, &units) in weights.iter().zip(&slot.units) {
        if units == UNTOUCHED {
            mean += weight * prior.expected_units;
            tail += weight * prior_tail;
            heavy += weight * prior_tail * prior_heavy;
        } else {
            mean += weight * f32::from(units);
            if units > tolerated_units {
                tail += weight;
                heavy += weight * f32::from(units);
            }
        }
    }
    let heavy_units = if tail > 1e-6 { saturating_u8((heavy / tail + 0.5).clamp(1.0, 254.0)) } else { 0 };
    DirtCell { expected_units: mean, tail: DirtCell::encode_tail(tail), slot: NO_SLOT, heavy_units }
}

/// A particle's own dirt of one cell.
pub struct TouchedCell<'a> {
    units: &'a mut u8,
    covered: &'a mut u64,
}

impl TouchedCell<'_> {
    /// The value.
    #[inline]
    #[must_use]
    pub fn get(&self) -> CellDirt {
        CellDirt { units: *self.units, covered: *self.covered }
    }

    /// Writes the value back.
    #[inline]
    pub fn set(self, dirt: CellDirt) {
        *self.units = dirt.units.min(truncating_u8(UNITS_MAX));
        *self.covered = dirt.covered;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_mapping::{Grid, GridGeometry};
    use floorguard_types::geometry::Point2;
    use std::vec;
    use std::vec::Vec;

    fn map(cell: DirtCell) -> DirtMap<Vec<DirtCell>> {
        Grid::new(GridGeometry::new(2, 2, 0.1, Point2::default()).unwrap(), vec![cell; 4]).unwrap()
    }

    #[test]
    fn the_emptying_estimator_mixes_values_and_the_map() {
        let mut map = map(DirtCell::poisson(8.0, 0.8));
        let mut cells = ActiveCells::<_, 4>::new(vec![ActiveCell::EMPTY; 2]);
        let mut random = Pcg32::new(1, 1);
        for (particle, units) in [(0, 2), (1, 20)] {
            let touched = cells.touch(&mut map, 1, (particle, &mut random)).unwrap();
            touched.set(CellDirt { units, covered: 0 });
        }
        cells.empty(&mut map, (&[0.4, 0.1, 0.25, 0.25], 5), |_| true);
        let cell = map.get(1).unwrap();
        // 0.4·2 + 0.1·20 + 0.5·8, and 0.1 + 0.5·0.8.
        assert!((cell.expected_units - 6.8).abs() < 1e-5);
        assert!((cell.tail_probability() - 0.5).abs() < 1e-4);
        assert_eq!(cell.slot, NO_SLOT);
        assert_eq!(cells.count(), 0);
    }

    #[test]
    fn a_mixture_keeps_its_mean_when_drawn_again() {
        let belief = DirtCell {
            expected_units: 2.9,
            tail: DirtCell::encode_tail(0.1),
            slot: NO_SLOT,
            heavy_units: 20,
        };
        let mut map = map(belief);
        let mut cells = ActiveCells::<_, 1>::new(vec![ActiveCell::EMPTY; 1]);
        let mut random = Pcg32::new(2, 1);
        let (mut sum, mut heavy) = (0_u32, 0_u32);
        for _ in 0..20_000 {
            let value = cells.touch(&mut map, 0, (0, &mut random)).unwrap().get();
            sum += u32::from(value.units);
            heavy += u32::from(value.units > 5);
            cells.distrust(&mut map);
        }
        assert!((sum as f32 / 20_000.0 - 2.9).abs() < 0.15);
        assert!((heavy as f32 / 20_000.0 - 0.1).abs() < 0.01);
    }

    #[test]
    fn swept_share_is_computed() {
        let mut map = map(DirtCell::poisson(8.0, 0.8));
        let mut cells = ActiveCells::<_, 2>::new(vec![ActiveCell::EMPTY; 2]);
        let mut random = Pcg32::new(1, 1);
        let touched = cells.touch(&mut map, 3, (0, &mut random)).unwrap();
        touched.set(CellDirt { units: 3, covered: u64::MAX >> 16 });
        let mut seen = Vec::new();
        cells.visit(&[0.8, 0.2], |cell, prior, share| seen.push((cell, prior.expected_units, share)));
        assert_eq!(seen.len(), 1);
        assert_eq!((seen[0].0, seen[0].1), (3, 8.0));
        assert!((seen[0].2 - 0.6).abs() < 1e-6);
    }

    #[test]
    fn full_table_gives_no_credit() {
        let mut map = map(DirtCell::poisson(8.0, 0.8));
        let mut cells = ActiveCells::<_, 1>::new(vec![ActiveCell::EMPTY; 1]);
        let mut random = Pcg32::new(2, 1);
        assert!(cells.touch(&mut map, 0, (0, &mut random)).is_some());
        assert!(cells.touch(&mut map, 1, (0, &mut random)).is_none());
        assert_eq!(cells.refused(), 1);
        assert_eq!(map.get(1).unwrap().expected_units, 8.0);
        cells.distrust(&mut map);
        assert_eq!(map.get(0).unwrap().expected_units, 8.0);
    }
}
