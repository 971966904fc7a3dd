//! What it costs to drive where: the whole map for the global plan, and a window that rolls with the robot for the local one.

use floorguard_mapping::{GridCoordinates, GridGeometry, GridSides, Occupancy, Parabola};
use floorguard_navigation::costmap::{
    Beam, CostmapLayers, CostmapView, Costs, Inflation, InflationConfig, InflationScratch, ObstacleLayer,
    ObstacleLimits, PeopleCost, SpaceCell, SpaceLayer, SpaceLimits, SpaceRay, compose,
};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::{Footprint, MovingPerson};

use super::plan::NavigationPlan;
use crate::site::ros_map::OccupancyMap;

/// Cells of the global costmap; larger maps are planned on coarser cells.
const CELLS_MAX: usize = 1_000_000;
/// Coarsest cells on which a robot fits through a door, metres.
const CELL_MAX_M: f32 = 0.15;
/// Half of the rolling window, metres: three seconds ahead, and the robot.
const HALF_WINDOW_M: f32 = 4.0;
/// Where rays end nearer than this they mark; and so far they clear, metres.
const LIMITS: ObstacleLimits = ObstacleLimits { mark_m: 6.0, clear_m: 8.0 };
/// The same where a map is made: what is far is all that is known.
const EXPLORED_LIMITS: ObstacleLimits = ObstacleLimits { mark_m: 15.0, clear_m: 15.0 };
/// What the lidar sees: from above what its rings take for floor on a ramp to above the robot. A mark that the lidar does not see
/// again is kept for thirty seconds: under the lowest ring a board across the way is in sight of no sensor.
const SPACE: SpaceLimits = SpaceLimits { low_m: 0.12, high_m: 1.3, mark_m: 6.0, kept_sweeps: 300 };
/// Free floor around a robot that begins to explore, beyond what it takes to turn on the spot, metres.
const START_M: f32 = 0.3;
/// What the robot forgets around itself when it clears the costmap, metres.
const FORGET_M: f32 = 6.0;
/// Hills of cost at places where the robot did not get through.
const STUCK: PeopleCost =
    PeopleCost { collision_radius_m: 0.0, deviation_m: 0.5, ahead_m_per_mps: 0.0, peak: 220 };
/// Hills of cost around people: a body, and the inscribed disc of the robot.
pub(super) const HILLS: PeopleCost = PeopleCost { collision_radius_m: 0.7, ..PeopleCost::DEFAULT };
/// Places that are kept.
const STUCK_MAX: usize = 16;

/// Costs of one raster with the memory to make them.
struct Costmap {
    geometry: GridGeometry,
    fixed: Vec<Occupancy>,
    observed: Vec<Occupancy>,
    costs: Vec<u8>,
    squared_cells: Vec<u32>,
    envelope: Vec<Parabola>,
    revision: u32,
}

impl Costmap {
    fn new(geometry: GridGeometry) -> Self {
        let cells = geometry.cell_count();
        Self {
            geometry,
            fixed: vec![Occupancy::Occupied; cells],
            observed: vec![Occupancy::Unknown; cells],
            costs: vec![Costs::LETHAL; cells],
            squared_cells: vec![0; cells],
            envelope: vec![Parabola::default(); geometry.columns()],
            revision: 0,
        }
    }

    /// Makes the costs anew; `people` with the shape of their hills.
    fn compose(&mut self, inflation: &Inflation, (people, people_cost): (&[MovingPerson], PeopleCost)) {
        let layers = CostmapLayers {
            geometry: &self.geometry,
            inflation,
            fixed: &self.fixed,
            observed: &self.observed,
            zones: &[],
            people,
            people_cost,
        };
        let mut scratch =
            InflationScratch { squared_cells: &mut self.squared_cells, envelope: &mut self.envelope };
        if compose(&layers, &mut self.costs, &mut scratch).is_err() {
            // Never: all layers were made for this raster. Nothing would be free then.
            self.costs.fill(Costs::LETHAL);
        }
        self.revision = self.revision.wrapping_add(1);
    }

    fn view(&self) -> Option<CostmapView<'_>> {
        CostmapView::new(self.geometry, &self.costs, self.revision)
    }
}

/// Both costmaps, and what was seen.
pub(super) struct Maps {
    observed: ObstacleLayer<Vec<Occupancy>>,
    space: SpaceLayer<Vec<SpaceCell>>,
    global: Costmap,
    window: Costmap,
    inflation: Inflation,
    stuck: Vec<MovingPerson>,
    is_blind: bool,
    explores: bool,
    /// Where the robot was switched on, and how far around it the floor is taken for free; nothing on a known map.
    start: (Point2, f32),
}

impl Maps {
    /// Of a map. What is not known to be free floor is an obstacle: what stands above the floor there the scanner cannot see.
    ///
    /// # Errors
    /// The map is larger than the planners' memory.
    pub(super) fn new(
        map: &OccupancyMap,
        inflation: &InflationConfig,
        plan: &NavigationPlan,
    ) -> anyhow::Result<Self> {
        let (is_blind, explores) = (plan.settings.is_blind, plan.explores);
        let geometry = raster_of(map.geometry())?;
        let cell_m = geometry.resolution_m();
        let mut global = Costmap::new(geometry);
        global.fixed.fill(Occupancy::Unknown);
        for (pixel, state) in map.values().iter().enumerate() {
            let Some(cell) = geometry.cell_at(map.geometry().centre(pixel)) else { continue };
            let is_free = *state == Occupancy::Free && global.fixed[cell] != Occupancy::Occupied;
            global.fixed[cell] = if is_free { Occupancy::Free } else { Occupancy::Occupied };
        }
        let unknown = global.fixed.iter_mut().filter(|state| **state == Occupancy::Unknown);
        unknown.for_each(|state| *state = Occupancy::Occupied);
        if explores {
            global.fixed.fill(Occupancy::Unknown);
        }
        if is_blind {
            global.fixed.fill(Occupancy::Free);
        }
        let side = 2 * (HALF_WINDOW_M / cell_m).ceil() as u32 + 1;
        let window = GridGeometry::with_sides(
            GridSides { columns: side, rows: side },
            cell_m,
            geometry.origin_in_map(),
        );
        let window = window.ok_or_else(|| anyhow::anyhow!("the map makes no raster"))?;
        let observed = ObstacleLayer::new(geometry, vec![Occupancy::Unknown; geometry.cell_count()])?;
        let space = SpaceLayer::new(geometry, vec![SpaceCell::default(); geometry.cell_count()])?;
        Ok(Self {
            observed,
            space,
            global,
            window: Costmap::new(window),
            inflation: Inflation::new(inflation, cell_m)?,
            stuck: Vec::new(),
            is_blind,
            explores,
            start: (Point2::default(), 0.0),
        })
    }

    /// The raster of the global costmap.
    pub(super) const fn geometry(&self) -> &GridGeometry {
        &self.global.geometry
    }

    /// A scan from a sensor in the map frame.
    pub(super) fn see(&mut self, sensor_in_map: Point2, beams: &[Beam]) {
        if !self.is_blind {
            let limits = if self.explores { EXPLORED_LIMITS } else { LIMITS };
            self.observed.observe(sensor_in_map, limits, beams.iter().copied());
        }
    }

    /// A sweep of the lidar: it marks, and opens no floor.
    pub(super) fn see_space(&mut self, rays: &[SpaceRay]) {
        if !self.is_blind {
            self.space.observe(&SPACE, rays.iter().copied());
        }
    }

    /// Forgets all that was seen, and sees these scans instead: the map was corrected.
    pub(super) fn redraw(&mut self, scans: &[(Point2, Vec<Beam>)]) {
        let geometry = self.global.geometry;
        self.observed.forget_within(geometry.origin_in_map(), f32::INFINITY);
        self.space.forget_within(geometry.origin_in_map(), f32::INFINITY);
        scans.iter().for_each(|(sensor, beams)| self.see(*sensor, beams));
        self.suppose_free_around_start();
    }

    /// The robot is switched on here: it can turn on the spot, and what its scanner does not see behind it is taken for free
    /// floor as far as that takes. Only where a map is made.
    pub(super) fn start_at(&mut self, place_in_map: Point2, radius_m: f32) {
        self.start = (place_in_map, radius_m + START_M);
        self.suppose_free_around_start();
    }

    fn suppose_free_around_start(&mut self) {
        let (middle, radius_m) = self.start;
        let low = Point2::new(-radius_m, -radius_m);
        for place in self.places_within((low, Point2::new(radius_m, radius_m))) {
            if place.norm() <= radius_m {
                let place = Point2::new(middle.x_m + place.x_m, middle.y_m + place.y_m);
                self.observed.suppose_free(place);
            }
        }
    }

    /// Where the robot stands nothing else does: unknown floor under its outline is free. Only where a map is made.
    pub(super) fn stand_on(&mut self, outline: &Footprint, pose_in_map: Pose2) {
        // The outline is tested by cells: those that it grazes belong to it.
        let cell_m = self.global.geometry.resolution_m();
        let (mut low, mut high) = (Point2::default(), Point2::default());
        for corner in outline.corners_in_base() {
            low = Point2::new(low.x_m.min(corner.x_m - cell_m), low.y_m.min(corner.y_m - cell_m));
            high = Point2::new(high.x_m.max(corner.x_m + cell_m), high.y_m.max(corner.y_m + cell_m));
        }
        for place in self.places_within((low, high)) {
            self.observed.suppose_free(pose_in_map.transform(place));
        }
    }

    /// Places of a rectangle, half a cell apart; none on a known map.
    fn places_within(&self, (low, high): (Point2, Point2)) -> Vec<Point2> {
        let step_m = 0.5 * self.global.geometry.resolution_m();
        let steps = |from_m: f32, to_m: f32| {
            if self.explores { 0..((to_m - from_m) / step_m).ceil() as u32 + 1 } else { 0..0 }
        };
        let along = |step: u32| low.x_m + step as f32 * step_m;
        let across = |step: u32| low.y_m + step as f32 * step_m;
        steps(low.x_m, high.x_m)
            .flat_map(|x| steps(low.y_m, high.y_m).map(move |y| (x, y)))
            .map(|(x, y)| Point2::new(along(x), across(y)))
            .collect()
    }

    /// Forgets what was seen around a place.
    pub(super) fn forget_around(&mut self, place_in_map: Point2) {
        self.observed.forget_within(place_in_map, FORGET_M);
        self.space.forget_within(place_in_map, FORGET_M);
    }

    /// From now on this place is expensive: the robot did not get through there.
    pub(super) fn avoid(&mut self, place_in_map: Point2) {
        if self.stuck.len() >= STUCK_MAX {
            self.stuck.remove(0);
        }
        self.stuck.push(MovingPerson { position_in_map: place_in_map, ..MovingPerson::default() });
    }

    /// Makes the global costs anew.
    pub(super) fn refresh(&mut self) {
        self.global.observed.copy_from_slice(self.observed.cells().values());
        for (cell, state) in self.global.observed.iter_mut().enumerate() {
            if self.space.is_marked(cell) {
                *state = Occupancy::Occupied;
            }
        }
        self.global.compose(&self.inflation, (&self.stuck, STUCK));
    }

    /// The global costs by the map alone, as if nothing had ever been seen. The next refresh brings it back.
    pub(super) fn refresh_by_map_alone(&mut self) {
        self.global.observed.fill(Occupancy::Unknown);
        self.global.compose(&self.inflation, (&[], STUCK));
    }

    /// Moves the window to the robot and makes its costs anew. `people` become hills.
    pub(super) fn roll(&mut self, place_in_map: Point2, people: &[MovingPerson]) {
        let geometry = self.global.geometry;
        let GridCoordinates { column, row } = geometry.coordinates_of(place_in_map);
        let half = (self.window.geometry.columns() / 2) as i32;
        let (first_column, first_row) = (column.saturating_sub(half), row.saturating_sub(half));
        let base = GridGeometry::with_sides(
            GridSides {
                columns: self.window.geometry.columns() as u32,
                rows: self.window.geometry.rows() as u32,
            },
            geometry.resolution_m(),
            geometry.origin_in_map(),
        );
        let Some(base) = base else { return };
        self.window.geometry = base.moved(first_column, first_row);
        let observed = self.observed.cells().values();
        for cell in 0..self.window.costs.len() {
            let GridCoordinates { column: x, row: y } = self.window.geometry.coordinates(cell);
            let source = geometry.index(x.saturating_add(first_column), y.saturating_add(first_row));
            let of = |layer: &[Occupancy], outside| {
                source.and_then(|at| layer.get(at).copied()).unwrap_or(outside)
            };
            let outside = if self.explores { Occupancy::Unknown } else { Occupancy::Occupied };
            self.window.fixed[cell] = of(&self.global.fixed, outside);
            let is_marked = source.is_some_and(|at| self.space.is_marked(at));
            self.window.observed[cell] =
                if is_marked { Occupancy::Occupied } else { of(observed, Occupancy::Unknown) };
        }
        self.window.compose(&self.inflation, (people, HILLS));
    }

    /// The global costs.
    pub(super) fn global(&self) -> Option<CostmapView<'_>> {
        self.global.view()
    }

    /// The costs around the robot.
    pub(super) fn window(&self) -> Option<CostmapView<'_>> {
        self.window.view()
    }

    /// Cells of the rolling window.
    pub(super) fn window_cells(&self) -> usize {
        self.window.costs.len()
    }
}

/// The raster of a map: its own pixels, or as fine as the planners can hold.
fn raster_of(pixels: &GridGeometry) -> anyhow::Result<GridGeometry> {
    let area_m2 = pixels.cell_count() as f32 * pixels.resolution_m() * pixels.resolution_m();
    let cell_m = pixels.resolution_m().max(0.05).max((area_m2 / CELLS_MAX as f32).sqrt());
    anyhow::ensure!(
        cell_m <= CELL_MAX_M.max(pixels.resolution_m()),
        "the map has {area_m2:.0} m²; navigation plans on {:.0} m² at most: cut the map to the floor that is driven",
        CELLS_MAX as f32 * CELL_MAX_M * CELL_MAX_M
    );
    let side = |count: usize| (count as f32 * pixels.resolution_m() / cell_m).ceil() as u32;
    let sides = GridSides { columns: side(pixels.columns()), rows: side(pixels.rows()) };
    GridGeometry::with_sides(sides, cell_m, pixels.origin_in_map())
        .ok_or_else(|| anyhow::anyhow!("the map makes no raster"))
}
