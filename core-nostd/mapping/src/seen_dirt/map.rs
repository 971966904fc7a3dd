//! The map of seen dirt: pixels fall into cells of the floor, cells collect observations from different viewpoints.
//!
//! Every observation is of one picture alone. Scores that the detector has averaged with earlier frames would carry a
//! reflection or a passing shadow from view to view, and views that repeat each other cannot disagree.

use super::cell::SeenCell;
use super::limit::{CellState, DirtLimit, KeptScore, SeenLayer, Together};
use super::tint::FloorTints;
use crate::{GridCoordinates, GridGeometry};
use floorguard_perception::floor::dirt::{FloorView, NOVELTY_BIN, Pixel};
use floorguard_types::capacities::FLOOR_IMAGE_COLUMNS_MAX;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::nearest_f32;
use floorguard_types::time::Stamp;

/// Another viewpoint after this distance or turn (book, Floor and dirt: Map of seen dirt). Time alone makes
/// none: a reflection stays while the robot stands.
const MOVED_M: f32 = 0.1;
const TURNED_RAD: f32 = 0.087_27;
/// Farther from the camera's foot point the view is too flat to be an observation, metres (the range within which
/// objects must be found; book, Floor and dirt: Objects).
const REACH_M: f32 = 1.3;
/// Pixels of the result that are examined: every second column and row.
const STEP: usize = 2;
const COLUMNS_MAX: usize = FLOOR_IMAGE_COLUMNS_MAX / NOVELTY_BIN;
/// Half of the cells, and the part of them that is clean floor, whatever the floor: what views agree on there is what the
/// floor looks like, and how much that changes from place to place.
const USUAL_PARTS: [f32; 2] = [0.5, 0.97];
/// Dirt exceeds the floor by this part of that change. But never must it exceed more than the detector's own threshold, and
/// never is anything dirt below this part of it. Found on 72 rendered halls of six floors.
const BEYOND_USUAL: f32 = 0.8;
const LEAST_PART: f32 = 0.62;
/// The same for strange colours, and the least at which one is dirt: 2.4 spreads.
const BEYOND_USUAL_TINT: f32 = 0.75;
const LEAST_TINT: f32 = 7.2;
/// A pixel's colour counts for its cell and the eight around it: chips and grain average out over a decimetre.
const AROUND: [(i32, f32); 3] = [(-1, 0.25), (0, 0.5), (1, 0.25)];
/// Fewer known cells are no floor to compare with.
pub(super) const KNOWN_MIN: u32 = 200;

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ViewOutcome {
    /// So many cells were observed.
    Observed(u32),
    /// From where the robot stood before: not counted.
    SameView,
}

/// The map over cells that the caller gives or lends, one for each of the geometry.
#[derive(Debug)]
pub struct SeenDirtMap<C> {
    geometry: GridGeometry,
    cells: C,
    last_view: Option<Pose2>,
    /// On how many cells live views agree about which score, and about which strangeness of the colour.
    histograms: [[u32; 256]; 2],
    /// Which colours the cells have.
    tints: FloorTints,
    /// The detector's.
    threshold: f32,
}

/// A half-size image of scores, and from which on one is dirt.
#[derive(Clone, Copy, Debug)]
pub struct Scores<'a> {
    /// Row by row; NaN where no floor was judged.
    pub values: &'a [f32],
    /// Lab relative to the surroundings, of weight 0 where it tells nothing; empty for a detector without colours.
    pub colours: &'a [Pixel],
    /// Pixels in a row.
    pub columns: usize,
    /// The detector's threshold.
    pub threshold: f32,
}

impl<C: AsRef<[SeenCell]> + AsMut<[SeenCell]>> SeenDirtMap<C> {
    /// A map over cells; `None` if they are fewer than the geometry's.
    #[must_use]
    pub fn new(geometry: GridGeometry, cells: C) -> Option<Self> {
        let count = geometry.cell_count();
        let mut histograms = [[0; 256]; 2];
        for together in cells.as_ref().get(..count)?.iter().filter_map(SeenCell::live) {
            count_cell(&mut histograms, together, 1);
        }
        let (tints, threshold) = (FloorTints::NEW, f32::INFINITY);
        Some(Self { geometry, cells, last_view: None, histograms, tints, threshold })
    }

    /// Where the cells lie.
    #[must_use]
    pub const fn geometry(&self) -> &GridGeometry {
        &self.geometry
    }

    /// The cells, row by row.
    #[must_use]
    pub fn cells(&self) -> &[SeenCell] {
        self.cells.as_ref().get(..self.geometry.cell_count()).unwrap_or(&[])
    }

    /// The detector's threshold, where no frame has set it.
    #[cfg(test)]
    pub(super) const fn expect(&mut self, threshold: f32) {
        self.threshold = threshold;
    }

    /// From which score on a cell of this floor is dirty: what most of the floor does not reach. On an even floor that is
    /// little, on planks of which each has its own grain nearly what the detector demands of a single pixel.
    #[must_use]
    pub fn limit(&self) -> DirtLimit {
        let [scores, tints] = &self.histograms;
        let known = scores.iter().fold(0_u32, |sum, count| sum.saturating_add(*count));
        if known < KNOWN_MIN {
            return DirtLimit { score: KeptScore::of(self.threshold), tint: KeptScore::of(f32::INFINITY) };
        }
        let beyond = |histogram, part: f32| {
            let [usual, most] = USUAL_PARTS.map(|part| reached(histogram, part * nearest_f32(known)).score());
            most + part * (most - usual)
        };
        let score = beyond(scores, BEYOND_USUAL).max(LEAST_PART * self.threshold).min(self.threshold);
        let tint = beyond(tints, BEYOND_USUAL_TINT).max(LEAST_TINT);
        DirtLimit { score: KeptScore::of(score), tint: KeptScore::of(tint) }
    }

    /// Square metres of a layer in a state.
    #[must_use]
    pub fn area_m2(&self, layer: SeenLayer, state: CellState) -> f32 {
        let limit = self.limit();
        let count = self.cells().iter().filter(|cell| cell.state(layer, limit) == state).count();
        nearest_f32(count) * self.geometry.resolution_m() * self.geometry.resolution_m()
    }

    /// Adds the scores of a frame, and of no earlier one, from a view whose poses are in the map's frame.
    pub fn add(&mut self, view: &FloorView, scores: &Scores<'_>, now: Stamp) -> ViewOutcome {
        if self.last_view.is_some_and(|last| !is_elsewhere(last, view.robot_in_map)) {
            return ViewOutcome::SameView;
        }
        self.last_view = Some(view.robot_in_map);
        self.threshold = scores.threshold;
        let bounds = self.collect(view, scores);
        // Seconds of a 64-bit clock: 32 bits are 136 years.
        let now_s = u32::try_from(now.as_micros() / 1_000_000).unwrap_or(u32::MAX);
        ViewOutcome::Observed(self.decide(bounds, now_s))
    }

    /// Counts pixels in cells; the columns and rows that were touched.
    fn collect(&mut self, view: &FloorView, scores: &Scores<'_>) -> [i32; 4] {
        let mut bounds = [i32::MAX, i32::MAX, i32::MIN, i32::MIN];
        let bin = nearest_f32(NOVELTY_BIN);
        let foot = view.foot_in_map();
        let foot = Point2::new(foot.x_m, foot.y_m);
        let middle = |index: usize| bin * (nearest_f32(index) + 0.5) - 0.5;
        let columns = scores.columns.clamp(1, COLUMNS_MAX);
        let mut pairs = scores.colours.chunks_exact(columns.saturating_mul(STEP));
        for (row, line) in scores.values.chunks_exact(columns).enumerate().step_by(STEP) {
            let (upper, lower) =
                pairs.next().and_then(|pair| pair.split_at_checked(columns)).unwrap_or((&[], &[]));
            // Pixels along a row mostly fall in the same cell.
            let (mut near, mut colours) = ((i32::MIN, i32::MIN), [0.0; 4]);
            let mut squares = upper.chunks_exact(STEP).zip(lower.chunks_exact(STEP));
            for (column, score) in line.iter().enumerate().step_by(STEP) {
                let square = squares.next();
                if score.is_nan() {
                    continue;
                }
                let place = view.place_in_map(middle(column), middle(row));
                let Some(place) = place.filter(|place| place.distance(foot) <= REACH_M) else { continue };
                let GridCoordinates { column: x, row: y } = self.geometry.coordinates_of(place);
                let Some(cell) = self.cell(x, y) else { continue };
                cell.take(*score);
                let [left, low, right, high] = &mut bounds;
                (*left, *low) = ((*left).min(x.saturating_sub(1)), (*low).min(y.saturating_sub(1)));
                (*right, *high) = ((*right).max(x.saturating_add(1)), (*high).max(y.saturating_add(1)));
                if near != (x, y) {
                    self.tint(near, core::mem::take(&mut colours));
                    near = (x, y);
                }
                square.into_iter().for_each(|(upper, lower)| add(&mut colours, upper.iter().chain(lower)));
            }
            self.tint(near, core::mem::take(&mut colours));
        }
        bounds
    }

    /// A cell by its column and row.
    fn cell(&mut self, x: i32, y: i32) -> Option<&mut SeenCell> {
        let index = self.geometry.index(x, y)?;
        self.cells.as_mut().get_mut(index)
    }

    /// Counts colours for a cell and those around it.
    fn tint(&mut self, (x, y): (i32, i32), colours: [f32; 4]) {
        for (dy, down) in AROUND {
            for (dx, across) in AROUND {
                if let Some(cell) = self.cell(x.saturating_add(dx), y.saturating_add(dy)) {
                    cell.tint(colours, down * across);
                }
            }
        }
    }

    /// Turns counts into observations; how many.
    fn decide(&mut self, [left, low, right, high]: [i32; 4], now_s: u32) -> u32 {
        let width = usize::from(self.geometry.width());
        let (limit, mut observed) = (self.limit(), 0_u32);
        let count = |first: i32, last: i32| {
            usize::try_from(last.saturating_sub(first).saturating_add(1)).unwrap_or(0)
        };
        let start = |first: i32| usize::try_from(first).unwrap_or(0);
        let rows = self.cells.as_mut().chunks_mut(width.max(1)).skip(start(low)).take(count(low, high));
        for row in rows {
            for cell in row.iter_mut().skip(start(left)).take(count(left, right)) {
                let before = cell.live();
                if cell.close(&self.tints, (limit, now_s)) {
                    observed = observed.saturating_add(1);
                    let now = cell.live();
                    before.into_iter().for_each(|seen| count_cell(&mut self.histograms, seen, -1));
                    now.into_iter().for_each(|seen| count_cell(&mut self.histograms, seen, 1));
                    if now.is_some() {
                        self.tints.learn(cell.colour());
                    }
                }
            }
        }
        self.tints.settle();
        observed
    }
}

/// Counts a cell in or out.
fn count_cell(histograms: &mut [[u32; 256]; 2], seen: Together, step: i32) {
    for (histogram, score) in histograms.iter_mut().zip([seen.agreed, seen.tint]) {
        if let Some(slot) = histogram.get_mut(usize::from(score.0)) {
            *slot = slot.saturating_add_signed(step);
        }
    }
}

/// The score that so many cells do not exceed.
fn reached(histogram: &[u32; 256], wanted: f32) -> KeptScore {
    let mut below = 0_u32;
    let score = histogram.iter().zip(0_u8..=u8::MAX).find_map(|(count, score)| {
        below = below.saturating_add(*count);
        (nearest_f32(below) > wanted).then_some(KeptScore(score))
    });
    score.unwrap_or(KeptScore(u8::MAX))
}

/// Adds the colours that tell something, and how many they are.
fn add<'a>([sum_l, sum_a, sum_b, count]: &mut [f32; 4], colours: impl Iterator<Item = &'a Pixel>) {
    for [l, a, b, weight] in colours {
        if *weight > 0.0 && !(l + a + b).is_nan() {
            (*sum_l, *sum_a, *sum_b, *count) = (*sum_l + l, *sum_a + a, *sum_b + b, *count + 1.0);
        }
    }
}

fn is_elsewhere(last: Pose2, robot: Pose2) -> bool {
    let moved = last.inverse().compose(robot);
    libm::hypotf(moved.x_m, moved.y_m) >= MOVED_M || moved.heading_rad.abs() >= TURNED_RAD
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limit over cells whose agreed scores rise evenly from one to the other.
    fn limit_over(count: u16, (low, high): (f32, f32)) -> f32 {
        let geometry = GridGeometry::new(count, 1, 0.1, Point2::new(0.0, 0.0)).unwrap();
        let cell = |index: u16| {
            let score = low + (high - low) * f32::from(index) / f32::from(count);
            let mut cell = SeenCell::default();
            let none = DirtLimit { score: KeptScore(255), tint: KeptScore(255) };
            (0..3).for_each(|second| {
                cell.observe((KeptScore::of(score), [0; 3]), &FloorTints::NEW, (none, second));
            });
            cell
        };
        let mut map = SeenDirtMap::new(geometry, (0..count).map(cell).collect::<std::vec::Vec<_>>()).unwrap();
        map.expect(21.0);
        map.limit().score.score()
    }

    /// An even floor has the least limit, one whose places differ a higher one, and none a higher one than the detector;
    /// nor has a floor of which little is known another.
    #[test]
    fn the_limit_follows_the_floor() {
        for (count, scores, expected) in [
            (400, (6.0, 8.0), 13.0),
            (400, (8.0, 14.0), 13.82 + 0.8 * 2.82),
            (400, (8.0, 24.0), 21.0),
            (199, (6.0, 8.0), 21.0),
        ] {
            let limit = limit_over(count, scores);
            assert!((limit - expected).abs() < 0.3, "{count} {scores:?}: {limit}");
        }
    }

    /// A floor whose places differ more than was guessed: those that are seen first and never again are no dirt, and what
    /// is strange on this floor is.
    #[test]
    fn nothing_is_strange_before_the_floor_is_known() {
        let geometry = GridGeometry::new(10, 200, 0.1, Point2::new(0.0, 0.0)).unwrap();
        let mut map = SeenDirtMap::new(geometry, std::vec![SeenCell::default(); 2_000]).unwrap();
        map.expect(21.0);
        let mut random = floorguard_types::random::Pcg32::new(5, 1);
        for stretch in 0..20 {
            let mut colours = [(); 100].map(|()| random.uniform_between(-1.7, 1.7));
            colours[50] = if stretch == 19 { 7.0 } else { 0.0 };
            for view in 0..3 {
                let cells = map.cells.iter_mut().skip(100 * stretch as usize);
                for (cell, b) in cells.zip(colours) {
                    (0..6).for_each(|_| cell.take(8.0));
                    cell.tint([0.0, 0.0, b, 1.0], 1.0);
                }
                let bounds = [0, 10 * stretch, 9, 10 * stretch + 9];
                assert_eq!(map.decide(bounds, (3 * stretch + view) as u32), 100);
            }
        }
        let (limit, cells) = (map.limit(), map.cells().iter().enumerate());
        let dirty = cells.filter(|(_, cell)| cell.state(SeenLayer::Live, limit) == CellState::Dirty);
        let dirty: std::vec::Vec<_> = dirty.map(|(index, _)| index).collect();
        assert_eq!(dirty, [1_950], "{limit:?}");
    }
}
