//! Steps from a set of cells to every other, round obstacles (ROS `base_local_planner`, `MapGrid`).

use floorguard_types::number::{exact_usize, truncating_u32};

use crate::costmap::{CostmapView, Costs};

/// A cell that is no obstacle and was not reached.
const UNREACHED: u16 = u16::MAX;
/// A cell that the wave does not enter.
const OBSTACLE: u16 = u16::MAX - 1;

/// Working memory of the field for one cell.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepCell {
    steps: u16,
    queued: u32,
}

/// Steps along rows and columns from the seeds; one cell of storage for each cell of the costmap.
pub struct StepField<'a> {
    cells: &'a mut [StepCell],
    seeds: usize,
}

impl<'a> StepField<'a> {
    /// A field without seeds; `None`: storage for fewer cells than the costmap has.
    #[must_use]
    pub fn new(costmap: CostmapView<'_>, cells: &'a mut [StepCell]) -> Option<Self> {
        let count = costmap.geometry().cell_count();
        let cells = cells.get_mut(..count)?;
        for (cell, &cost) in cells.iter_mut().zip(costmap.costs()) {
            // Unknown is left to the obstacle critic, as published.
            let is_obstacle = cost == Costs::LETHAL || cost == Costs::INSCRIBED;
            cell.steps = if is_obstacle || cost == Costs::UNKNOWN { OBSTACLE } else { UNREACHED };
        }
        Some(Self { cells, seeds: 0 })
    }

    /// Begins the wave in a cell, whatever stands there.
    pub fn seed(&mut self, cell: usize) {
        let Some(entry) = self.cells.get_mut(cell).filter(|entry| entry.steps != 0) else { return };
        entry.steps = 0;
        if let Some(slot) = self.cells.get_mut(self.seeds) {
            slot.queued = truncating_u32(cell);
            self.seeds = self.seeds.saturating_add(1);
        }
    }

    /// Spreads the wave over all cells that can be reached.
    pub fn spread(&mut self, costmap: CostmapView<'_>) {
        let columns = costmap.geometry().columns();
        let mut filled = self.seeds;
        for at in 0..self.cells.len() {
            if at >= filled {
                break;
            }
            let Some(cell) = self.cells.get(at).map(|entry| exact_usize(entry.queued)) else { break };
            let steps = self.cells.get(cell).map_or(0, |entry| entry.steps).saturating_add(1);
            let column = cell % columns.max(1);
            let sides = [column > 0, column.saturating_add(1) < columns, true, true];
            let others = [
                cell.wrapping_sub(1),
                cell.wrapping_add(1),
                cell.wrapping_sub(columns),
                cell.wrapping_add(columns),
            ];
            for (other, is_inside) in others.into_iter().zip(sides) {
                let Some(entry) = self.cells.get_mut(other).filter(|_| is_inside) else { continue };
                if entry.steps != UNREACHED {
                    continue;
                }
                entry.steps = steps.min(OBSTACLE - 1);
                if let Some(slot) = self.cells.get_mut(filled) {
                    slot.queued = truncating_u32(other);
                    filled = filled.saturating_add(1);
                }
            }
        }
    }

    /// Steps of a cell; `None`: an obstacle, or not reached.
    #[inline]
    #[must_use]
    pub fn steps(&self, cell: usize) -> Option<u16> {
        self.cells.get(cell).map(|entry| entry.steps).filter(|&steps| steps < OBSTACLE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_mapping::GridGeometry;
    use floorguard_types::geometry::Point2;
    use std::vec;

    #[test]
    fn steps_go_round_a_wall() {
        let geometry = GridGeometry::new(9, 5, 0.05, Point2::default()).unwrap();
        let mut costs = vec![0; 45];
        for row in 0..4 {
            costs[row * 9 + 4] = Costs::LETHAL;
        }
        costs[44] = Costs::UNKNOWN;
        let view = CostmapView::new(geometry, &costs, 0).unwrap();
        let mut cells = vec![StepCell::default(); 45];
        let mut field = StepField::new(view, &mut cells).unwrap();
        field.seed(0);
        field.spread(view);
        assert_eq!(field.steps(0), Some(0));
        assert_eq!(field.steps(3), Some(3));
        assert_eq!(field.steps(5), Some(5 + 4 + 4), "up over the wall and down again");
        assert_eq!((field.steps(4), field.steps(44)), (None, None));
        assert!(StepField::new(view, &mut [StepCell::default(); 44]).is_none());
    }
}
