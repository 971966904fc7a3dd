//! Dijkstra as published in ROS `global_planner`: a wave of quadratic potentials with three buffers.
//!
//! Buffers hold the cells of the current threshold, of the next one, and those beyond. The published buffers hold 10,000
//! entries and drop what is beyond silently; these are the caller's, and what does not fit ends the search with a value.

use super::potential::{UNREACHED, potential};
use super::step_costs::StepCosts;
use floorguard_mapping::{GRID_CELLS_MAX, GridCoordinates};
use floorguard_types::number::{count_f32, exact_usize, nearest_f32, truncating_u32};

use crate::costmap::CostmapView;

/// The threshold rises by two neutral costs.
const THRESHOLD_STEP: f32 = 2.0 * count_f32(exact_usize(StepCosts::NEUTRAL));

/// Memory of the wave: `potentials` and `is_pending` one a cell, the buffers as large as the wave is long.
pub struct Wavefront<'a> {
    /// Potentials; the result.
    pub potentials: &'a mut [f32],
    /// The cell waits in a buffer.
    pub is_pending: &'a mut [bool],
    /// Three buffers of equal length.
    pub buffers: [&'a mut [u32]; 3],
}

/// A buffer or the storage is too small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WavefrontFull;

/// The published planner over one wavefront.
pub struct PublishedDijkstra<'a> {
    wave: Wavefront<'a>,
    steps: &'a StepCosts,
    /// Entries of each buffer; which buffer has which part changes with the threshold.
    counts: [usize; 3],
    /// Which buffer is current; the next two are next and beyond.
    current: usize,
    threshold: f32,
}

const NEXT: usize = 1;
const BEYOND: usize = 2;

impl<'a> PublishedDijkstra<'a> {
    /// A wave that has not begun.
    #[must_use]
    pub const fn new(wave: Wavefront<'a>, steps: &'a StepCosts) -> Self {
        Self { wave, steps, counts: [0; 3], current: 0, threshold: 253.0 }
    }

    /// Potentials of the last run.
    #[must_use]
    pub const fn potentials(&self) -> &[f32] {
        self.wave.potentials
    }

    /// The wave from a cell until it reaches `goal`, or over everything. Gives whether the goal was reached. The outermost
    /// ring of cells is impassable.
    ///
    /// # Errors
    /// The storage was too small: potentials are not complete.
    pub fn run(
        &mut self,
        costmap: CostmapView<'_>,
        start: usize,
        goal: Option<usize>,
    ) -> Result<bool, WavefrontFull> {
        let count = costmap.geometry().cell_count();
        self.wave.potentials.get_mut(..count).ok_or(WavefrontFull)?.fill(UNREACHED);
        self.wave.is_pending.get_mut(..count).ok_or(WavefrontFull)?.fill(false);
        (self.counts, self.current, self.threshold) = ([0; 3], 0, 253.0);
        if let Some(value) = self.wave.potentials.get_mut(start) {
            *value = 0.0;
        }
        for neighbour in neighbours(start, costmap.geometry().columns()) {
            self.enter(costmap, neighbour, 0)?;
        }
        // Every pass empties a buffer; the published bound on passes is the cells of the map.
        for _ in 0..count.min(GRID_CELLS_MAX) {
            self.pass(costmap)?;
            let reached = goal.and_then(|goal| self.wave.potentials.get(goal));
            if reached.is_some_and(|&there| there < UNREACHED) {
                return Ok(true);
            }
            if self.counts.iter().all(|&entries| entries == 0) {
                return Ok(false);
            }
        }
        Err(WavefrontFull)
    }

    /// Empties the current buffer, then turns the buffers.
    fn pass(&mut self, costmap: CostmapView<'_>) -> Result<(), WavefrontFull> {
        let entries = self.counts.get(self.current).copied().unwrap_or(0);
        for at in 0..entries.min(GRID_CELLS_MAX) {
            let cell = self.wave.buffers.get(self.current).and_then(|buffer| buffer.get(at)).copied();
            let Some(cell) = cell else { continue };
            if let Some(pending) = self.wave.is_pending.get_mut(exact_usize(cell)) {
                *pending = false;
            }
        }
        for at in 0..entries.min(GRID_CELLS_MAX) {
            let cell = self.wave.buffers.get(self.current).and_then(|buffer| buffer.get(at)).copied();
            if let Some(cell) = cell {
                self.update(costmap, exact_usize(cell))?;
            }
        }
        if let Some(count) = self.counts.get_mut(self.current) {
            *count = 0;
        }
        let next = self.current.wrapping_add(NEXT) % 3;
        if self.counts.get(next).copied().unwrap_or(0) > 0 {
            // Next becomes current; beyond stays beyond.
            self.wave.buffers.swap(self.current, next);
            self.counts.swap(self.current, next);
        } else {
            let beyond = self.current.wrapping_add(BEYOND) % 3;
            self.threshold += THRESHOLD_STEP;
            self.wave.buffers.swap(self.current, beyond);
            self.counts.swap(self.current, beyond);
        }
        Ok(())
    }

    /// The published update of a cell: a lower potential pushes the neighbours that it could lower.
    fn update(&mut self, costmap: CostmapView<'_>, cell: usize) -> Result<(), WavefrontFull> {
        let columns = costmap.geometry().columns();
        let Some(cost) = self.step_cost(costmap, cell) else { return Ok(()) };
        let at = |index: usize| self.wave.potentials.get(index).copied().unwrap_or(UNREACHED);
        let [right, left, up, down] = neighbours(cell, columns);
        let new = potential(at(left).min(at(right)), at(up).min(at(down)), cost);
        if new >= at(cell) {
            return Ok(());
        }
        if let Some(value) = self.wave.potentials.get_mut(cell) {
            *value = new;
        }
        let buffer = if new < self.threshold { NEXT } else { BEYOND };
        for neighbour in [right, left, up, down] {
            let Some(cost) = self.step_cost(costmap, neighbour) else { continue };
            let there = self.wave.potentials.get(neighbour).copied().unwrap_or(0.0);
            if there > new + core::f32::consts::FRAC_1_SQRT_2 * cost {
                self.enter(costmap, neighbour, buffer)?;
            }
        }
        Ok(())
    }

    /// `None`: impassable, or of the outermost ring.
    fn step_cost(&self, costmap: CostmapView<'_>, cell: usize) -> Option<f32> {
        let geometry = costmap.geometry();
        let GridCoordinates { column, row } = geometry.coordinates(cell);
        let is_inner = geometry.index(column.wrapping_sub(1), row.wrapping_sub(1)).is_some()
            && geometry.index(column.wrapping_add(1), row.wrapping_add(1)).is_some();
        let cost = costmap.costs().get(cell).map_or(0, |&cost| self.steps.straight(cost));
        (is_inner && cost > 0).then_some(nearest_f32(cost))
    }

    /// Puts a cell into a buffer unless it waits in one.
    fn enter(&mut self, costmap: CostmapView<'_>, cell: usize, which: usize) -> Result<(), WavefrontFull> {
        if self.step_cost(costmap, cell).is_none() {
            return Ok(());
        }
        match self.wave.is_pending.get_mut(cell) {
            Some(pending) if !*pending => *pending = true,
            _ => return Ok(()),
        }
        let which = self.current.wrapping_add(which) % 3;
        let count = self.counts.get_mut(which).ok_or(WavefrontFull)?;
        let buffer = self.wave.buffers.get_mut(which).ok_or(WavefrontFull)?;
        *buffer.get_mut(*count).ok_or(WavefrontFull)? = truncating_u32(cell);
        *count = count.saturating_add(1);
        Ok(())
    }
}

const fn neighbours(cell: usize, columns: usize) -> [usize; 4] {
    [cell.wrapping_add(1), cell.wrapping_sub(1), cell.wrapping_add(columns), cell.wrapping_sub(columns)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::Costs;
    use floorguard_mapping::GridGeometry;
    use floorguard_types::geometry::Point2;
    use std::vec;

    fn potentials(costs: &[u8], start: usize) -> vec::Vec<f32> {
        let geometry = GridGeometry::new(41, 31, 0.05, Point2::default()).unwrap();
        let view = CostmapView::new(geometry, costs, 0).unwrap();
        let (mut values, mut pending) = (vec![0.0; costs.len()], vec![false; costs.len()]);
        let (mut a, mut b, mut c) = (vec![0; 999], vec![0; 999], vec![0; 999]);
        let wave = Wavefront {
            potentials: &mut values,
            is_pending: &mut pending,
            buffers: [&mut a, &mut b, &mut c],
        };
        let steps = StepCosts::new(false);
        let mut planner = PublishedDijkstra::new(wave, &steps);
        assert_eq!(planner.run(view, start, None), Ok(false));
        values
    }

    /// On free floor the wave is a circle: within 9 % of 50 a cell from eight cells on (the fit starts 8 % too high on a diagonal).
    #[test]
    fn a_wave_on_free_floor_is_a_circle() {
        let geometry = GridGeometry::new(41, 31, 0.05, Point2::default()).unwrap();
        let start = geometry.index(20, 15).unwrap();
        let values = potentials(&vec![0; geometry.cell_count()], start);
        for (cell, &value) in values.iter().enumerate() {
            let GridCoordinates { column: x, row: y } = geometry.coordinates(cell);
            let distance = ((x - 20).pow(2) as f32 + (y - 15).pow(2) as f32).sqrt();
            if x > 0 && y > 0 && x < 40 && y < 30 && distance > 8.0 {
                assert!((value / (50.0 * distance) - 1.0).abs() < 0.09, "{x},{y}: {value}");
            }
        }
    }

    /// Every potential is what its neighbours give (the fixed point of the published update), within the slack of the
    /// published rule for pushing and the fit's step of 0.46 % of a cost; what a wall shuts off stays unreached.
    #[test]
    fn potentials_are_consistent_and_stop_at_walls() {
        let geometry = GridGeometry::new(41, 31, 0.05, Point2::default()).unwrap();
        let mut costs: vec::Vec<u8> =
            (0..geometry.cell_count()).map(|cell| (cell * 37 % 101) as u8).collect();
        for row in 0..31 {
            costs[row * 41 + 30] = Costs::LETHAL;
        }
        let start = geometry.index(5, 5).unwrap();
        let values = potentials(&costs, start);
        for (cell, &value) in values.iter().enumerate() {
            let GridCoordinates { column: x, row: y } = geometry.coordinates(cell);
            if x >= 30 || x == 0 || y == 0 || y == 30 {
                assert_eq!(value, UNREACHED);
            } else if cell != start {
                let at = |cell: usize| values[cell];
                let cost = 3.0 * f32::from(costs[cell]) + 50.0;
                let new = potential(at(cell - 1).min(at(cell + 1)), at(cell - 41).min(at(cell + 41)), cost);
                assert!(
                    value <= new + 0.3 * cost && value >= new - 0.005 * cost,
                    "{x},{y}: {value} for {new}"
                );
            }
        }
    }

    #[test]
    fn a_full_buffer_is_a_value() {
        let geometry = GridGeometry::new(41, 31, 0.05, Point2::default()).unwrap();
        let costs = vec![0; geometry.cell_count()];
        let view = CostmapView::new(geometry, &costs, 0).unwrap();
        let (mut values, mut pending) = (vec![0.0; costs.len()], vec![false; costs.len()]);
        let (mut a, mut b, mut c) = ([0; 9], [0; 9], [0; 9]);
        let wave = Wavefront {
            potentials: &mut values,
            is_pending: &mut pending,
            buffers: [&mut a, &mut b, &mut c],
        };
        let steps = StepCosts::new(false);
        assert_eq!(PublishedDijkstra::new(wave, &steps).run(view, 600, None), Err(WavefrontFull));
    }
}
