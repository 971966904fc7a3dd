//! What stands around the robot: cells of the floor that move under it, and keep what any sensor saw until a later look passes
//! through the same place and height, or until it is out of reach. Time alone clears nothing (FG-REQ-028).
//!
//! A window of 4.7 m by 4.7 m in cells of 7.35 cm, fixed to the floor by the wheels; its middle lies 1.35 m ahead of the
//! robot's origin. Each cell keeps two kinds apart: that the safety scanner met something in its plane, and a run of
//! heights below the lidar in which the lidar did, in two spans of time of three. Of several runs the lowest one stays.

use heapless::Vec;

use super::collision::Body;
use super::memory_row::{Row, Run, height_step};
use super::memory_window::MemoryWindow;
use super::never_seen::Ends;
use super::scan_evidence::ROW_STEP;
use super::sweep::signed_distance_m;
use floorguard_types::geometry::{Point2, Pose2, Twist2, wrap_angle};
use floorguard_types::number::{count_i32, exact_usize, nearest_f32, saturating_i32};
use floorguard_types::time::{Age, Stamp};

/// Cells along each side of the window: the bits of a word.
pub const SIDE: usize = 64;
/// Side of a cell, metres.
pub const CELL_M: f32 = 0.0735;
/// What the lidar met is kept when it meets it again in one of the next two spans of this length, microseconds: three sweeps each.
/// Noise and the legs of a person who walks by do not stay; a level surface, which one ring crosses and the next one after the
/// robot has gone 0.4 m, does.
const AGREE_US: u64 = 300_000;
/// Between two measurements of the wheels; what takes longer is a lost source, seconds.
const STEP_MAX_S: f32 = 0.1;
/// Cells deeper inside the body than this are wrong, metres.
const INSIDE_M: f32 = 0.05;
/// Cells forgotten at one tick.
const INSIDE_MAX: usize = 64;
/// A memory that a person had forgotten knows what the sensors see after so long: each direction of the lidar has had its turn
/// (2.4 s), and two spans have agreed, microseconds.
const COMPLETE_US: u64 = 3_000_000;
/// When the robot has come so far, its front has left what was hidden where the memory began, metres.
const LEFT_M: f32 = 2.3;
/// Slower than this it stands, m/s and rad/s.
const STANDS: (f32, f32) = (0.01, 0.01);
/// Parts in which the sums are examined, one at each tick.
const PARTS: usize = 16;

/// A cell of the floor, counted from where the memory began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cell {
    /// Along x.
    pub x: i32,
    /// Along y.
    pub y: i32,
}

impl Cell {
    /// The cell of a place in the memory's frame.
    #[must_use]
    pub fn of(place: Point2) -> Self {
        // Saturated: a robot that far away has left the window of everything.
        let index = |metres: f32| {
            let cells = metres * (1.0 / CELL_M);
            let towards_zero = saturating_i32(cells);
            towards_zero.saturating_sub(i32::from(cells < nearest_f32(towards_zero)))
        };
        Self { x: index(place.x_m), y: index(place.y_m) }
    }

    /// Its middle, metres.
    #[must_use]
    pub fn middle(self) -> Point2 {
        Point2::new((nearest_f32(self.x) + 0.5) * CELL_M, (nearest_f32(self.y) + 0.5) * CELL_M)
    }
}

/// The memory.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalMemory {
    pub(crate) rows: [Row; SIDE],
    /// The cell with the least x and y of the window.
    pub(super) first: Cell,
    window: MemoryWindow,
    pose: Pose2,
    twist: Twist2,
    at: Option<Stamp>,
    next: usize,
    /// When the present span of time began.
    span_at: Stamp,
    /// A reset that is in progress was asked for while nothing but a closed way held the robot.
    pub(crate) reset_means_way: bool,
    /// Where the robot was when it began, while what is near there may be hidden.
    pub(super) began: Option<Pose2>,
    /// When a person had it forget what is around.
    forgotten_at: Option<Stamp>,
    /// Which firing of the next packet is taken.
    pub(super) turn: usize,
    /// What the newest scan says of the ends of its sector, until it is marked.
    pub(super) ends: Option<Ends>,
    /// Scans so far: which beams and which rows of cells are taken.
    pub(super) scans: usize,
}

impl LocalMemory {
    /// Nothing is known.
    pub const EMPTY: Self = Self {
        rows: [Row::EMPTY; SIDE],
        first: Cell { x: 0, y: 0 },
        window: MemoryWindow::BEGUN,
        pose: Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 },
        twist: Twist2::ZERO,
        at: None,
        next: 0,
        span_at: Stamp::ZERO,
        reset_means_way: false,
        began: Some(Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 }),
        forgotten_at: None,
        turn: 0,
        ends: None,
        scans: 0,
    };

    /// Forgets everything, in place.
    pub fn forget(&mut self) {
        self.rows.iter_mut().for_each(|row| row.clone_from(&Row::EMPTY));
        (self.pose, self.twist, self.at, self.next) = (Pose2::default(), Twist2::ZERO, None, 0);
        (self.span_at, self.forgotten_at, self.reset_means_way) = (Stamp::ZERO, None, false);
        self.window = MemoryWindow::BEGUN;
        self.began = Some(Pose2::default());
        self.first = self.wanted_first();
    }

    /// A reset was granted. If it means the way, a person has looked at what no sensor sees, and says that nothing is there: the
    /// memory begins anew where the robot stands (FG-REQ-065). What the sensors see comes back.
    pub fn on_reset(&mut self, now: Stamp) {
        if self.reset_means_way {
            self.rows.iter_mut().for_each(|row| row.clone_from(&Row::LOOKED_AT));
            (self.reset_means_way, self.forgotten_at) = (false, Some(now));
            self.began = Some(self.pose);
        }
    }

    /// It was forgotten lately, and what the sensors see has not come back yet.
    #[must_use]
    pub fn is_incomplete(&self, now: Stamp) -> bool {
        self.forgotten_at.is_some_and(|at| at.past_us(now) < COMPLETE_US)
    }

    /// The robot has moved, as its wheels tell: the window follows it. Gives the time since they did before, seconds.
    pub fn follow(&mut self, twist: Twist2, stamp: Stamp) -> f32 {
        let step_s = match self.at.map(|at| at.age(stamp)) {
            Some(Age::Past(step_us)) => (nearest_f32(step_us) * 1.0e-6).min(STEP_MAX_S),
            _ => 0.0,
        };
        self.pose = moved(self.pose, twist, step_s);
        self.window.follow(twist, step_s);
        (self.twist, self.at) = (twist, Some(stamp));
        self.pass_time(stamp);
        let now = Point2::new(self.pose.x_m, self.pose.y_m);
        self.began = self.began.filter(|began| Point2::new(began.x_m, began.y_m).distance(now) < LEFT_M);
        self.shift_to(self.wanted_first());
        step_s
    }

    /// A span of time ends when it has lasted long enough. By the ticks, too: the wheels may be heard last of all, and what the
    /// lidar has met until then shall be known when the robot starts.
    pub fn pass_time(&mut self, now: Stamp) {
        if self.span_at.past_us(now) >= AGREE_US {
            self.rows.iter_mut().for_each(Row::begin_span);
            self.span_at = now;
        }
    }

    /// The wheels say that the robot stands.
    pub(super) const fn stands(&self) -> bool {
        self.twist.linear_mps.abs() < STANDS.0 && self.twist.angular_radps.abs() < STANDS.1
    }

    /// Where the robot was at the newest measurement of the wheels.
    #[must_use]
    pub const fn pose(&self) -> Pose2 {
        self.pose
    }

    /// Where the robot was, or will be, at a moment near the newest measurement of the wheels.
    #[must_use]
    pub fn pose_at(&self, stamp: Stamp) -> Pose2 {
        let ahead_s = match self.at.map(|at| at.age(stamp)) {
            Some(Age::Past(us)) => (nearest_f32(us) * 1.0e-6).min(STEP_MAX_S),
            Some(Age::Future(us)) => -(nearest_f32(us) * 1.0e-6).min(STEP_MAX_S),
            None => 0.0,
        };
        moved(self.pose, self.twist, ahead_s)
    }

    /// The scanner met something in a cell, or looked through it.
    pub fn set_scanned(&mut self, cell: Cell, on: bool) {
        if let Some((row, index)) = self.place(cell) {
            row.set_scanned(index, on);
        }
    }

    /// The lidar met something at a height of a cell. `gap_m`: as far as two of its rays are apart there.
    pub fn meet(&mut self, cell: Cell, height_m: f32, gap_m: f32) {
        let heights = (height_step(height_m), height_step(gap_m));
        if let Some((row, index)) = self.place(cell) {
            row.meet(index, heights);
        }
    }

    /// The lidar met something in a cell, lately or in two spans of time of three.
    #[must_use]
    pub fn holds(&self, cell: Cell) -> bool {
        self.has(cell) && self.rows.get(local(cell.y)).is_some_and(|row| row.holds(local(cell.x)))
    }

    /// The lidar met something in a cell in this span of time or in the one before: rays that go past the end of it refute nothing.
    pub(crate) fn is_fresh(&self, cell: Cell) -> bool {
        self.has(cell) && self.rows.get(local(cell.y)).is_some_and(|row| row.is_fresh(local(cell.x)))
    }

    /// What the lidar met in a cell; nothing outside of the window.
    pub(crate) fn run(&self, cell: Cell) -> Run {
        let row = if self.has(cell) { self.rows.get(local(cell.y)) } else { None };
        row.map_or_else(Run::default, |row| row.run(local(cell.x)))
    }

    /// A ray of the lidar has passed through what was met in a cell.
    pub(crate) fn clear_lidar(&mut self, cell: Cell) {
        if let Some((row, index)) = self.place(cell) {
            row.clear_lidar(index);
        }
    }

    /// What the scanner had met in a cell is gone. With it goes what the lidar had met above it, and a single height beside it: the
    /// edge of what stood there.
    pub(crate) fn leave(&mut self, cell: Cell) {
        self.set_scanned(cell, false);
        self.clear_lidar(cell);
        for (x, y) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
            let beside = Cell { x: cell.x.wrapping_add(x), y: cell.y.wrapping_add(y) };
            if self.run(beside).is_thin() && self.holds(beside) {
                self.clear_lidar(beside);
            }
        }
    }

    /// A place in cells, counted from the corner of the window.
    pub(super) fn in_window(&self, place: Point2) -> Point2 {
        let from = |metres: f32, first: i32| metres * (1.0 / CELL_M) - nearest_f32(first);
        Point2::new(from(place.x_m, self.first.x), from(place.y_m, self.first.y))
    }

    /// The cell that is so many from the corner of the window.
    pub(super) const fn cell_in_window(&self, x: i32, y: i32) -> Cell {
        Cell { x: self.first.x.wrapping_add(x), y: self.first.y.wrapping_add(y) }
    }

    /// Visits every cell that is kept, of both sensors. At most 4,096.
    pub fn for_each(&self, visit: impl FnMut(Cell)) {
        self.visit((0, 1), Row::kept, visit);
    }

    /// Visits the cells in which the scanner met something, of every fourth row. At most 1,024.
    pub(super) fn for_each_scanned(&self, first: usize, visit: impl FnMut(Cell)) {
        self.visit((first, ROW_STEP), |row| row.by_scanner, visit);
    }

    pub(super) fn visit(
        &self,
        (from, step): (usize, usize),
        mut cells_of: impl FnMut(&Row) -> u64,
        mut visit: impl FnMut(Cell),
    ) {
        for (index, row) in self.rows.iter().enumerate().skip(from).step_by(step) {
            let y = global(self.first.y, index);
            let mut word = cells_of(row);
            for _ in 0..SIDE {
                if word == 0 {
                    break;
                }
                let bit = exact_usize(word.trailing_zeros());
                word &= word.wrapping_sub(1);
                visit(Cell { x: global(self.first.x, bit), y });
            }
        }
    }

    /// Where the body stands nothing else does: what lies deeper inside it than the memory may be wrong is forgotten.
    pub fn forget_inside(&mut self, outline: &[Point2], (pose, body): (Pose2, Body)) {
        let (sin, cos) = libm::sincosf(pose.heading_rad);
        let mut inside = Vec::<Cell, INSIDE_MAX>::new();
        self.for_each(|cell| {
            let place = cell.middle();
            let (dx, dy) = (place.x_m - pose.x_m, place.y_m - pose.y_m);
            let in_robot = Point2::new(cos * dx + sin * dy, cos * dy - sin * dx);
            if body.distance_m(in_robot) <= 0.0 && signed_distance_m(outline, in_robot) < -INSIDE_M {
                // Full: the rest is forgotten at the next tick.
                let _ = inside.push(cell);
            }
        });
        for cell in &inside {
            if let Some((row, index)) = self.place(*cell) {
                row.clear(index, true);
            }
        }
    }

    /// Looks at the next part of the sums; `false` when something changed that was not written.
    pub fn check_next(&mut self) -> bool {
        let part = self.next % PARTS;
        self.next = part.wrapping_add(1);
        self.rows.iter().skip(part).step_by(PARTS).all(Row::is_whole)
    }

    fn wanted_first(&self) -> Cell {
        let (sin, cos) = libm::sincosf(self.pose.heading_rad);
        let middle_m = self.window.middle_m();
        let middle = Point2::new(self.pose.x_m + middle_m * cos, self.pose.y_m + middle_m * sin);
        let cell = Cell::of(middle);
        let half = count_i32(SIDE / 2);
        Cell { x: cell.x.saturating_sub(half), y: cell.y.saturating_sub(half) }
    }

    /// Moves the window cell by cell; what leaves it is forgotten. What comes into it behind the robot counts as looked through.
    fn shift_to(&mut self, wanted: Cell) {
        let (sin, cos) = libm::sincosf(self.pose.heading_rad);
        let is_behind_x = (wanted.x > self.first.x) != (cos > 0.0);
        let is_behind_y = (wanted.y > self.first.y) != (sin > 0.0);
        for _ in 0..SIDE {
            if wanted.x == self.first.x {
                break;
            }
            let leaves = if wanted.x > self.first.x { self.first.x } else { self.first.x.wrapping_sub(1) };
            let index = local(leaves);
            self.rows.iter_mut().for_each(|row| row.clear(index, is_behind_x));
            self.first.x = self.first.x.wrapping_add(if wanted.x > self.first.x { 1 } else { -1 });
        }
        for _ in 0..SIDE {
            if wanted.y == self.first.y {
                break;
            }
            let leaves = if wanted.y > self.first.y { self.first.y } else { self.first.y.wrapping_sub(1) };
            if let Some(row) = self.rows.get_mut(local(leaves)) {
                row.clone_from(if is_behind_y { &Row::LOOKED_AT } else { &Row::EMPTY });
            }
            self.first.y = self.first.y.wrapping_add(if wanted.y > self.first.y { 1 } else { -1 });
        }
        // Farther than the window is wide: everything was cleared on the way.
        self.first = wanted;
    }

    pub(super) fn place(&mut self, cell: Cell) -> Option<(&mut Row, usize)> {
        self.has(cell).then(|| self.rows.get_mut(local(cell.y))).flatten().map(|row| (row, local(cell.x)))
    }

    /// The cell lies in the window.
    pub(super) fn has(&self, cell: Cell) -> bool {
        let within = |value: i32, first: i32| (0..count_i32(SIDE)).contains(&value.wrapping_sub(first));
        within(cell.x, self.first.x) && within(cell.y, self.first.y)
    }
}

/// Place of a cell in the rows, or in a row.
pub(super) const fn local(cell: i32) -> usize {
    exact_usize(cell.rem_euclid(count_i32(SIDE)).cast_unsigned())
}

/// The cell of the window that has a place in the rows, or in a row.
pub(super) const fn global(first: i32, index: usize) -> i32 {
    first.wrapping_add(count_i32(index).wrapping_sub(first).rem_euclid(count_i32(SIDE)))
}

fn moved(pose: Pose2, twist: Twist2, step_s: f32) -> Pose2 {
    let turned = twist.angular_radps * step_s;
    let (sin, cos) = libm::sincosf(pose.heading_rad + 0.5 * turned);
    let driven_m = twist.linear_mps * step_s;
    Pose2 {
        x_m: pose.x_m + driven_m * cos,
        y_m: pose.y_m + driven_m * sin,
        heading_rad: wrap_angle(pose.heading_rad + turned),
    }
}
