//! What the brush removes and what the dirt sensor says about it.

use floorguard_types::number::{nearest_f32, truncating_u8};
use floorguard_types::random::Pcg32;

/// How a step of the brush acts on a cell (book, Cleaning: Passes).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ActuatorModel {
    /// Equation (3) of the paper at every update: n = P·d. The assumed cleaning depends on the rate of the filter,
    /// always towards less of it.
    PaperStep,
    /// Newly covered ground of the present pass only, so that a full pass removes exactly p whatever the step size.
    #[default]
    PassCoverage,
}

/// What the dirt sensor is expected to count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirtSensorModel {
    /// Hits for every removed unit, κ.
    pub gain: f32,
    /// Hits an update without any dirt, ν > 0. Without it one false hit would kill every particle.
    pub false_hits: f32,
}

impl Default for DirtSensorModel {
    fn default() -> Self {
        Self { gain: 1.0, false_hits: 0.02 }
    }
}

impl DirtSensorModel {
    /// z·ln μ − μ with μ = κ·removed + ν; ln z! is the same for all particles and left out.
    #[inline]
    #[must_use]
    pub fn log_likelihood(&self, hits: u32, removed_units: u32) -> f32 {
        let mean = self.gain * nearest_f32(removed_units) + self.false_hits.max(1e-4);
        nearest_f32(hits) * libm::logf(mean) - mean
    }
}

/// Dirt of one cell in one particle, with the sub-samples covered in the present pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellDirt {
    /// Units in the cell.
    pub units: u8,
    /// Sub-samples swept in the present pass.
    pub covered: u64,
}

/// The brush sweeps `swept` sub-samples of a cell. Returns the units removed and updates the cell.
///
/// ```
/// use floorguard_cleaning::{ActuatorModel, CellDirt, sweep_cell};
/// use floorguard_types::random::Pcg32;
///
/// // A brush that takes everything, over the whole cell, twice: the second time there is nothing left.
/// let mut cell = CellDirt { units: 10, covered: 0 };
/// let model = (ActuatorModel::PassCoverage, 1.0);
/// let mut random = Pcg32::new(1, 1);
/// assert_eq!(sweep_cell(&mut cell, u64::MAX, model, &mut random), 10);
/// assert_eq!((sweep_cell(&mut cell, u64::MAX, model, &mut random), cell.units), (0, 0));
/// ```
#[inline]
pub fn sweep_cell(
    cell: &mut CellDirt,
    swept: u64,
    (model, pickup_probability): (ActuatorModel, f32),
    random: &mut Pcg32,
) -> u8 {
    const SHARE: f32 = 1.0 / 64.0;
    let before = nearest_f32(cell.covered.count_ones()) * SHARE;
    let fresh = swept & !cell.covered;
    cell.covered |= swept;
    let units = f32::from(cell.units);
    let met = match model {
        ActuatorModel::PaperStep => units * nearest_f32(swept.count_ones()) * SHARE,
        // 1 − p·C ≥ 1 − p; the floor only matters for p = 1 on ground that is covered already.
        ActuatorModel::PassCoverage => {
            units * nearest_f32(fresh.count_ones()) * SHARE / (1.0 - pickup_probability * before).max(1e-3)
        }
    };
    if met <= 0.0 {
        return 0;
    }
    let met = truncating_u8(random.round_randomly(met).min(u32::from(cell.units)));
    let removed = random.binomial(met, pickup_probability);
    cell.units = cell.units.saturating_sub(removed);
    removed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean share left after one pass over ten units, crossed in `parts` equal steps.
    fn left_after_pass(model: ActuatorModel, parts: u32) -> f32 {
        let mut random = Pcg32::new(9, u64::from(parts));
        let mut left = 0_u32;
        for _ in 0..20_000 {
            let mut cell = CellDirt { units: 10, covered: 0 };
            for part in 0..parts {
                let width = 64 / parts;
                let swept = if width == 64 { u64::MAX } else { ((1_u64 << width) - 1) << (part * width) };
                sweep_cell(&mut cell, swept, (model, 0.9), &mut random);
            }
            left += u32::from(cell.units);
        }
        left as f32 / 200_000.0
    }

    /// The table of the book, Cleaning: Passes: 1−(1−p/N)^N for the printed equation, exactly p for pass coverage.
    #[test]
    fn pass_coverage_does_not_depend_on_the_step() {
        for (parts, paper) in [(1, 0.9), (2, 0.697_5), (4, 0.639_8), (16, 0.604_3)] {
            let printed = 1.0 - left_after_pass(ActuatorModel::PaperStep, parts);
            assert!((printed - paper).abs() < 0.005, "{parts}: {printed}");
            let ours = 1.0 - left_after_pass(ActuatorModel::PassCoverage, parts);
            assert!((ours - 0.9).abs() < 0.012, "{parts}: {ours}");
        }
    }

    #[test]
    fn covered_ground_gives_no_second_credit() {
        let mut random = Pcg32::new(9, 0);
        let mut cell = CellDirt { units: 200, covered: u64::MAX };
        assert_eq!(sweep_cell(&mut cell, u64::MAX, (ActuatorModel::PassCoverage, 1.0), &mut random), 0);
        assert_eq!(cell.units, 200);
    }

    #[test]
    fn one_false_hit_removes_no_particle() {
        let sensor = DirtSensorModel::default();
        assert!(sensor.log_likelihood(1, 0).is_finite());
        assert!(sensor.log_likelihood(5, 5) > sensor.log_likelihood(5, 0));
        assert!(sensor.log_likelihood(0, 0) > sensor.log_likelihood(0, 5));
    }
}
