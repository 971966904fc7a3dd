//! A building as a robot of 0.3 m radius finds it, and what its scanner sees.

use std::path::Path;

use floorguard_mapping::{GridCoordinates, GridGeometry, GridSides, Occupancy, Parabola};
use floorguard_navigation::costmap::{
    CostmapLayers, CostmapView, Costs, Inflation, InflationConfig, InflationScratch, PeopleCost, RayCells,
    compose,
};
use floorguard_robot::site::ros_map;
use floorguard_types::geometry::{Point2, Pose2};

/// The maps: name, and file below the folder of recordings.
pub const BUILDINGS: [(&str, &str); 11] = [
    ("freiburg-52", "grid_maps/Freiburg52_scan.png"),
    ("freiburg-52, furnished", "grid_maps/Freiburg52_scan_furnitures.png"),
    ("freiburg-101", "grid_maps/Freiburg101_scan.png"),
    ("freiburg-101, furnished", "grid_maps/Freiburg101_scan_furnitures.png"),
    ("lab a", "grid_maps/lab_a_scan.png"),
    ("lab a, furnished", "grid_maps/lab_a_scan_furnitures.png"),
    ("lab c", "grid_maps/lab_c_scan.png"),
    ("lab c, furnished", "grid_maps/lab_c_scan_furnitures.png"),
    ("intel", "grid_maps/lab_intel.png"),
    ("intel, furnished", "grid_maps/lab_intel_furnitures.png"),
    ("willow", "grid_maps/willow-full-0.05.yaml"),
];
/// Edge of a cell, metres.
const CELL_M: f32 = 0.1;
/// The robot: a disc, metres.
const INFLATION: InflationConfig =
    InflationConfig { inscribed_radius_m: 0.3, inflation_radius_m: 0.6, decay_per_m: 6.0 };
/// The scanner: 541 beams over 270 degrees, as a SICK S300, of which 10 m are used.
const BEAMS: u16 = 541;
const FIRST_DEG: f32 = -135.0;
const STEP_DEG: f32 = 0.5;
/// Beams end here, metres.
pub(super) const RANGE_M: f32 = 10.0;

/// A building.
pub struct Building {
    /// Name for tables.
    pub name: String,
    pub(super) geometry: GridGeometry,
    pub(super) truth: Vec<Occupancy>,
    /// The middle of the roomiest place.
    pub start: Point2,
    /// Floor that the robot's middle can get to, by cell.
    pub(super) reachable: Vec<bool>,
}

/// What is known, with the costs of it.
pub(super) struct Known {
    cells: Vec<Occupancy>,
    costs: Vec<u8>,
    squared_cells: Vec<u32>,
    envelope: Vec<Parabola>,
    inflation: Inflation,
}

impl Building {
    /// Of a map.
    ///
    /// # Errors
    /// The map cannot be read, or the robot fits nowhere.
    pub fn load(name: &str, path: &Path) -> anyhow::Result<Self> {
        let map = ros_map::load(path)?;
        let fine = *map.geometry();
        let side = |count: usize| (count as f32 * fine.resolution_m() / CELL_M).ceil() as u32;
        let sides = GridSides { columns: side(fine.columns()), rows: side(fine.rows()) };
        let geometry = GridGeometry::with_sides(sides, CELL_M, fine.origin_in_map());
        let geometry = geometry.ok_or_else(|| anyhow::anyhow!("{name} makes no raster"))?;
        // What is not free floor is as good as a wall: nothing is known of what lies there.
        let mut truth = vec![Occupancy::Unknown; geometry.cell_count()];
        for (pixel, state) in map.values().iter().enumerate() {
            let Some(cell) = geometry.cell_at(fine.centre(pixel)) else { continue };
            let is_free = *state == Occupancy::Free && truth[cell] != Occupancy::Occupied;
            truth[cell] = if is_free { Occupancy::Free } else { Occupancy::Occupied };
        }
        let walls = truth.iter_mut().filter(|state| **state == Occupancy::Unknown);
        walls.for_each(|state| *state = Occupancy::Occupied);
        let mut building =
            Self { name: name.to_owned(), geometry, truth, start: Point2::default(), reachable: Vec::new() };
        building.find_reachable()?;
        Ok(building)
    }

    /// The largest connected floor, and its roomiest place.
    fn find_reachable(&mut self) -> anyhow::Result<()> {
        let mut known = Known::new(&self.geometry)?;
        known.cells.clone_from(&self.truth);
        known.refresh(&self.geometry);
        let mut seen = vec![false; known.costs.len()];
        let mut largest = Vec::new();
        for first in 0..known.costs.len() {
            if seen[first] || known.costs[first] >= Costs::INSCRIBED {
                continue;
            }
            let (mut part, mut next) = (vec![first], 0);
            seen[first] = true;
            while let Some(&cell) = part.get(next) {
                next += 1;
                let GridCoordinates { column, row } = self.geometry.coordinates(cell);
                for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                    let other = self.geometry.index(column + dx, row + dy);
                    if let Some(other) = other.filter(|&at| !seen[at] && known.costs[at] < Costs::INSCRIBED) {
                        seen[other] = true;
                        part.push(other);
                    }
                }
            }
            if part.len() > largest.len() {
                largest = part;
            }
        }
        let roomiest = largest.iter().max_by_key(|&&cell| (known.squared_cells[cell], usize::MAX - cell));
        let roomiest = *roomiest.ok_or_else(|| anyhow::anyhow!("{}: the robot fits nowhere", self.name))?;
        self.start = self.geometry.centre(roomiest);
        self.reachable = vec![false; known.costs.len()];
        largest.iter().for_each(|&cell| self.reachable[cell] = true);
        Ok(())
    }

    /// What the scanner sees from a pose goes into what is known.
    pub(super) fn scan(&self, pose: Pose2, known: &mut Known) {
        for beam in 0..BEAMS {
            let angle_rad = pose.heading_rad + (FIRST_DEG + STEP_DEG * f32::from(beam)).to_radians();
            let (sin, cos) = libm::sincosf(angle_rad);
            let from = Point2::new(pose.x_m, pose.y_m);
            let end = Point2::new(pose.x_m + RANGE_M * cos, pose.y_m + RANGE_M * sin);
            for cell in RayCells::new(&self.geometry, from, end) {
                known.cells[cell] = self.truth[cell];
                if self.truth[cell] != Occupancy::Free {
                    break;
                }
            }
        }
    }

    /// Share of the reachable floor that is known.
    pub(super) fn covered_share(&self, known: &Known) -> f64 {
        let cells = self.reachable.iter().zip(&known.cells).filter(|(reachable, _)| **reachable);
        let (count, free) = cells.fold((0_u32, 0_u32), |(count, free), (_, state)| {
            (count + 1, free + u32::from(*state == Occupancy::Free))
        });
        f64::from(free) / f64::from(count.max(1))
    }

    /// Reachable floor, square metres.
    #[must_use]
    pub fn reachable_m2(&self) -> f64 {
        let count = self.reachable.iter().filter(|reachable| **reachable).count();
        count as f64 * f64::from(CELL_M * CELL_M)
    }
}

impl Known {
    /// Nothing.
    pub(super) fn new(geometry: &GridGeometry) -> anyhow::Result<Self> {
        let cells = geometry.cell_count();
        Ok(Self {
            cells: vec![Occupancy::Unknown; cells],
            costs: vec![Costs::UNKNOWN; cells],
            squared_cells: vec![0; cells],
            envelope: vec![Parabola::default(); geometry.columns()],
            inflation: Inflation::new(&INFLATION, geometry.resolution_m())?,
        })
    }

    /// Makes the costs anew.
    pub(super) fn refresh(&mut self, geometry: &GridGeometry) {
        let layers = CostmapLayers {
            geometry,
            inflation: &self.inflation,
            fixed: &self.cells,
            observed: &[],
            zones: &[],
            people: &[],
            people_cost: PeopleCost::DEFAULT,
        };
        let mut scratch =
            InflationScratch { squared_cells: &mut self.squared_cells, envelope: &mut self.envelope };
        compose(&layers, &mut self.costs, &mut scratch).expect("all layers have this raster");
    }

    /// Everything.
    pub(super) fn learn(&mut self, cells: &[Occupancy]) {
        self.cells.copy_from_slice(cells);
    }

    pub(super) fn costs(&self) -> &[u8] {
        &self.costs
    }

    pub(super) fn costmap(&self, geometry: &GridGeometry) -> CostmapView<'_> {
        CostmapView::new(*geometry, &self.costs, 0).expect("as many costs as cells")
    }
}
