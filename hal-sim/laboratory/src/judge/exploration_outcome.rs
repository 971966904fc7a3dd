//! A map that the robot made, judged by the true building.

use floorguard_mapping::Occupancy;
use floorguard_robot::navigator::SurveyedMap;
use floorguard_robot::site::{CELL_M, Floor};
use serde::Serialize;

/// Known of the floor that the robot can reach, at least.
const KNOWN_MIN: f64 = 0.99;
/// A surface of the map this far from every true one is wrong, metres.
const SURFACE_OFF_M: f32 = 0.2;

/// What an exploration came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ExplorationReport {
    /// The robot itself says that nothing is left.
    pub ended: bool,
    /// Floor that the robot can reach, square metres.
    pub floor_m2: f64,
    /// Share of it that the map shows as free.
    pub known_share: f64,
    /// Share of the map's surfaces that lie within 0.2 m of a true one.
    pub true_surfaces_share: f64,
    /// Scans that were kept.
    pub kept_scans: usize,
    /// Places that were recognised.
    pub loops: usize,
}

impl ExplorationReport {
    /// Of a map in the true frame, beside the true floor.
    #[must_use]
    pub fn of(surveyed: &SurveyedMap, floor: &Floor, ended: bool) -> Self {
        let map = &surveyed.map;
        let at = |x_m: f32, y_m: f32| {
            let [column, row] = map.cell_of([f64::from(x_m), f64::from(y_m)]);
            map.at(column, row)
        };
        let reachable: Vec<_> = (0..floor.cells.cell_count())
            .filter(|&cell| floor.passable[cell])
            .map(|cell| floor.cells.centre(cell))
            .collect();
        let known = reachable.iter().filter(|place| at(place.x_m, place.y_m) == Occupancy::Free).count();
        let surfaces: Vec<usize> =
            (0..map.cells.len()).filter(|&cell| map.cells[cell] == Occupancy::Occupied).collect();
        let is_true = |&&cell: &&usize| {
            let [x_m, y_m] = map.centre_m(cell);
            let place = floorguard_types::geometry::Point2::new(x_m as f32, y_m as f32);
            floor.surfaces.clearance_m(place) <= SURFACE_OFF_M
        };
        let share = |part: usize, all: usize| part as f64 / all.max(1) as f64;
        Self {
            ended,
            floor_m2: reachable.len() as f64 * f64::from(CELL_M * CELL_M),
            known_share: share(known, reachable.len()),
            true_surfaces_share: share(surfaces.iter().filter(is_true).count(), surfaces.len()),
            kept_scans: surveyed.kept_scans,
            loops: surveyed.loops,
        }
    }

    /// What was asked for and not reached.
    pub(super) fn shortfall(&self, reason: &str) -> Option<String> {
        if !self.ended {
            return Some(format!("the exploration has not ended: {reason}"));
        }
        (self.known_share < KNOWN_MIN).then(|| {
            format!(
                "the robot says that it is done, and the map shows {:.1} % of {:.0} m² that it can reach",
                100.0 * self.known_share,
                self.floor_m2
            )
        })
    }

    /// In one line, for people.
    #[must_use]
    pub fn words(&self) -> String {
        format!(
            "{:.1} % of {:.0} m² of reachable floor on the map, {:.1} % of its surfaces true; {} scans kept, {} places recognised",
            100.0 * self.known_share,
            self.floor_m2,
            100.0 * self.true_surfaces_share,
            self.kept_scans,
            self.loops
        )
    }
}
