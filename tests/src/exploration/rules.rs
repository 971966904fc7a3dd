//! Where to go next, by either set of rules.

use floorguard_mapping::GridGeometry;
use floorguard_navigation::SearchCell;
use floorguard_navigation::costmap::{CostmapView, Costs};
use floorguard_navigation::explore::{
    Exploration, ExploreConfig, Explorer, FrontierScratch, FrontierSearch, TourExploration,
    TourExploreConfig, TourExplorer, ViewConfig, ViewSearch, find_frontiers,
};
use floorguard_types::geometry::Point2;

/// Smaller frontiers are left by our rules, metres.
const SIZE_MIN_M: f32 = 0.2;
/// Frontiers are looked at from within, metres: half of what the scanner sees.
const SIGHT_M: f32 = 0.5 * super::building::RANGE_M;
/// Ways between view points are searched on cells of this edge, metres.
const RASTER_M: f32 = 0.2;

/// Which rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rules {
    /// View points in the order of a short way.
    Ours,
    /// The costs of `explore_lite` as its launch file ships them. Its defects are mended: with them it ends early or drives to
    /// the corner of the map.
    Published,
}

/// Our rules with the search for ways.
struct Ours {
    explorer: TourExplorer,
    search: ViewSearch<Vec<SearchCell>, Vec<u8>>,
}

enum Chooser {
    Ours(Box<Ours>),
    Published(Explorer),
}

/// Where to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Target {
    /// Where the robot stands then.
    pub(super) place: Point2,
    /// What it looks at.
    pub(super) frontier: Point2,
}

/// Rules with their memory.
pub(super) struct Choice {
    chooser: Chooser,
    states: Vec<u8>,
    queue: Vec<u32>,
}

impl Choice {
    pub(super) fn new(rules: Rules, geometry: &GridGeometry) -> anyhow::Result<Self> {
        let cells = geometry.cell_count();
        let chooser = match rules {
            Rules::Published => Chooser::Published(Explorer::new(ExploreConfig::PUBLISHED)),
            Rules::Ours => {
                let config =
                    ViewConfig { sight_m: SIGHT_M, stand_cost: Costs::INSCRIBED, raster_m: RASTER_M };
                let storage = (vec![SearchCell::EMPTY; cells], vec![0; cells]);
                let search = ViewSearch::new(geometry, config, storage);
                let search = search.ok_or_else(|| anyhow::anyhow!("no raster for the ways"))?;
                Chooser::Ours(Box::new(Ours {
                    explorer: TourExplorer::new(TourExploreConfig::DEFAULT),
                    search,
                }))
            }
        };
        Ok(Self { chooser, states: vec![0; cells], queue: vec![0; cells] })
    }

    fn frontiers(&mut self, costmap: CostmapView<'_>, robot: Point2, size_min_m: f32) -> FrontierSearch {
        let cells_min = (size_min_m / costmap.geometry().resolution_m()).ceil() as u32;
        let mut scratch = FrontierScratch { states: &mut self.states, queue: &mut self.queue };
        find_frontiers(costmap, robot, cells_min, &mut scratch)
    }

    /// The next target; `None`: nothing is left.
    pub(super) fn next(&mut self, costmap: CostmapView<'_>, robot: Point2, passed_s: f32) -> Option<Target> {
        let size_min_m = match self.chooser {
            Chooser::Ours(_) => SIZE_MIN_M,
            Chooser::Published(_) => ExploreConfig::PUBLISHED.size_min_m,
        };
        let found = self.frontiers(costmap, robot, size_min_m);
        match &mut self.chooser {
            Chooser::Published(explorer) => {
                let by_air = |frontier: &floorguard_navigation::explore::Frontier| Some(frontier.nearest_m);
                match explorer.decide(robot, &found, by_air, passed_s) {
                    Exploration::Go(frontier) => {
                        Some(Target { place: frontier.goal_in_map, frontier: frontier.goal_in_map })
                    }
                    _ => None,
                }
            }
            Chooser::Ours(ours) => {
                let Ours { explorer, search } = ours.as_mut();
                let mut points = search.view_points(costmap, robot, &found.frontiers);
                let before = points.points.len();
                explorer.leave_out_given_up(&mut points, passed_s);
                let left_out = before - points.points.len();
                let ways = search.ways(&points.points);
                match explorer.choose(&points.points, &ways, left_out) {
                    TourExploration::Go(point) => {
                        Some(Target { place: point.place_in_map, frontier: point.frontier.centroid_in_map })
                    }
                    _ => None,
                }
            }
        }
    }

    /// The target cannot be reached, or nothing came of it.
    pub(super) fn give_up(&mut self) {
        match &mut self.chooser {
            Chooser::Ours(ours) => ours.explorer.goal_is_unreachable(),
            Chooser::Published(explorer) => explorer.goal_is_unreachable(),
        }
    }
}
