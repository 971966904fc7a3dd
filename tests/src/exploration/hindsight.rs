//! The best tour of view points by one who knows the building.

use floorguard_cleaning::{Distances, TourSolver};
use floorguard_navigation::costmap::Costs;
use floorguard_navigation::{PathSearch, STRAIGHT, SearchCell};
use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;

use super::building::Building;

/// View points of a building at most.
const PLACES_MAX: usize = 1_026;
/// Experiments of the tour search.
const EXPERIMENTS: u32 = 20_000;

struct Matrix {
    count: usize,
    units: Vec<i32>,
}

impl Distances for Matrix {
    fn between(&self, from: u16, to: u16) -> i32 {
        self.units[usize::from(from) * self.count + usize::from(to)]
    }
}

/// The shortest open tour found that begins at the first view point, metres: local search with perturbation over the shortest
/// paths in the true building.
///
/// # Errors
/// A place that cannot be reached, or too many.
pub fn best_tour_m(building: &Building, view_points: &[Point2]) -> anyhow::Result<f64> {
    let geometry = building.geometry;
    let costs = building.costs()?;
    let is_floor = |cell: usize| costs[cell] < Costs::INSCRIBED;
    // Where the robot stood before it saw the wall beside it, it may have been too near: one step aside.
    let off_m = |cell: usize, place: &Point2| geometry.centre(cell).distance(*place);
    let floor = |place: &Point2| {
        let cells = (0..costs.len()).filter(|&cell| building.reachable[cell]);
        cells.min_by(|&a, &b| off_m(a, place).total_cmp(&off_m(b, place)))
    };
    let mut cells: Vec<usize> = view_points.iter().filter_map(floor).collect();
    let first = cells.first().copied();
    cells.sort_unstable();
    cells.dedup();
    let at = first.and_then(|first| cells.iter().position(|&cell| cell == first)).unwrap_or(0);
    cells.swap(0, at);
    if cells.len() < 2 {
        return Ok(0.0);
    }
    let mut search = PathSearch::new(geometry, vec![SearchCell::EMPTY; geometry.cell_count()]);
    let mut units = Vec::with_capacity(cells.len() * cells.len());
    for &from in &cells {
        search.run(from, is_floor);
        for &to in &cells {
            let distance = search.distance(to);
            let distance = distance.ok_or_else(|| anyhow::anyhow!("a view point cannot be reached"))?;
            units.push(i32::try_from(distance)?);
        }
    }
    let matrix = Matrix { count: cells.len(), units };
    let mut solver = Box::new(TourSolver::<PLACES_MAX>::new(Pcg32::new(1, 1)));
    let started = solver.start(cells.len(), &matrix);
    started.map_err(|error| anyhow::anyhow!("{} view points: {error:?}", cells.len()))?;
    solver.improve(EXPERIMENTS, &matrix);
    let metres = f64::from(geometry.resolution_m()) / f64::from(STRAIGHT);
    Ok(solver.length(&matrix) as f64 * metres)
}

impl Building {
    /// What it costs to be where, for one who knows it all.
    fn costs(&self) -> anyhow::Result<Vec<u8>> {
        let mut known = super::building::Known::new(&self.geometry)?;
        known.learn(&self.truth);
        known.refresh(&self.geometry);
        Ok(known.costs().to_vec())
    }
}
