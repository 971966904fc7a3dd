//! What stands around the robot: cells of the floor that move under it, and keep what any sensor saw until a later look passes
//! through the same place and height, or until it is out of reach. Time alone clears nothing (FG-REQ-028).
//!
//! A window of 4.8 m by 4.8 m in cells of 5 cm, fixed to the floor by the wheels; its middle lies a metre ahead of the robot's
//! origin. Each cell keeps three things apart: that the safety scanner met something in its plane, and two runs of heights in
//! which the lidar did, the lowest one below the lidar and the highest one above it. Those are the ones that sink out of its rays
//! when the robot comes near.

use heapless::Vec;

use super::collision::Body;
use super::sweep::signed_distance_m;
use floorguard_types::geometry::{Point2, Pose2, Twist2, wrap_angle};
use floorguard_types::time::{Age, Stamp};

/// Cells along each side of the window.
pub const SIDE: usize = 96;
/// Side of a cell, metres.
pub const CELL_M: f32 = 0.05;
/// The middle of the window lies this far ahead of the robot's origin, metres: more room ahead than behind.
const AHEAD_M: f32 = 1.0;
/// Words of 32 cells in a row.
const WORDS: usize = SIDE / 32;
/// A step of the heights that are kept, metres: 255 of them reach to 1.53 m.
const HEIGHT_STEP_M: f32 = 0.006;
/// More way forward than this is not counted, metres.
const AHEAD_MAX_M: f32 = 10.0;
/// Between two measurements of the wheels; what takes longer is a lost source, seconds.
const STEP_MAX_S: f32 = 0.1;
/// Cells deeper inside the body than this are wrong, metres.
const INSIDE_M: f32 = 0.04;
/// Cells forgotten at one tick.
const INSIDE_MAX: usize = 64;
/// Parts in which the sums are looked at, one at each tick.
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
        // Casts saturate: a robot that far away has left the window of everything.
        Self { x: libm::floorf(place.x_m / CELL_M) as i32, y: libm::floorf(place.y_m / CELL_M) as i32 }
    }

    /// Its middle, metres.
    #[must_use]
    pub fn middle(self) -> Point2 {
        Point2::new((self.x as f32 + 0.5) * CELL_M, (self.y as f32 + 0.5) * CELL_M)
    }
}

/// A step of height: 1…255.
#[must_use]
pub fn height_step(height_m: f32) -> u8 {
    // The cast saturates, and makes nothing of what is no number.
    (libm::floorf(height_m / HEIGHT_STEP_M) as u8).saturating_add(1)
}

/// Heights that belong together: lowest and highest, in steps; 0: nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Run {
    low: u8,
    top: u8,
}

impl Run {
    const fn is_empty(self) -> bool {
        self.top == 0
    }

    /// Takes in a height: what lies within `gap` of the run belongs to it, of two runs the lower one stays, or with `upper` the
    /// higher one.
    const fn with(self, step: u8, gap: u8, upper: bool) -> Self {
        let alone = Self { low: step, top: step };
        if self.is_empty() {
            return alone;
        }
        let joins = step >= self.low.saturating_sub(gap) && step <= self.top.saturating_add(gap);
        let is_outer = if upper { step > self.top } else { step < self.low };
        if !joins {
            return if is_outer { alone } else { self };
        }
        let low = if step < self.low { step } else { self.low };
        let top = if step > self.top { step } else { self.top };
        Self { low, top }
    }

    /// A ray at this height goes through the run: between its ends, or through one that has no between.
    const fn is_refuted_at(self, step: u8) -> bool {
        if self.is_empty() {
            return false;
        }
        let is_thin = self.top.saturating_sub(self.low) < 2;
        (step > self.low && step < self.top) || (is_thin && (step == self.low || step == self.top))
    }
}

/// What the lidar met in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Column {
    lower: Run,
    upper: Run,
}

impl Column {
    const NOTHING: Self = Self { lower: Run { low: 0, top: 0 }, upper: Run { low: 0, top: 0 } };

    const fn is_empty(self) -> bool {
        self.lower.is_empty() && self.upper.is_empty()
    }

    const fn word(self) -> u32 {
        u32::from_le_bytes([self.lower.low, self.lower.top, self.upper.low, self.upper.top])
    }
}

/// A row of cells, with the sum of all its words.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub(crate) columns: [Column; SIDE],
    pub(crate) by_lidar: [u32; WORDS],
    pub(crate) by_scanner: [u32; WORDS],
    sum: u32,
}

impl Row {
    /// Nothing but zeros, which take no room in a program.
    const EMPTY: Self =
        Self { columns: [Column::NOTHING; SIDE], by_lidar: [0; WORDS], by_scanner: [0; WORDS], sum: 0 };

    fn column(&self, index: usize) -> Column {
        self.columns.get(index).copied().unwrap_or(Column::NOTHING)
    }

    fn set_column(&mut self, index: usize, new: Column) {
        let Some(slot) = self.columns.get_mut(index) else { return };
        self.sum ^= slot.word() ^ new.word();
        *slot = new;
        self.sum ^= set_bit(&mut self.by_lidar, index, !new.is_empty());
    }

    fn set_scanned(&mut self, index: usize, on: bool) {
        // Bits of both kinds at the same place would cancel each other out in the sum.
        self.sum ^= set_bit(&mut self.by_scanner, index, on).rotate_left(7);
    }

    fn clear(&mut self, index: usize) {
        self.set_column(index, Column::NOTHING);
        self.set_scanned(index, false);
    }

    fn is_whole(&self) -> bool {
        let words = self.columns.iter().map(|column| column.word());
        let words = words.chain(self.by_lidar).chain(self.by_scanner.iter().map(|word| word.rotate_left(7)));
        words.fold(0, |sum, word| sum ^ word) == self.sum
    }
}

/// Sets or clears a bit; gives the bits of the word that changed.
fn set_bit(words: &mut [u32; WORDS], index: usize, on: bool) -> u32 {
    let Some(word) = words.get_mut(index / 32) else { return 0 };
    let bit = 1_u32.wrapping_shl(index as u32 % 32);
    let before = *word;
    *word = if on { before | bit } else { before & !bit };
    before ^ *word
}

fn has_bit(words: &[u32; WORDS], index: usize) -> bool {
    words.get(index / 32).is_some_and(|word| word & 1_u32.wrapping_shl(index as u32 % 32) != 0)
}

/// The memory.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalMemory {
    pub(crate) rows: [Row; SIDE],
    /// The cell with the least x and y of the window.
    first: Cell,
    pose: Pose2,
    twist: Twist2,
    at: Option<Stamp>,
    next: usize,
    /// Way forward since the beginning, metres, as far as it matters.
    pub(crate) ahead_m: f32,
    /// Which rows the next scan is compared with.
    pub(super) turn: usize,
}

impl LocalMemory {
    /// Nothing is known.
    pub const EMPTY: Self = Self {
        rows: [Row::EMPTY; SIDE],
        first: Cell { x: 0, y: 0 },
        pose: Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 },
        twist: Twist2::ZERO,
        at: None,
        next: 0,
        ahead_m: 0.0,
        turn: 0,
    };

    /// Forgets everything, in place.
    pub fn forget(&mut self) {
        self.rows.iter_mut().for_each(|row| row.clone_from(&Row::EMPTY));
        (self.pose, self.twist, self.at, self.next) = (Pose2::default(), Twist2::ZERO, None, 0);
        self.ahead_m = 0.0;
        self.first = self.wanted_first();
    }

    /// The robot has moved, as its wheels tell: the window follows it.
    pub fn follow(&mut self, twist: Twist2, stamp: Stamp) {
        if let Some(Age::Past(step_us)) = self.at.map(|at| at.age(stamp)) {
            let step_s = (step_us as f32 * 1.0e-6).min(STEP_MAX_S);
            self.pose = moved(self.pose, twist, step_s);
            self.ahead_m = (self.ahead_m + twist.linear_mps.max(0.0) * step_s).min(AHEAD_MAX_M);
        }
        (self.twist, self.at) = (twist, Some(stamp));
        self.shift_to(self.wanted_first());
    }

    /// Where the robot was, or will be, at a moment near the newest measurement of the wheels.
    #[must_use]
    pub fn pose_at(&self, stamp: Stamp) -> Pose2 {
        let ahead_s = match self.at.map(|at| at.age(stamp)) {
            Some(Age::Past(us)) => (us as f32 * 1.0e-6).min(STEP_MAX_S),
            Some(Age::Future(us)) => -(us as f32 * 1.0e-6).min(STEP_MAX_S),
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
    pub fn meet(&mut self, cell: Cell, height_m: f32, (gap_m, is_upper): (f32, bool)) {
        let (step, gap) = (height_step(height_m), height_step(gap_m));
        let Some((row, index)) = self.place(cell) else { return };
        let mut column = row.column(index);
        if is_upper {
            column.upper = column.upper.with(step, gap, true);
        } else {
            column.lower = column.lower.with(step, gap, false);
        }
        row.set_column(index, column);
    }

    /// What the lidar met in a cell, if anything.
    #[must_use]
    pub fn met(&self, cell: Cell) -> bool {
        self.look(cell).is_some_and(|(row, index)| has_bit(&row.by_lidar, index))
    }

    /// A ray of the lidar has passed through a cell at a height.
    pub fn pass(&mut self, cell: Cell, height_m: f32) {
        let step = height_step(height_m);
        let Some((row, index)) = self.place(cell) else { return };
        let mut column = row.column(index);
        if column.lower.is_refuted_at(step) {
            column.lower = Run::default();
        }
        if column.upper.is_refuted_at(step) {
            column.upper = Run::default();
        }
        row.set_column(index, column);
    }

    /// Visits every cell in which something stands, of all sensors or of the scanner alone; of every `stride`-th row from
    /// `offset` on. At most 9,216.
    pub fn for_each(
        &self,
        (is_scanned_only, stride, offset): (bool, usize, usize),
        mut visit: impl FnMut(Cell),
    ) {
        for (index, row) in self.rows.iter().enumerate().skip(offset).step_by(stride.max(1)) {
            let y = global(self.first.y, index);
            for (word_index, (scanned, met)) in row.by_scanner.iter().zip(&row.by_lidar).enumerate() {
                let mut word = if is_scanned_only { *scanned } else { *scanned | *met };
                for _ in 0..32 {
                    if word == 0 {
                        break;
                    }
                    let bit = word.trailing_zeros() as usize;
                    word &= word.wrapping_sub(1);
                    visit(Cell { x: global(self.first.x, word_index.wrapping_mul(32).wrapping_add(bit)), y });
                }
            }
        }
    }

    /// Where the body stands nothing else does: what lies deeper inside it than the memory may be wrong is forgotten.
    pub fn forget_inside(&mut self, outline: &[Point2], (pose, body): (Pose2, Body)) {
        let (sin, cos) = libm::sincosf(pose.heading_rad);
        let mut inside = Vec::<Cell, INSIDE_MAX>::new();
        self.for_each((false, 1, 0), |cell| {
            let place = cell.middle();
            let (dx, dy) = (place.x_m - pose.x_m, place.y_m - pose.y_m);
            let in_robot = Point2::new(cos * dx + sin * dy, cos * dy - sin * dx);
            if body.distance_m(in_robot) <= 0.0 && signed_distance_m(outline, in_robot) < -INSIDE_M {
                // Out of room: the rest is forgotten at the next tick.
                let _ = inside.push(cell);
            }
        });
        for cell in &inside {
            if let Some((row, index)) = self.place(*cell) {
                row.clear(index);
            }
        }
    }

    /// Looks at the next part of the sums; `false` when something changed that nobody wrote.
    pub fn check_next(&mut self) -> bool {
        let part = self.next % PARTS;
        self.next = part.wrapping_add(1);
        self.rows.iter().skip(part).step_by(PARTS).all(Row::is_whole)
    }

    fn wanted_first(&self) -> Cell {
        let (sin, cos) = libm::sincosf(self.pose.heading_rad);
        let middle = Point2::new(self.pose.x_m + AHEAD_M * cos, self.pose.y_m + AHEAD_M * sin);
        let cell = Cell::of(middle);
        let half = (SIDE / 2) as i32;
        Cell { x: cell.x.saturating_sub(half), y: cell.y.saturating_sub(half) }
    }

    /// Moves the window cell by cell; what leaves it is forgotten.
    fn shift_to(&mut self, wanted: Cell) {
        for _ in 0..SIDE {
            if wanted.x == self.first.x {
                break;
            }
            let leaves = if wanted.x > self.first.x { self.first.x } else { self.first.x.wrapping_sub(1) };
            let index = local(leaves);
            self.rows.iter_mut().for_each(|row| row.clear(index));
            self.first.x = self.first.x.wrapping_add(if wanted.x > self.first.x { 1 } else { -1 });
        }
        for _ in 0..SIDE {
            if wanted.y == self.first.y {
                break;
            }
            let leaves = if wanted.y > self.first.y { self.first.y } else { self.first.y.wrapping_sub(1) };
            if let Some(row) = self.rows.get_mut(local(leaves)) {
                row.clone_from(&Row::EMPTY);
            }
            self.first.y = self.first.y.wrapping_add(if wanted.y > self.first.y { 1 } else { -1 });
        }
        // Farther than the window is wide: everything was cleared on the way.
        self.first = wanted;
    }

    fn look(&self, cell: Cell) -> Option<(&Row, usize)> {
        self.has(cell).then(|| self.rows.get(local(cell.y))).flatten().map(|row| (row, local(cell.x)))
    }

    fn place(&mut self, cell: Cell) -> Option<(&mut Row, usize)> {
        self.has(cell).then(|| self.rows.get_mut(local(cell.y))).flatten().map(|row| (row, local(cell.x)))
    }

    /// The cell lies in the window.
    fn has(&self, cell: Cell) -> bool {
        let within = |value: i32, first: i32| (0..SIDE as i32).contains(&value.wrapping_sub(first));
        within(cell.x, self.first.x) && within(cell.y, self.first.y)
    }
}

/// Place of a cell in the rows, or in a row.
const fn local(cell: i32) -> usize {
    cell.rem_euclid(SIDE as i32) as usize
}

/// The cell of the window that has a place in the rows, or in a row.
const fn global(first: i32, index: usize) -> i32 {
    first.wrapping_add((index as i32).wrapping_sub(first).rem_euclid(SIDE as i32))
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
