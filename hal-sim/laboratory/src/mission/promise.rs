//! What the mission promises, and when a cell is clean enough for it at this moment.

use floorguard_cleaning::{CleanRule, MissionRisk, RiskLimits};
use floorguard_mapping::{DirtCell, DirtMap};

use super::config::{Guarantee, MissionConfig};

/// The promise of a mission about the cells that were dirty at its start.
pub struct Promise {
    fixed: CleanRule,
    risk: Option<MissionRisk>,
    dirty: Vec<usize>,
}

impl Promise {
    /// The promise of this configuration about these cells.
    pub fn new(config: &MissionConfig, dirty: Vec<usize>) -> Self {
        let (tolerated, delta) = (config.tolerated_units, config.delta);
        let fixed = match config.guarantee {
            Guarantee::AllCells => CleanRule::joint(tolerated, delta, dirty.len()),
            Guarantee::EachCell | Guarantee::Mission => CleanRule::per_cell(tolerated, delta),
        };
        let limits = RiskLimits { of_a_cell: delta, of_the_mission: config.mission_risk };
        let shares = config.guarantee == Guarantee::Mission && !config.as_published;
        Self {
            fixed: if config.as_published { fixed.mean_only() } else { fixed },
            risk: shares.then(|| MissionRisk::new(tolerated, limits, dirty.len())),
            dirty,
        }
    }

    /// The rule for a single cell, from what is believed now.
    pub fn rule(&self, map: &DirtMap<Vec<DirtCell>>) -> CleanRule {
        match &self.risk {
            Some(risk) => risk.rule(self.dirty.iter().filter_map(|&cell| map.get(cell))),
            None => self.fixed,
        }
    }
}
