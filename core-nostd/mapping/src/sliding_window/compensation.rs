//! The window moves with the robot.
//!
//! Every cell that is not empty is moved as a point: its elevation to an eighth of a millimetre, its place within the cell to
//! a 256th of the edge. Moving cell centres instead would add up to half a cell with each movement. The frame always becomes the robot's pose itself, so that what the threshold leaves over never adds up.

use floorguard_types::geometry::{Point2, Point3, Pose2, wrap_angle};

use super::cell::{CellContent, ELEVATION_STEP_M, WindowCell, kept_elevation};
use super::face::{Face, FacePoint};
use super::geometry::WindowGeometry;
use super::turn::{Fate, Turn};
use super::window::SlidingWindow;

/// The window follows after half a cell, or after one degree, radians: at 3 m that is a cell.
const TURNED_RAD: f32 = 0.017_453_3;
const MOVED_CELLS: f32 = 0.5;
/// So many cells side by side are asked at once whether they are empty.
const GROUP: usize = 4;

/// What a movement did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Movement {
    /// Cells that were moved.
    pub moved: u32,
    /// Cells that left the window.
    pub outside: u32,
    /// Cells that fell onto a nearer one.
    pub merged: u32,
}

/// A pose as rotation and translation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rigid {
    pub(super) cos: f32,
    pub(super) sin: f32,
    pub(super) x_m: f32,
    pub(super) y_m: f32,
}

impl Rigid {
    pub(super) fn of(pose: Pose2) -> Self {
        let (sin, cos) = libm::sincosf(pose.heading_rad);
        Self { cos, sin, x_m: pose.x_m, y_m: pose.y_m }
    }

    pub(super) fn transform(&self, point: Point3) -> Point3 {
        Point3::new(
            self.x_m + self.cos * point.x_m - self.sin * point.y_m,
            self.y_m + self.sin * point.x_m + self.cos * point.y_m,
            point.z_m,
        )
    }

    pub(super) fn transform_flat(&self, point: Point2) -> Point2 {
        let moved = self.transform(Point3::new(point.x_m, point.y_m, 0.0));
        Point2::new(moved.x_m, moved.y_m)
    }
}

pub(super) fn is_finite(pose: Pose2) -> bool {
    pose.x_m.is_finite() && pose.y_m.is_finite() && pose.heading_rad.is_finite()
}

impl<S: AsRef<[WindowCell]> + AsMut<[WindowCell]>> SlidingWindow<S> {
    /// Moves the window to the robot, if it has gone half a cell or turned one degree since the window last moved. A pose that
    /// is not finite moves nothing. Cost: one pass over all cells, some 80 operations for each that is not empty.
    ///
    /// ```
    /// use floorguard_mapping::sliding_window::{CellPolicy, SlidingWindow, WindowCell, WindowGeometry, WindowOptions};
    /// use floorguard_types::geometry::Pose2;
    ///
    /// let geometry = WindowGeometry::of_resolution(0.05).unwrap();
    /// let buffers = [vec![WindowCell::EMPTY; geometry.cells()], vec![WindowCell::EMPTY; geometry.cells()]];
    /// let mut window = SlidingWindow::new(geometry, WindowOptions::published(CellPolicy::Nearest), buffers)?;
    /// window.follow(Pose2::new(0.0, 0.0, 0.0));
    /// window.follow(Pose2::new(0.02, 0.0, 0.0));
    /// assert_eq!(window.frame_in_odometry().x_m, 0.0);
    /// window.follow(Pose2::new(0.03, 0.0, 0.0));
    /// assert_eq!(window.frame_in_odometry().x_m, 0.03);
    /// # Ok::<(), floorguard_mapping::GridTooSmall>(())
    /// ```
    pub fn follow(&mut self, base_in_odometry: Pose2) -> Movement {
        if !is_finite(base_in_odometry) {
            return Movement::default();
        }
        self.move_frame(self.frame_for(base_in_odometry))
    }

    /// Where the frame stands once the window follows to a pose.
    pub(super) fn frame_for(&self, base_in_odometry: Pose2) -> Pose2 {
        let Some(frame) = self.frame else { return base_in_odometry };
        let (x, y) = (base_in_odometry.x_m - frame.x_m, base_in_odometry.y_m - frame.y_m);
        let least_m = MOVED_CELLS * self.geometry.resolution_m();
        let turned_rad = libm::fabsf(wrap_angle(base_in_odometry.heading_rad - frame.heading_rad));
        let is_due = x * x + y * y >= least_m * least_m || turned_rad >= TURNED_RAD;
        if is_due { base_in_odometry } else { frame }
    }

    pub(super) fn move_frame(&mut self, to: Pose2) -> Movement {
        let from = self.frame.unwrap_or(to);
        self.frame = Some(to);
        if from == to {
            return Movement::default();
        }
        let new_from_old = Rigid::of(to.inverse().compose(from));
        let geometry = self.geometry;
        let (used, spare) = self.both_buffers();
        let mut movement = Movement::default();
        for (face, cells) in Face::ALL.into_iter().zip(used.chunks_exact_mut(geometry.face_cells().max(1))) {
            let one = move_face((face, cells), spare, (&geometry, &new_from_old));
            movement.moved = movement.moved.saturating_add(one.moved);
            movement.merged = movement.merged.saturating_add(one.merged);
            movement.outside = movement.outside.saturating_add(one.outside);
        }
        self.swap_buffers();
        self.counters.cells_outside = self.counters.cells_outside.saturating_add(movement.outside);
        self.counters.cells_merged = self.counters.cells_merged.saturating_add(movement.merged);
        movement
    }
}

/// Moves the cells of a grid into the other buffer and leaves the grid empty, for the next movement. Cost: 60 instructions for
/// each cell that is not empty, three for another one.
fn move_face(
    (face, cells): (Face, &mut [WindowCell]),
    spare: &mut [WindowCell],
    (geometry, new_from_old): (&WindowGeometry, &Rigid),
) -> Movement {
    let mover = Mover { face, geometry, new_from_old, turn: Turn::of(face, geometry, new_from_old) };
    let columns = geometry.columns().max(1);
    let face_start = face.number().saturating_mul(geometry.face_cells());
    let mut movement = Movement::default();
    for (row, cells) in cells.chunks_exact_mut(columns).enumerate() {
        let row_start = row.saturating_mul(columns);
        let start = face_start.saturating_add(row_start);
        let row = spare.get_mut(start..start.saturating_add(columns)).unwrap_or(&mut []);
        let (groups, rest) = cells.as_chunks_mut::<GROUP>();
        let mut column = 0_i32;
        let mut is_left = false;
        for [a, b, c, d] in groups {
            if [&*a, &*b, &*c, &*d].map(|cell| cell.content) != [CellContent::Empty; GROUP] {
                is_left |= mover.move_cell((column, a), row, &mut movement);
                is_left |= mover.move_cell((column.wrapping_add(1), b), row, &mut movement);
                is_left |= mover.move_cell((column.wrapping_add(2), c), row, &mut movement);
                is_left |= mover.move_cell((column.wrapping_add(3), d), row, &mut movement);
            }
            column = column.wrapping_add(4);
        }
        for (column, cell) in (column..).zip(rest) {
            is_left |= mover.move_cell((column, cell), row, &mut movement);
        }
        if is_left {
            mover.change_face((row_start, cells), spare, &mut movement);
        }
    }
    movement
}

/// A movement of the cells of one grid.
struct Mover<'a> {
    face: Face,
    geometry: &'a WindowGeometry,
    new_from_old: &'a Rigid,
    turn: Turn,
}

impl Mover<'_> {
    /// Moves a cell of a column within its row. A cell that is another grid's now stays, and it is true.
    #[inline(always)]
    fn move_cell(
        &self,
        (column, cell): (i32, &mut WindowCell),
        row: &mut [WindowCell],
        movement: &mut Movement,
    ) -> bool {
        if cell.content == CellContent::Empty {
            return false;
        }
        match self.turn.apply(cell.elevation, column, cell.along) {
            Fate::Stays(turned) => {
                (cell.elevation, cell.along) = (turned.elevation, turned.along);
                put(row.get_mut(turned.column), cell, movement);
                false
            }
            Fate::Outside => {
                put(None, cell, movement);
                false
            }
            Fate::Leaves => true,
        }
    }

    /// Moves what is left of a row: it is nearer to the normal of another grid now. The robot moves on the
    /// floor: rows stay.
    #[inline(never)]
    fn change_face(
        &self,
        (row_start, cells): (usize, &mut [WindowCell]),
        spare: &mut [WindowCell],
        movement: &mut Movement,
    ) {
        for (column, cell) in cells.iter_mut().enumerate() {
            if cell.content == CellContent::Empty {
                continue;
            }
            let seen = FacePoint {
                along_m: self.geometry.along_m(column, cell.along),
                up_m: 0.0,
                elevation_m: f32::from(cell.elevation) * ELEVATION_STEP_M,
            };
            let point = self.new_from_old.transform(self.face.point(seen));
            let place = Face::of_direction(point.x_m, point.y_m).and_then(|face| {
                let seen = face.project(point);
                let column = self.geometry.column(seen.along_m)?;
                let elevation = kept_elevation(seen.elevation_m)?;
                (cell.elevation, cell.along) = (elevation, column.steps);
                let face_start = face.number().saturating_mul(self.geometry.face_cells());
                spare.get_mut(face_start.saturating_add(row_start).saturating_add(column.cell))
            });
            put(place, cell, movement);
        }
    }
}

/// Takes a cell to its place, if there is one; of two on one place the nearer one stays.
#[inline]
fn put(place: Option<&mut WindowCell>, cell: &mut WindowCell, movement: &mut Movement) {
    match place {
        Some(place) if place.content == CellContent::Empty => {
            *place = *cell;
            movement.moved = movement.moved.wrapping_add(1);
        }
        Some(place) => {
            if cell.elevation < place.elevation {
                *place = *cell;
            }
            movement.merged = movement.merged.wrapping_add(1);
        }
        None => movement.outside = movement.outside.wrapping_add(1),
    }
    *cell = WindowCell::EMPTY;
}
