//! Spots of dirt: dirty cells that touch, with place, size and age.
//!
//! One pass over the rows joins runs of dirty cells with those of the row before; a run that touches two parts makes
//! them one ([`UnitedParts`]). What does not fit is counted.

use heapless::Vec;

use super::cell::SeenCell;
use super::limit::{CellState, DirtLimit, SeenLayer};
use super::map::SeenDirtMap;
use floorguard_types::geometry::Point2;
use floorguard_types::number::nearest_f32;
use floorguard_types::profile::Of;
use floorguard_types::time::Stamp;
use floorguard_types::united_parts::{Absorb, UnitedParts};

/// Spots in a report (book, Floor and dirt: Spots).
pub const SPOTS_MAX: usize = 128;
/// Parts of spots while the rows are read, and runs of a row.
const PARTS_MAX: usize = 512;
const RUNS_MAX: usize = 256;
/// Least evidence of a spot: sum over its cells of what exceeds the limit, natural logarithms. It takes two cells of
/// which one sees little (book, Floor and dirt: Spots), or a single one that sees much: a puddle of 6 cm fits into one.
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
    /// Seconds since it was first perceived as dirt ([`SeenCell::dirty_since_s`], the earliest of its cells).
    pub age_s: f32,
    /// Observations of its cells, the most.
    pub observations: u16,
}

/// The largest spots, largest first.
#[derive(Clone, Debug, Default)]
pub struct DirtSpots {
    /// The spots.
    pub spots: Vec<DirtSpot, SPOTS_MAX>,
    /// Pieces of spots that did not fit while the rows were read (runs of cells of a row, beyond the runs of a row
    /// single cells), and spots beyond the capacity.
    pub dropped: u32,
}

/// Cells of one row that touch, and the part that they belong to; `None` where the list was full.
#[derive(Clone, Copy)]
struct Run {
    first: usize,
    last: usize,
    part: Option<u16>,
}

/// What is summed of a part: metres in the map frame, natural logarithms, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    cells: u32,
    sum: [f32; 2],
    low: [f32; 2],
    high: [f32; 2],
    score: f32,
    peak: f32,
    since_s: u32,
    observations: u16,
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
        let mut parts = UnitedParts::<Part, Of<PARTS_MAX>>::default();
        let mut above: Vec<Run, RUNS_MAX> = Vec::new();
        let mut dropped = 0_u32;
        let width = usize::from(self.geometry().width()).max(1);
        for (row, cells) in self.cells().chunks(width).enumerate() {
            let mut runs = runs(cells, (layer, limit), &mut dropped);
            for run in &mut runs {
                let own = self.part_of(run, (row.saturating_mul(width), cells), (layer, limit));
                let touching = above.iter().filter(|other| {
                    other.first <= run.last.saturating_add(1) && run.first <= other.last.saturating_add(1)
                });
                run.part = parts.join(touching.filter_map(|other| other.part), &own).ok();
                dropped = dropped.saturating_add(u32::from(run.part.is_none()));
            }
            above = runs;
        }
        largest(&parts, dropped, |part| part.spot(self.geometry().resolution_m(), now))
    }

    /// The cells of a run, of which the row begins with the cell `start`, as a part.
    fn part_of(
        &self,
        run: &Run,
        (start, cells): (usize, &[SeenCell]),
        (layer, limit): (SeenLayer, DirtLimit),
    ) -> Part {
        let mut part = Part::NOTHING;
        for column in run.first..=run.last.min(usize::from(u16::MAX)) {
            if let Some(cell) = cells.get(column) {
                let centre = self.geometry().centre(start.saturating_add(column));
                part.absorb(&Part::of((cell, layer), centre, cell.excess(layer, limit).unwrap_or(0.0)));
            }
        }
        part
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
                if runs.push(Run { first: column, last: column, part: None }).is_err() {
                    *dropped = dropped.saturating_add(1);
                }
            }
        }
    }
    runs
}

/// Spots of the parts that are evident, largest first.
fn largest(
    parts: &UnitedParts<Part, Of<PARTS_MAX>>,
    dropped: u32,
    spot: impl Fn(&Part) -> DirtSpot,
) -> DirtSpots {
    let mut found = DirtSpots { spots: Vec::new(), dropped };
    let is_evident = |part: &&Part| part.score >= EVIDENCE_MIN && part.peak >= PEAK_MIN;
    for spot in parts.finished().filter(is_evident).map(spot) {
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

impl Absorb for Part {
    fn absorb(&mut self, other: &Self) {
        self.cells = self.cells.saturating_add(other.cells);
        for (sum, value) in self.sum.iter_mut().zip(other.sum) {
            *sum += value;
        }
        for (low, value) in self.low.iter_mut().zip(other.low) {
            *low = low.min(value);
        }
        for (high, value) in self.high.iter_mut().zip(other.high) {
            *high = high.max(value);
        }
        self.score += other.score;
        self.peak = self.peak.max(other.peak);
        self.since_s = self.since_s.min(other.since_s);
        self.observations = self.observations.max(other.observations);
    }
}

impl Part {
    /// Of no cell.
    const NOTHING: Self = Self {
        cells: 0,
        sum: [0.0; 2],
        low: [f32::MAX; 2],
        high: [f32::MIN; 2],
        score: 0.0,
        peak: 0.0,
        since_s: u32::MAX,
        observations: 0,
    };

    /// Of one cell.
    fn of((cell, layer): (&SeenCell, SeenLayer), centre: Point2, excess: f32) -> Self {
        let place = [centre.x_m, centre.y_m];
        Self {
            cells: 1,
            sum: place,
            low: place,
            high: place,
            score: excess,
            peak: excess,
            since_s: cell.dirty_since_s(layer),
            observations: cell.observations(),
        }
    }

    fn spot(&self, cell_m: f32, now: Stamp) -> DirtSpot {
        let count = nearest_f32(self.cells).max(1.0);
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
    use super::super::limit::KeptScore;
    use super::super::tint::FloorTints;
    use super::*;
    use crate::GridGeometry;

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

    /// A cell that was below the limit whenever it was examined, and is above that of today, is as old as its last
    /// view; it does not make the spot as old as the clock, nor one that was found dirty before any younger.
    #[test]
    fn a_limit_that_falls_makes_nothing_old() {
        let view = |limit: f32, seconds: core::ops::Range<u32>| {
            let limit = DirtLimit { score: KeptScore::of(limit), tint: KeptScore::of(limit) };
            let mut cell = SeenCell::default();
            let seen = (KeptScore::of(24.0), [0; 3]);
            seconds.for_each(|second| cell.observe(seen, &FloorTints::NEW, (limit, second)));
            cell
        };
        let cells = [view(30.0, 5..9), view(21.0, 9..20)];
        let geometry = GridGeometry::new(2, 1, 0.1, Point2::new(0.0, 0.0)).unwrap();
        for (seen, expected_s) in [(cells, 59.0), ([cells[0], cells[0]], 59.0), ([cells[1], cells[1]], 56.0)]
        {
            let mut map = SeenDirtMap::new(geometry, seen).unwrap();
            map.expect(21.0);
            for layer in [SeenLayer::First, SeenLayer::Live] {
                let found = map.spots(layer, Stamp::from_micros(67_000_000));
                let ages: std::vec::Vec<_> = found.spots.iter().map(|spot| spot.age_s).collect();
                assert_eq!(ages, [expected_s], "{layer:?}");
            }
        }
    }

    /// 600 spots of a cell each: what finds no part while the rows are read and what finds no place in the report is counted.
    #[test]
    fn overflow_is_counted() {
        let rows = [&*"*.".repeat(40), &*".".repeat(80)];
        let mut cells = map(&rows.repeat(15));
        let geometry = GridGeometry::new(80, 30, 0.1, Point2::new(0.0, 0.0)).unwrap();
        let mut map = SeenDirtMap::new(geometry, &mut cells[..]).unwrap();
        map.expect(21.0);
        let found = map.spots(SeenLayer::Live, Stamp::from_micros(67_000_000));
        assert_eq!((found.spots.len(), found.dropped as usize), (SPOTS_MAX, 600 - SPOTS_MAX));
        assert!(
            found.spots.iter().all(|spot| (spot.area_m2 - 0.01).abs() < 1e-4),
            "none was mixed with another"
        );
    }
}
