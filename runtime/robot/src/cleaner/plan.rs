//! The input of a mission: the map, the dirt that is expected, and how to decide where to clean.

use std::path::Path;

use floorguard_mapping::poisson_tail;
use floorguard_mapping::{DirtCell, Grid, GridGeometry, Occupancy};
use floorguard_types::geometry::{Point2, Pose2};
use serde::{Deserialize, Serialize};

use super::areas::{Area, AreaKind};
use crate::site::read_places;
use crate::site::ros_map::{self, OccupancyMap};
use floorguard_configuration::{CleaningStrategy, MissionConfiguration};

/// Edge of the square on which a listed place of dirt lies, metres.
const DIRT_EDGE_M: f32 = 0.1;

/// How the robot decides where to clean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum MissionStrategy {
    /// Visits what is dirty and plans again until the belief says that all is clean.
    Guarantee,
    /// Lanes over the whole floor.
    Systematic,
    /// The scenario's route, whatever lies there.
    Route,
}

impl MissionStrategy {
    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Guarantee => "guarantee",
            Self::Systematic => "systematic",
            Self::Route => "route",
        }
    }
}

/// A map as runs of equal pixels, along x first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MapRuns {
    size: [u16; 2],
    resolution_m: f32,
    origin_m: [f32; 2],
    /// Kind of pixel (0 unknown, 1 free, 2 occupied) and how many.
    runs: Vec<(u8, u32)>,
}

/// Dirt that is expected on a square of the map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExpectedDirt {
    /// Lower left corner, map frame, metres.
    pub corner_m: [f32; 2],
    /// Edge, metres.
    pub edge_m: f32,
    /// Units.
    pub units: f32,
}

/// How a mission begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanBegin {
    /// How the robot decides where to clean.
    pub strategy: MissionStrategy,
    /// Where the robot begins.
    pub pose_in_map: Pose2,
    /// Seed of the belief's randomness.
    pub seed: u64,
}

/// A mission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MissionPlan {
    /// How to decide.
    pub strategy: MissionStrategy,
    /// Where the robot begins: x, y in metres and heading in radians, map frame.
    pub start: [f32; 3],
    /// Seed of the belief's randomness.
    pub seed: u64,
    /// Units that may stay in a clean cell, τ.
    pub tolerated_units: u8,
    /// Probability with which a cell called clean may hold more, δ.
    pub delta: f64,
    /// What is expected where.
    pub dirt: Vec<ExpectedDirt>,
    /// Areas that an operator has drawn; none: the whole floor, everywhere at the same speed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub areas: Vec<Area>,
    map: MapRuns,
}

impl MissionPlan {
    /// On a map, with the dirt that is expected there; five units tolerated with a risk of 1 %.
    #[must_use]
    pub fn on_map(begin: PlanBegin, dirt: Vec<ExpectedDirt>, map: &OccupancyMap) -> Self {
        let start = [begin.pose_in_map.x_m, begin.pose_in_map.y_m, begin.pose_in_map.heading_rad];
        let PlanBegin { strategy, seed, .. } = begin;
        Self {
            strategy,
            start,
            seed,
            tolerated_units: 5,
            delta: 0.01,
            dirt,
            areas: Vec::new(),
            map: MapRuns::of(map),
        }
    }

    /// Of a `[mission]` in a robot.toml that lies in `folder`.
    ///
    /// # Errors
    /// The map or the dirt cannot be read, or no dirt lies on the map.
    pub fn of_configuration(mission: &MissionConfiguration, folder: &Path) -> anyhow::Result<Self> {
        let map = ros_map::load(&folder.join(&mission.map))?;
        let places = mission.dirt.as_ref().map(|dirt| read_places(&folder.join(dirt))).transpose()?;
        let edge_m = DIRT_EDGE_M;
        let on_map =
            places.into_iter().flatten().filter(|(place, _)| map.geometry().cell_at(*place).is_some());
        let dirt: Vec<ExpectedDirt> = on_map
            .map(|(place, units)| ExpectedDirt {
                corner_m: [place.x_m - 0.5 * edge_m, place.y_m - 0.5 * edge_m],
                edge_m,
                units,
            })
            .collect();
        anyhow::ensure!(
            mission.dirt.is_none() || !dirt.is_empty(),
            "no dirt of {:?} lies on the map {:?}",
            mission.dirt.clone().unwrap_or_default(),
            mission.map
        );
        Ok(Self {
            strategy: match mission.strategy {
                CleaningStrategy::Guarantee => MissionStrategy::Guarantee,
                CleaningStrategy::Systematic => MissionStrategy::Systematic,
            },
            start: mission.start,
            seed: 1,
            tolerated_units: mission.tolerated_units,
            delta: f64::from(mission.delta),
            dirt,
            areas: Vec::new(),
            map: MapRuns::of(&map),
        })
    }

    /// Where the robot begins, map frame.
    #[must_use]
    pub fn start_pose(&self) -> Pose2 {
        let [x_m, y_m, heading_rad] = self.start;
        Pose2::new(x_m, y_m, heading_rad)
    }

    /// The place lies in an area of this kind.
    #[must_use]
    pub fn lies_in(&self, kind: AreaKind, place: Point2) -> bool {
        self.areas.iter().any(|area| area.kind == kind && area.contains(place))
    }

    /// There is an area of this kind.
    #[must_use]
    pub fn has(&self, kind: AreaKind) -> bool {
        self.areas.iter().any(|area| area.kind == kind)
    }

    /// The map.
    ///
    /// # Errors
    /// The runs do not make one.
    pub fn occupancy(&self) -> anyhow::Result<OccupancyMap> {
        self.map.map()
    }

    /// What is expected in each cell of a raster. Dirt is spread evenly over its square.
    #[must_use]
    pub fn expected_on(&self, raster: &GridGeometry) -> Vec<f32> {
        let mut expected = vec![0.0; raster.cell_count()];
        for dirt in &self.dirt {
            let [x_m, y_m] = dirt.corner_m;
            let (low, high) = (Point2::new(x_m, y_m), Point2::new(x_m + dirt.edge_m, y_m + dirt.edge_m));
            let (first, last) = (raster.coordinates_of(low), raster.coordinates_of(high));
            for (column, row) in (first.row..=last.row)
                .flat_map(|row| (first.column..=last.column).map(move |column| (column, row)))
            {
                let Some(cell) = raster.index(column, row) else { continue };
                let (centre, half_m) = (raster.centre(cell), 0.5 * raster.resolution_m());
                let overlap = |from: f32, to: f32, middle: f32| {
                    (to.min(middle + half_m) - from.max(middle - half_m)).max(0.0)
                };
                let area = overlap(low.x_m, high.x_m, centre.x_m) * overlap(low.y_m, high.y_m, centre.y_m);
                expected[cell] += dirt.units * area / (dirt.edge_m * dirt.edge_m);
            }
        }
        expected
    }

    /// The belief about each cell before the mission.
    #[must_use]
    pub fn prior(&self, expected: &[f32]) -> Vec<DirtCell> {
        let tolerated = u32::from(self.tolerated_units);
        let cell = |units: &f32| DirtCell::poisson(*units, poisson_tail(tolerated, f64::from(*units)) as f32);
        expected.iter().map(cell).collect()
    }

    /// As one line of text, for recordings.
    ///
    /// # Errors
    /// A non-finite number.
    pub fn to_text(&self) -> anyhow::Result<String> {
        Ok(serde_json::to_string(self)?)
    }

    /// From such a line.
    ///
    /// # Errors
    /// It is no plan.
    pub fn from_text(text: &str) -> anyhow::Result<Self> {
        Ok(serde_json::from_str(text)?)
    }
}

impl MapRuns {
    pub(crate) fn of(map: &OccupancyMap) -> Self {
        let geometry = map.geometry();
        let mut runs: Vec<(u8, u32)> = Vec::new();
        for cell in map.values() {
            let kind = *cell as u8;
            match runs.last_mut().filter(|(last, _)| *last == kind) {
                Some((_, count)) => *count += 1,
                None => runs.push((kind, 1)),
            }
        }
        let origin = geometry.origin_in_map();
        Self {
            size: [geometry.width(), geometry.height()],
            resolution_m: geometry.resolution_m(),
            origin_m: [origin.x_m, origin.y_m],
            runs,
        }
    }

    pub(crate) fn map(&self) -> anyhow::Result<OccupancyMap> {
        let corner = Point2::new(self.origin_m[0], self.origin_m[1]);
        let geometry = GridGeometry::new(self.size[0], self.size[1], self.resolution_m, corner)
            .ok_or_else(|| anyhow::anyhow!("the map of the mission has no size"))?;
        let count: u64 = self.runs.iter().map(|(_, count)| u64::from(*count)).sum();
        anyhow::ensure!(count == geometry.cell_count() as u64, "the map of the mission is incomplete");
        let kind = |kind: u8| match kind {
            1 => Occupancy::Free,
            2 => Occupancy::Occupied,
            _ => Occupancy::Unknown,
        };
        let cells =
            self.runs.iter().flat_map(|(run, count)| std::iter::repeat_n(kind(*run), *count as usize));
        Ok(Grid::new(geometry, cells.collect())?)
    }
}

#[cfg(test)]
impl MissionPlan {
    /// The plan that the laboratory draws of the simulated supermarket; a test there holds it to the file.
    pub(crate) fn supermarket() -> Self {
        Self::from_text(include_str!("supermarket.json").trim_end()).expect("the file holds a plan")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plan_survives_text_and_map_shows_scene() {
        let plan = MissionPlan::supermarket();
        assert_eq!(MissionPlan::from_text(&plan.to_text().unwrap()).unwrap(), plan);
        let map = plan.occupancy().unwrap();
        let at = |x_m, y_m| map.get(map.geometry().cell_at(Point2::new(x_m, y_m)).unwrap()).copied().unwrap();
        assert_eq!(at(5.0, 0.0), Occupancy::Free);
        assert_eq!(at(5.0, 2.1), Occupancy::Occupied);
        // Under the table there is no floor for a robot, and no surface for its scanner.
        assert_eq!(at(16.8, 2.0), Occupancy::Unknown);
        assert!(MissionPlan::from_text("{}").is_err());
    }

    #[test]
    fn expectation_is_kept_on_any_raster() {
        let plan = MissionPlan::supermarket();
        let raster = GridGeometry::new(300, 300, 0.1, Point2::new(-8.03, -8.07)).unwrap();
        let all: f32 = plan.dirt.iter().map(|dirt| dirt.units).sum();
        assert!(all > 0.0);
        let spread: f32 = plan.expected_on(&raster).iter().sum();
        assert!((spread - all).abs() < 0.001 * all, "{spread} of {all}");
    }

    /// A field of 70 x 70 m: a robot that drives there does not know where it is, and what it claimed would be false.
    #[test]
    fn only_cells_in_sight_of_walls_count() {
        let robot =
            floorguard_configuration::parse("robot.toml", floorguard_configuration::EXAMPLE).unwrap().robot;
        let whole = MissionPlan::supermarket();
        let geometry = GridGeometry::new(700, 700, 0.1, Point2::new(-35.0, -35.0)).unwrap();
        let begin = |walls: i32| {
            let wall = |i: usize| geometry.coordinates(i).column < walls;
            let state = |i: usize| if wall(i) { Occupancy::Occupied } else { Occupancy::Free };
            let map = Grid::new(geometry, (0..geometry.cell_count()).map(state).collect()).unwrap();
            let plan =
                MissionPlan { map: MapRuns::of(&map), start: [0.0; 3], dirt: Vec::new(), ..whole.clone() };
            let setup =
                crate::cleaner::MissionSetup::new(plan, crate::cleaner::Store::Memory(Default::default()));
            setup.begin(&robot)
        };
        let refused = begin(0).err().unwrap().to_string();
        assert!(refused.contains("no wall within 25 m"), "{refused}");
        let hall = begin(3).unwrap();
        let answered =
            (0..hall.ground.floor.reachable.len()).filter(|cell| hall.ground.floor.reachable[*cell]);
        let farthest_m = answered.map(|cell| hall.ground.raster().centre(cell).x_m).fold(f32::MIN, f32::max);
        assert!((-11.0..-8.0).contains(&farthest_m), "{farthest_m}");
    }
}
