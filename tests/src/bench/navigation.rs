//! How long planning takes: computing time of this thread, the fastest of some rounds. The wall clock on a machine that others
//! use would tell how busy they are.

use std::hint::black_box;

use floorguard_mapping::{GridGeometry, GridSides, Occupancy, Parabola, squared_distances};
use floorguard_navigation::costmap::{
    CostmapLayers, CostmapView, Costs, Inflation, InflationConfig, InflationScratch, PeopleCost, compose,
};
use floorguard_navigation::global::{GridSearch, SearchEnd, SearchMethod, StepCosts};
use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;

use super::cpu::Stopwatch;
use super::navigation_lattice::across_a_building;
use super::navigation_local::local_planners;

/// One figure.
#[derive(Clone, Debug, PartialEq)]
pub struct NavigationTime {
    /// What was done.
    pub task: &'static str,
    /// On what.
    pub input: String,
    /// Computing time, milliseconds.
    pub ms: f64,
    /// What else was measured.
    pub note: String,
}

/// The fastest of some rounds, milliseconds.
pub(super) fn fastest_ms<R>(rounds: u32, mut work: impl FnMut() -> R) -> (f64, R) {
    let mut best: Option<(f64, R)> = None;
    for _ in 0..rounds.max(1) {
        let begin = Stopwatch::begin();
        let result = black_box(work());
        let ms = begin.elapsed().as_secs_f64() * 1e3;
        if best.as_ref().is_none_or(|(least, _)| ms < *least) {
            best = Some((ms, result));
        }
    }
    best.expect("at least one round")
}

/// A floor with its costs.
pub(super) struct Floor {
    pub(super) geometry: GridGeometry,
    pub(super) costs: Vec<u8>,
}

impl Floor {
    pub(super) fn view(&self) -> CostmapView<'_> {
        CostmapView::new(self.geometry, &self.costs, 1).expect("as many costs as cells")
    }

    pub(super) fn new(geometry: GridGeometry, fixed: &[Occupancy], shape: &InflationConfig) -> Self {
        let inflation = Inflation::new(shape, geometry.resolution_m()).expect("few cells");
        let layers = CostmapLayers {
            geometry: &geometry,
            inflation: &inflation,
            fixed,
            observed: &[],
            zones: &[],
            people: &[],
            people_cost: PeopleCost::DEFAULT,
        };
        let mut squared_cells = vec![0; fixed.len()];
        let mut envelope = vec![Parabola::default(); geometry.columns()];
        let mut scratch = InflationScratch { squared_cells: &mut squared_cells, envelope: &mut envelope };
        let mut costs = vec![0; fixed.len()];
        compose(&layers, &mut costs, &mut scratch).expect("everything fits");
        Self { geometry, costs }
    }

    /// The first passable cell from a place on, row by row.
    pub(super) fn passable_from(&self, column: i32, row: i32) -> usize {
        let first = self.geometry.index(column, row).expect("inside");
        (first..self.costs.len()).find(|&cell| self.costs[cell] < Costs::INSCRIBED).expect("some floor")
    }
}

/// A hall with boxes of 0.25 m to 2.2 m, from a seed.
fn hall(side: u32) -> (GridGeometry, Vec<Occupancy>) {
    let sides = GridSides { columns: side, rows: side };
    let geometry = GridGeometry::with_sides(sides, 0.05, Point2::default()).expect("a raster");
    let mut fixed = vec![Occupancy::Free; geometry.cell_count()];
    let mut random = Pcg32::new(5, 1);
    for _ in 0..u64::from(side) * u64::from(side) / 2_600 {
        let (width, height) = (5 + random.below(40), 5 + random.below(40));
        let (left, low) = (random.below(side), random.below(side));
        for row in low..(low + height).min(side) {
            let begin = (row * side + left) as usize;
            fixed[begin..begin + width.min(side - left) as usize].fill(Occupancy::Occupied);
        }
    }
    (geometry, fixed)
}

/// All figures; those whose map is absent are left out.
#[must_use]
pub fn navigation() -> Vec<NavigationTime> {
    let mut times = vec![distances()];
    times.extend(across_a_hall());
    times.extend(across_a_building());
    times.extend(local_planners());
    times
}

fn distances() -> NavigationTime {
    let (geometry, fixed) = hall(1_000);
    let mut squared = vec![0; fixed.len()];
    let mut envelope = vec![Parabola::default(); 1_000];
    let (ms, _) = fastest_ms(9, || {
        squared_distances(&geometry, |cell| fixed[cell] == Occupancy::Occupied, &mut squared, &mut envelope)
    });
    NavigationTime {
        task: "distance transform",
        input: "1,000 × 1,000".into(),
        ms,
        note: "at most 6 ms".into(),
    }
}

/// Dijkstra over everything, and A* from corner to corner.
fn across_a_hall() -> Vec<NavigationTime> {
    let (geometry, fixed) = hall(4_000);
    let shape = InflationConfig { inscribed_radius_m: 0.05, inflation_radius_m: 0.05, decay_per_m: 10.0 };
    let floor = Floor::new(geometry, &fixed, &shape);
    let free = floor.costs.iter().filter(|&&cost| cost < Costs::INSCRIBED).count();
    let (start, goal) = (floor.passable_from(40, 40), floor.passable_from(3_900, 3_950));
    let mut search = GridSearch::new(vec![0; fixed.len()], vec![0; fixed.len() / 8], StepCosts::new(false));
    let mut times = Vec::new();
    let (ms, end) = fastest_ms(5, || search.run(floor.view(), start, None, SearchMethod::Dijkstra));
    assert_eq!(end, SearchEnd::Exhausted, "the storage is large enough");
    let note = format!("{} of {free} free cells reached; at most 400 ms at 11.6 M", search.expanded());
    let input = "4,000 × 4,000".to_owned();
    times.push(NavigationTime { task: "Dijkstra, all", input: input.clone(), ms, note });
    let (ms, end) = fastest_ms(5, || search.run(floor.view(), start, Some(goal), SearchMethod::AStar));
    let note = format!("{end:?}, {} cells expanded; at most 60 ms", search.expanded());
    times.push(NavigationTime { task: "A*, across", input, ms, note });
    times
}
