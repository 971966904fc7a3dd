//! A map that follows its building: what stood or was gone on several visits in a row is entered, what came and went is not.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use floorguard_mapping::Occupancy;
use floorguard_types::geometry::Point2;

use crate::grid_map::{CountGrid, GridMap};
use crate::se2::Se2;

/// When a change is believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpdateConfig {
    /// Visits in a row that must agree.
    pub visits: u32,
    /// A visit ends after so long without evidence, seconds: people and trolleys that stand do not stand that long.
    pub apart_s: f64,
    /// Beams through a cell, at least, for a visit to have an opinion of it.
    pub beams_least: u16,
    /// Share of the beams that end in an occupied cell, at least.
    pub occupied_share: f64,
    /// The last of a beam says nothing about free floor, metres: the place is known to some centimetres.
    pub rim_m: f64,
}

impl Default for UpdateConfig {
    fn default() -> Self {
        Self { visits: 3, apart_s: 1_800.0, beams_least: 5, occupied_share: 0.5, rim_m: 0.2 }
    }
}

/// Visits in a row that agree about a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Steady {
    is_occupied: bool,
    visits: u32,
}

/// Collects evidence of drives whose place is known, and changes the map.
#[derive(Clone, Debug)]
pub struct MapUpdater {
    config: UpdateConfig,
    map: GridMap,
    visit: CountGrid,
    last_s: Option<f64>,
    steady: BTreeMap<usize, Steady>,
    /// Cells that were changed.
    pub changed: usize,
    /// Visits that were finished.
    pub finished: u32,
}

impl MapUpdater {
    /// Of a map, without evidence.
    #[must_use]
    pub fn new(map: GridMap, config: UpdateConfig) -> Self {
        let (visit, steady) = (CountGrid::default(), BTreeMap::new());
        Self { config, map, visit, last_s: None, steady, changed: 0, finished: 0 }
    }

    /// The map as it is now.
    #[must_use]
    pub const fn map(&self) -> &GridMap {
        &self.map
    }

    /// A scan whose place is known without doubt: pose of the scanner in the map, and returns in its frame.
    pub fn enter(&mut self, time_s: f64, pose: Se2, points: &[Point2]) {
        if self.last_s.is_some_and(|last_s| (time_s - last_s).abs() > self.config.apart_s) {
            self.finish_visit();
        }
        self.last_s = Some(time_s);
        let cell =
            |place: [f64; 2]| self.map.cell_of(place).map(|value| value.clamp(-100_000, 100_000) as i32);
        let from = cell([pose.x_m, pose.y_m]);
        for point in points {
            let range_m = f64::from(point.norm());
            let share = 1.0 - self.config.rim_m / range_m.max(1.0e-3);
            let short = Point2::new(point.x_m * share as f32, point.y_m * share as f32);
            let end = cell(pose.transform(*point));
            if share > 0.0 {
                self.visit.pass(from, cell(pose.transform(short)));
            }
            self.visit.beam(end, end);
        }
    }

    /// The drive is over, or the next scan comes much later.
    pub fn finish_visit(&mut self) {
        if self.last_s.take().is_none() {
            return;
        }
        self.finished += 1;
        let visit = std::mem::take(&mut self.visit);
        for index in 0..self.map.cells.len() {
            let place = [(index % self.map.columns) as i32, (index / self.map.columns) as i32];
            let counts = visit.at(place);
            let beams = counts.hits.saturating_add(counts.passes);
            if beams < self.config.beams_least {
                continue;
            }
            let share = f64::from(counts.hits) / f64::from(beams);
            let is_occupied = share >= self.config.occupied_share;
            if !is_occupied && counts.hits > 0 {
                // It was there for a while: no opinion, and nothing steady.
                self.steady.remove(&index);
                continue;
            }
            self.agree(index, is_occupied);
        }
    }

    fn agree(&mut self, index: usize, is_occupied: bool) {
        let state = if is_occupied { Occupancy::Occupied } else { Occupancy::Free };
        if self.map.cells[index] == state {
            self.steady.remove(&index);
            return;
        }
        let before = self.steady.get(&index).filter(|steady| steady.is_occupied == is_occupied);
        let visits = before.map_or(0, |steady| steady.visits) + 1;
        if visits >= self.config.visits {
            self.map.cells[index] = state;
            self.changed += 1;
            self.steady.remove(&index);
        } else {
            self.steady.insert(index, Steady { is_occupied, visits });
        }
    }

    /// The evidence so far, for the next drive: a line for each cell with its number, `o` or `f`, and visits.
    #[must_use]
    pub fn evidence(&self) -> String {
        let mut text = format!("cells {} {}\n", self.map.columns, self.map.rows);
        for (index, steady) in &self.steady {
            let state = if steady.is_occupied { 'o' } else { 'f' };
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{index} {state} {}", steady.visits);
        }
        text + "end\n"
    }

    /// Goes on with the evidence of earlier drives; false, and nothing is used, if it is cut, or of a map of another size.
    pub fn resume(&mut self, evidence: &str) -> bool {
        let mut lines = evidence.lines();
        let size = format!("cells {} {}", self.map.columns, self.map.rows);
        if lines.next() != Some(size.as_str()) || !evidence.ends_with("end\n") {
            return false;
        }
        let mut steady = BTreeMap::new();
        for line in lines.take_while(|line| *line != "end") {
            let words: Vec<&str> = line.split(' ').collect();
            let [index, state, visits] = words.as_slice() else { return false };
            let (Ok(index), Ok(visits)) = (index.parse::<usize>(), visits.parse()) else { return false };
            if index >= self.map.cells.len() || !["o", "f"].contains(state) {
                return false;
            }
            steady.insert(index, Steady { is_occupied: *state == "o", visits });
        }
        self.steady = steady;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A room of 6 m with a shelf; `shelf` is its left side, metres, and `trolley` stands at 1.5 m, 4.5 m.
    fn range_m(place: [f64; 2], angle: f64, shelf: f64, trolley: bool) -> f64 {
        let (sin, cos) = angle.sin_cos();
        let is_solid = |x: f64, y: f64| {
            let is_wall = x < 0.1 || y < 0.1 || x > 5.9 || y > 5.9;
            let is_shelf = (shelf..shelf + 0.6).contains(&x) && (1.0..2.0).contains(&y);
            is_wall || is_shelf || trolley && (1.3..1.7).contains(&x) && (4.3..4.7).contains(&y)
        };
        let hit = (0..1_200).map(|step| 0.01 * f64::from(step));
        let mut hit = hit.skip_while(|along| !is_solid(place[0] + along * cos, place[1] + along * sin));
        hit.next().unwrap_or(12.0)
    }

    fn visit(updater: &mut MapUpdater, day: u32, shelf: f64, trolley: bool) {
        for (index, place) in [[3.0, 3.0], [1.0, 3.2], [5.0, 3.0], [3.0, 5.0]].into_iter().enumerate() {
            let pose = Se2::new(place[0], place[1], 0.3);
            let point = |step: i32| {
                let angle = f64::from(step).to_radians();
                let range = range_m(place, 0.3 + angle, shelf, trolley);
                Point2::new((range * angle.cos()) as f32, (range * angle.sin()) as f32)
            };
            let points: Vec<Point2> = (-180..180).map(point).collect();
            for scan in 0..6 {
                updater.enter(
                    86_400.0 * f64::from(day) + index as f64 + 0.1 * f64::from(scan),
                    pose,
                    &points,
                );
            }
        }
    }

    #[test]
    fn moved_shelf_is_entered_and_trolleys_never() {
        let cells = vec![Occupancy::Free; 120 * 120];
        let empty = GridMap { columns: 120, rows: 120, cell_m: 0.05, corner_m: [0.0, 0.0], cells };
        let mut updater = MapUpdater::new(empty, UpdateConfig::default());
        let occupied = |updater: &MapUpdater, x: f64, y: f64| {
            let [column, row] = updater.map().cell_of([x, y]);
            (-1..=1).any(|by| updater.map().at(column, row + by) == Occupancy::Occupied)
        };
        // Three days with the shelf at 2 m; the trolley stands there on two of them.
        for day in 0..3 {
            visit(&mut updater, day, 2.0, day < 2);
        }
        updater.finish_visit();
        assert!(occupied(&updater, 2.3, 2.0) && occupied(&updater, 0.08, 3.0));
        assert!(!occupied(&updater, 1.7, 4.5), "trolley");
        // It is moved: two more days say nothing yet, also across two programs, the third does.
        for day in 3..5 {
            visit(&mut updater, day, 3.5, day == 4);
        }
        updater.finish_visit();
        assert!(occupied(&updater, 2.3, 2.0) && !occupied(&updater, 3.8, 2.0));
        let mut next = MapUpdater::new(updater.map().clone(), UpdateConfig::default());
        let evidence = updater.evidence();
        for cut in (0..evidence.len()).step_by(97) {
            assert!(!next.resume(&evidence[..cut]), "{cut}");
        }
        assert!(next.resume(&evidence));
        visit(&mut next, 5, 3.5, false);
        next.finish_visit();
        assert!(!occupied(&next, 2.3, 2.0) && occupied(&next, 3.8, 2.0));
        assert!(!occupied(&next, 1.7, 4.5), "trolley");
    }
}
