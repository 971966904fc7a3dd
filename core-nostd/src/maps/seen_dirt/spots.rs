//! Spots of dirt: dirty cells that touch, with place, size and age.
//!
//! One pass over the rows joins runs of dirty cells with those of the row before; a run that touches two parts makes
//! them one. What does not fit is counted.

use heapless::Vec;

use super::cell::{CellState, DirtLimit, SeenCell, SeenLayer};
use super::map::SeenDirtMap;
use crate::geometry::Point2;
use crate::time::Stamp;

/// Spots in a report (algorithms F.2).
pub const SPOTS_MAX: usize = 128;
/// Parts of spots while the rows are read, and runs of a row.
const PARTS_MAX: usize = 512;
const RUNS_MAX: usize = 256;
/// Least evidence of a spot: sum over its cells of what exceeds the limit, natural logarithms. It takes two cells of
/// which one sees little (algorithms F.2), or a single one that sees much: a puddle of 6 cm fits into one.
const EVIDENCE_MIN: f32 = 2.5;
/// Some cell must exceed the limit by this much: many that hardly do are a shade of the floor.
const PEAK_MIN: f32 = 1.0;

/// A spot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DirtSpot {
    /// Middle of its cells, in the map frame.
    pub centre_in_map: Point2,
    /// Corners of the rectangle around it, in the map frame.
    pub low_in_map: Point2,
    /// The other corner.
    pub high_in_map: Point2,
    /// Area of its cells, square metres.
    pub area_m2: f32,
    /// Mean by which its cells exceed the limit, natural logarithms.
    pub score: f32,
    /// Seconds since it was first perceived as dirt.
    pub age_s: f32,
    /// Observations of its cells, the most.
    pub observations: u16,
}

/// The largest spots, largest first.
#[derive(Clone, Debug, Default)]
pub struct DirtSpots {
    /// The spots.
    pub spots: Vec<DirtSpot, SPOTS_MAX>,
    /// Spots for which there was no room.
    pub dropped: u32,
}

/// Cells of one row that touch.
#[derive(Clone, Copy)]
struct Run {
    first: usize,
    last: usize,
    part: u16,
}

/// What is summed of a part; `root` is the part it was joined to, or itself.
#[derive(Clone, Copy, Default)]
struct Part {
    root: u16,
    cells: u32,
    sum: [f32; 2],
    low: [f32; 2],
    high: [f32; 2],
    score: f32,
    peak: f32,
    since_s: u32,
    observations: u16,
}

#[derive(Default)]
struct Parts {
    list: Vec<Part, PARTS_MAX>,
    dropped: u32,
}

impl<C: AsRef<[SeenCell]> + AsMut<[SeenCell]>> SeenDirtMap<C> {
    /// The spots of a layer, at the time `now`.
    #[must_use]
    pub fn spots(&self, layer: SeenLayer, now: Stamp) -> DirtSpots {
        self.spots_beyond(self.limit(), layer, now)
    }

    /// The same with another limit than the map's own: how much of what is found hangs on it.
    #[must_use]
    pub fn spots_beyond(&self, limit: DirtLimit, layer: SeenLayer, now: Stamp) -> DirtSpots {
        let mut parts = Parts::default();
        let mut above: Vec<Run, RUNS_MAX> = Vec::new();
        let width = usize::from(self.geometry().width()).max(1);
        for (row, cells) in self.cells().chunks(width).enumerate() {
            let mut runs = runs(cells, (layer, limit), &mut parts.dropped);
            for run in &mut runs {
                run.part = parts.open();
                for cell in run.first..=run.last.min(usize::from(u16::MAX)) {
                    let centre = self.geometry().centre(row.saturating_mul(width).saturating_add(cell));
                    if let Some(cell) = cells.get(cell) {
                        let excess = cell.excess(layer, limit).unwrap_or(0.0);
                        parts.grow(run.part, (centre, excess), cell);
                    }
                }
                let touching = above.iter().filter(|other| {
                    other.first <= run.last.saturating_add(1) && run.first <= other.last.saturating_add(1)
                });
                for other in touching {
                    parts.join(other.part, run.part);
                }
            }
            above = runs;
        }
        parts.finish(self.geometry().resolution_m(), now)
    }
}

/// Runs of dirty cells of a row, without a part yet.
fn runs(cells: &[SeenCell], (layer, limit): (SeenLayer, DirtLimit), dropped: &mut u32) -> Vec<Run, RUNS_MAX> {
    let mut runs: Vec<Run, RUNS_MAX> = Vec::new();
    for (column, cell) in cells.iter().enumerate() {
        if cell.state(layer, limit) != CellState::Dirty {
            continue;
        }
        match runs.last_mut().filter(|run| run.last.saturating_add(1) == column) {
            Some(run) => run.last = column,
            None => {
                if runs.push(Run { first: column, last: column, part: 0 }).is_err() {
                    *dropped = dropped.saturating_add(1);
                }
            }
        }
    }
    runs
}

impl Parts {
    /// A new part; the last one where there is no room, counted.
    fn open(&mut self) -> u16 {
        // The capacity fits 16 bits.
        let index = self.list.len() as u16;
        let part = Part {
            root: index,
            low: [f32::MAX; 2],
            high: [f32::MIN; 2],
            since_s: u32::MAX,
            ..Part::default()
        };
        if self.list.push(part).is_err() {
            self.dropped = self.dropped.saturating_add(1);
            return index.saturating_sub(1);
        }
        index
    }

    fn grow(&mut self, part: u16, (centre, excess): (Point2, f32), cell: &SeenCell) {
        let root = self.root(part);
        let Some(part) = self.list.get_mut(usize::from(root)) else { return };
        part.cells = part.cells.saturating_add(1);
        let place = [centre.x_m, centre.y_m];
        for ((sum, low), (high, value)) in
            part.sum.iter_mut().zip(&mut part.low).zip(part.high.iter_mut().zip(place))
        {
            *sum += value;
            *low = low.min(value);
            *high = high.max(value);
        }
        part.score += excess;
        part.peak = part.peak.max(excess);
        part.since_s = part.since_s.min(cell.dirty_since_s());
        part.observations = part.observations.max(cell.observations());
    }

    /// The part that a part was joined to. Joining always points to a root, so chains are short; the bound is the
    /// number of parts.
    fn root(&self, part: u16) -> u16 {
        let mut root = part;
        for _ in 0..PARTS_MAX {
            let next = self.list.get(usize::from(root)).map_or(root, |part| part.root);
            if next == root {
                break;
            }
            root = next;
        }
        root
    }

    /// Makes two parts one.
    fn join(&mut self, into: u16, from: u16) {
        let (into, from) = (self.root(into), self.root(from));
        if into == from {
            return;
        }
        let Some(moved) = self.list.get_mut(usize::from(from)).map(|part| {
            let moved = *part;
            *part = Part { root: into, ..Part::default() };
            moved
        }) else {
            return;
        };
        if let Some(part) = self.list.get_mut(usize::from(into)) {
            part.cells = part.cells.saturating_add(moved.cells);
            for (sum, value) in part.sum.iter_mut().zip(moved.sum) {
                *sum += value;
            }
            for (low, value) in part.low.iter_mut().zip(moved.low) {
                *low = low.min(value);
            }
            for (high, value) in part.high.iter_mut().zip(moved.high) {
                *high = high.max(value);
            }
            part.score += moved.score;
            part.peak = part.peak.max(moved.peak);
            part.since_s = part.since_s.min(moved.since_s);
            part.observations = part.observations.max(moved.observations);
        }
    }

    /// Spots, largest first.
    fn finish(self, cell_m: f32, now: Stamp) -> DirtSpots {
        let mut found = DirtSpots { spots: Vec::new(), dropped: self.dropped };
        let is_evident = |part: &&Part| part.score >= EVIDENCE_MIN && part.peak >= PEAK_MIN;
        let large = self.list.iter().filter(is_evident);
        for spot in large.map(|part| part.spot(cell_m, now)) {
            let place = found.spots.iter().position(|other| other.area_m2 < spot.area_m2);
            let place = place.unwrap_or(found.spots.len());
            if found.spots.is_full() {
                found.dropped = found.dropped.saturating_add(1);
                if place < SPOTS_MAX {
                    let _ = found.spots.pop();
                }
            }
            // Where the list is still full this spot is the smallest, and counted above.
            let _ = found.spots.insert(place, spot);
        }
        found
    }
}

impl Part {
    fn spot(&self, cell_m: f32, now: Stamp) -> DirtSpot {
        let count = (self.cells as f32).max(1.0);
        let ([x, y], [low_x, low_y], [high_x, high_y]) = (self.sum, self.low, self.high);
        let half = 0.5 * cell_m;
        let since = Stamp::from_micros(u64::from(self.since_s).saturating_mul(1_000_000));
        DirtSpot {
            centre_in_map: Point2::new(x / count, y / count),
            low_in_map: Point2::new(low_x - half, low_y - half),
            high_in_map: Point2::new(high_x + half, high_y + half),
            area_m2: count * cell_m * cell_m,
            score: self.score / count,
            age_s: now.seconds_since(since).max(0.0),
            observations: self.observations,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::cell::KeptScore;
    use super::super::tint::FloorTints;
    use super::*;
    use crate::maps::GridGeometry;

    /// Cells with dirt from a drawing: `#` is dirty, `*` very.
    fn map(drawing: &[&str]) -> std::vec::Vec<SeenCell> {
        let cell = |mark: char| {
            let mut cell = SeenCell::default();
            let score = KeptScore::of(match mark {
                '#' => 22.3,
                '*' => 24.0,
                _ => 9.0,
            });
            let limit = DirtLimit { score: KeptScore::of(21.0), tint: KeptScore::of(21.0) };
            (5..9).for_each(|second| cell.observe((score, [0; 3]), &FloorTints::NEW, (limit, second)));
            cell
        };
        drawing.iter().flat_map(|line| line.chars().map(cell)).collect()
    }

    #[test]
    fn what_touches_is_one_spot() {
        let mut cells = map(&[
            "#...#....", //
            "#...#..#.", //
            "#.###....", //
            ".#.....##", //
            "...*...##", //
        ]);
        let geometry = GridGeometry::new(9, 5, 0.1, Point2::new(1.0, 2.0)).unwrap();
        let mut map = SeenDirtMap::new(geometry, &mut cells[..]).unwrap();
        map.expect(21.0);
        let found = map.spots(SeenLayer::Live, Stamp::from_micros(67_000_000));
        assert_eq!((found.spots.len(), found.dropped), (3, 0), "a weak cell alone is none: {found:?}");
        let [large, small, single] = &found.spots[..] else { panic!("{found:?}") };
        assert!((large.area_m2 - 0.09).abs() < 1e-4 && (small.area_m2 - 0.04).abs() < 1e-4);
        assert!(small.centre_in_map.distance(Point2::new(1.8, 2.4)) < 1e-4, "{small:?}");
        assert!(single.centre_in_map.distance(Point2::new(1.35, 2.45)) < 1e-4, "{single:?}");
        assert!((small.age_s - 60.0).abs() < 1e-3 && small.observations == 4);
        assert!(large.low_in_map.distance(Point2::new(1.0, 2.0)) < 1e-4, "{large:?}");
    }
}
