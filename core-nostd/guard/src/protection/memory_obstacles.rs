//! Which cells of the memory are obstacles, and what those may hide that the lidar met where the memory began.
//!
//! At power-up, and after a reset that means the way, the lowest ring passes over all that is nearer and lower than it. Of an object
//! that stands there it meets the far side at most, and no sensor has met the near side until the robot has come away from there
//! (FG-REQ-068; book, Fields of the swept body: Memory).

use super::lidar_rays::LidarRays;
use super::local_memory::{CELL_M, Cell, LocalMemory, SIDE, global, local};
use super::memory_row::{Row, height_of_step_m};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::{exact_usize, saturating_i32};

/// The near side of an object may lie so far before what was met of it, cells. A side that is hidden farther is met by the bumper.
const HIDDEN_CELLS: [f32; 2] = [4.0, 8.0];
/// The same where the lidar is now, cells.
const UNKNOWN_CELLS: u8 = 8;
/// So that the first cell beside an edge is another one in any direction, cells.
const ROUNDS_UP: f32 = 0.5;
/// What was met this little above the lowest ring is the upper edge of what the ring had passed over: noise and the size of a cell,
/// metres, and a third of the distance to the next ring, for each metre.
const EDGE_M: (f32, f32) = (0.02, 0.012);

/// How a place became an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sight {
    /// A sensor met something there.
    Met,
    /// It may be the near side of an object whose far side was met.
    Hidden,
}

/// The lidar where the memory began, or where it is now.
#[derive(Clone, Copy)]
struct Beginning {
    lidar: Point2,
    /// Where the robot looks, of length 1.
    ahead: Point2,
    height_m: f32,
    /// The lowest ring rises so much for each metre: less than nothing.
    slope: f32,
}

impl Beginning {
    fn at(pose: Pose2, rays: &LidarRays) -> Self {
        let lidar = pose.transform(Point2::new(rays.origin.x_m, rays.origin.y_m));
        let (sin, cos) = libm::sincosf(pose.heading_rad);
        Self { lidar, ahead: Point2::new(cos, sin), height_m: rays.origin.z_m, slope: rays.lowest_slope }
    }

    /// A cell lies ahead of the lidar: what lies behind was come by.
    fn is_ahead(&self, cell: Cell) -> bool {
        let middle = cell.middle();
        let (x_m, y_m) = (middle.x_m - self.lidar.x_m, middle.y_m - self.lidar.y_m);
        self.ahead.x_m * x_m + self.ahead.y_m * y_m > 0.0
    }

    /// The lowest ring passed over a cell at this height, or a little lower, metres.
    fn edge_m(&self, cell: Cell) -> f32 {
        let away_m = cell.middle().distance(self.lidar);
        let (least_m, share) = EDGE_M;
        self.height_m + self.slope * away_m + least_m + share * away_m
    }

    /// So high, in steps, a cell is no higher than the lowest ring passed there.
    fn is_edge(&self, cell: Cell, top: u8) -> bool {
        height_of_step_m(top) < self.edge_m(cell)
    }
}

impl LocalMemory {
    /// Visits every cell in which something stands: what the scanner met, and what the lidar met, unless it met a single height of
    /// it and no cell beside it is kept. Such cells are mostly edges of people who went away: the rays that met them came from
    /// somewhere else, and none of them passes at their height again. The end of a thin bar that points at the robot is one, too
    /// (book, Fields of the swept body: Memory). Where the memory began such a cell may be the edge of what the lowest ring passes
    /// over: it is visited, and what it may hide (FG-REQ-068). So is what an edge ahead of the lidar may hide now, where the lidar takes in so
    /// many firings that each direction has its turn, and the lowest ring has not seen the floor. At most 45,056.
    pub fn for_each_obstacle(
        &self,
        (rays, knows_floor): (&LidarRays, bool),
        mut visit: impl FnMut(Cell, Sight),
    ) {
        let beginning = self.beginning(rays);
        let present = knows_floor.then(|| Beginning::at(self.pose(), rays));
        let kept = |index: usize| self.rows.get(index % SIDE).map_or(0, Row::kept);
        // Rows and bits go round: at the border of the window a cell may count as one beside the opposite border.
        let beside = |word: u64| word.rotate_left(1) | word.rotate_right(1);
        let mut rows = 0_usize;
        let obstacles = |row: &Row| {
            let (above, below) = (kept(rows.wrapping_add(1)), kept(rows.wrapping_add(SIDE - 1)));
            let y = global(self.first.y, rows % SIDE);
            rows = rows.wrapping_add(1);
            let has_neighbour = beside(row.kept()) | above | beside(above) | below | beside(below);
            let lone = row.thin_of(row.by_lidar & !row.by_scanner & !has_neighbour);
            let ignored = beginning.map_or(lone, |beginning| self.without_edges(lone, (y, &beginning)));
            row.kept() & !ignored
        };
        self.visit((0, 1), obstacles, |cell| {
            visit(cell, Sight::Met);
            if let Some(present) = present.filter(|present| self.is_edge(cell, present)) {
                self.for_each_unknown(cell, present, |near| visit(near, Sight::Hidden));
            }
            let Some(beginning) = beginning.filter(|beginning| self.is_edge(cell, beginning)) else { return };
            for cells in HIDDEN_CELLS {
                visit(towards(cell, beginning.lidar, cells), Sight::Hidden);
            }
        });
    }

    fn beginning(&self, rays: &LidarRays) -> Option<Beginning> {
        Some(Beginning::at(self.began?, rays))
    }

    /// Visits the cells from an edge towards the lidar, up to the first one that is known, or that lies behind the lidar. At most 8.
    fn for_each_unknown(&self, edge: Cell, present: Beginning, mut visit: impl FnMut(Cell)) {
        for cells in 1..=UNKNOWN_CELLS {
            let near = towards(edge, present.lidar, f32::from(cells) + ROUNDS_UP);
            if !self.is_unknown(near) || !present.is_ahead(near) {
                break;
            }
            visit(near);
        }
    }

    /// Neither was its floor seen nor anything met in it.
    fn is_unknown(&self, cell: Cell) -> bool {
        let row = if self.has(cell) { self.rows.get(local(cell.y)) } else { None };
        row.is_some_and(|row| !row.is_known(local(cell.x)))
    }

    /// The lidar alone met something, and nothing of it is higher than the lowest ring passed where the memory began. The scanner
    /// hides nothing.
    fn is_edge(&self, cell: Cell, beginning: &Beginning) -> bool {
        let top = self.rows.get(local(cell.y)).and_then(|row| row.top_by_lidar(local(cell.x)));
        top.is_some_and(|top| beginning.is_edge(cell, top))
    }

    /// A ray went through a cell at a height that was met. Where the memory began that refutes no edge that is met still, be it kept or
    /// not yet, because rays go past a narrow end of it, and none while the robot moves: then the lowest ring rises above what it had met.
    pub(super) fn stays_edge(&self, cell: Cell, rays: &LidarRays) -> bool {
        let (Some(row), index) = (self.rows.get(local(cell.y)), local(cell.x)) else { return false };
        let is_edge =
            |beginning: Beginning| row.top_met(index).is_some_and(|top| beginning.is_edge(cell, top));
        self.beginning(rays).is_some_and(is_edge) && (!self.stands() || row.is_met(index))
    }

    /// Of these lone cells of a row, those that are no edges.
    fn without_edges(&self, lone: u64, (y, beginning): (i32, &Beginning)) -> u64 {
        let (mut ignored, mut left) = (lone, lone);
        for _ in 0..SIDE {
            if left == 0 {
                break;
            }
            let bit = left & left.wrapping_neg();
            let x = global(self.first.x, exact_usize(left.trailing_zeros()));
            left &= !bit;
            if self.is_edge(Cell { x, y }, beginning) {
                ignored &= !bit;
            }
        }
        ignored
    }
}

/// The cell that lies so many nearer to a place.
fn towards(cell: Cell, place: Point2, cells: f32) -> Cell {
    let middle = cell.middle();
    let (dx, dy) = (middle.x_m - place.x_m, middle.y_m - place.y_m);
    let share = cells / Point2::new(dx, dy).norm().max(CELL_M);
    Cell {
        x: cell.x.wrapping_sub(saturating_i32(share * dx)),
        y: cell.y.wrapping_sub(saturating_i32(share * dy)),
    }
}
