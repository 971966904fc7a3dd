//! The window: three vertical grids around the robot that keep the front-most surfaces.

use floorguard_types::geometry::{Point3, Pose2};

use super::capacities::{FINE_WINDOW_CELLS, WINDOW_CELLS};
use super::cell::{CellContent, WindowCell};
use super::column::Column;
use super::face::Face;
use super::fusion::ScanPoints;
use super::geometry::WindowGeometry;
use super::lidar::LidarMount;
use super::people::People;
use crate::GridTooSmall;

/// Which point a cell keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CellPolicy {
    /// The last one that was written, within a scan (upwards) and across scans: as published. The upper edge of an object
    /// then shows what lies behind it.
    Compat,
    /// The nearest one: for obstacles. A newer reading replaces it that is at most one cell farther; what is farther only shows
    /// once the nearer surface was seen through.
    Nearest,
}

/// What may differ from robot to robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowOptions {
    /// Which point a cell keeps.
    pub policy: CellPolicy,
    /// Cells that two neighbouring scans see through are emptied. Without it, only person boxes empty cells, as published.
    pub clears_swept: bool,
    /// How the lidar is mounted.
    pub mount: LidarMount,
    /// Height of the panoramic camera above the robot's centre, metres: person boxes are directions from there.
    pub camera_height_m: f32,
}

impl WindowOptions {
    /// The published sensor, the camera just above the lidar; with clearing, which was not published.
    #[must_use]
    pub const fn published(policy: CellPolicy) -> Self {
        Self { policy, clears_swept: true, mount: LidarMount::PUBLISHED, camera_height_m: 0.70 }
    }
}

/// What was dropped since the window began. A total that saturates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WindowCounters {
    /// Points behind the robot, too high, too low or too far.
    pub points_outside: u32,
    /// Cells that left the window when the robot moved.
    pub cells_outside: u32,
    /// Cells that fell onto another one when the robot moved; the nearer one was kept.
    pub cells_merged: u32,
    /// Cells that were emptied because the lidar saw through them.
    pub cells_cleared: u32,
    /// Surfaces that were erased within a person's box.
    pub cells_erased: u32,
    /// Places of people that expired.
    pub people_expired: u32,
}

/// A cell that is not empty, as a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowPoint {
    /// In which grid.
    pub face: Face,
    /// Number of the cell within its grid: row by row from the floor, from right to left.
    pub index: usize,
    /// What it holds: a surface, or the place of a person.
    pub content: CellContent,
    /// Where, in the window's frame.
    pub point: Point3,
}

/// Local map of surfaces around the robot (Dalmedico et al. 2019). It moves with the robot: [`Self::follow`].
///
/// The frame of the window is that of the robot's base at [`Self::frame_in_odometry`], which is less than half a cell and 1°
/// behind the robot. Storage is handed in: two buffers of [`WindowGeometry::cells`] cells.
///
/// # Invariants
/// * What is refused changes nothing.
/// * A cell becomes empty only by a person's box, by leaving the window, or because two scans saw through it; never because
///   nothing was measured.
///
/// ```
/// use floorguard_mapping::sliding_window::{
///     CellPolicy, FixedSlidingWindow, SlidingWindow, WINDOW_CELLS, WindowCell, WindowGeometry, WindowOptions,
/// };
///
/// let geometry = WindowGeometry::of_resolution(0.05).unwrap();
/// let buffers = [vec![WindowCell::EMPTY; geometry.cells()], vec![WindowCell::EMPTY; geometry.cells()]];
/// let window = SlidingWindow::new(geometry, WindowOptions::published(CellPolicy::Nearest), buffers)?;
/// assert_eq!(window.points().count(), 0);
/// // On a board the buffers are arrays in a static.
/// assert_eq!(size_of::<[WindowCell; WINDOW_CELLS]>(), 142_848);
/// # Ok::<(), floorguard_mapping::GridTooSmall>(())
/// ```
#[derive(Clone, Debug)]
pub struct SlidingWindow<S> {
    pub(super) geometry: WindowGeometry,
    pub(super) options: WindowOptions,
    buffers: [S; 2],
    uses_second: bool,
    /// The window's frame; `None` before the first pose.
    pub(super) frame: Option<Pose2>,
    pub(super) points: ScanPoints,
    /// The two newest scans, for what both see through.
    pub(super) newest: Column,
    pub(super) previous: Column,
    pub(super) people: People,
    pub(super) counters: WindowCounters,
}

/// A window at 0.05 m whose storage is two arrays.
pub type FixedSlidingWindow = SlidingWindow<[WindowCell; WINDOW_CELLS]>;
/// A window at 0.025 m whose storage is two arrays.
pub type FixedFineSlidingWindow = SlidingWindow<[WindowCell; FINE_WINDOW_CELLS]>;

impl<S: AsRef<[WindowCell]> + AsMut<[WindowCell]>> SlidingWindow<S> {
    /// An empty window.
    ///
    /// # Errors
    /// A buffer holds fewer cells than the geometry needs.
    pub fn new(
        geometry: WindowGeometry,
        options: WindowOptions,
        buffers: [S; 2],
    ) -> Result<Self, GridTooSmall> {
        let needed = geometry.cells();
        let capacity = buffers.iter().map(|buffer| buffer.as_ref().len()).min().unwrap_or(0);
        if capacity < needed {
            return Err(GridTooSmall { needed, capacity });
        }
        let mut window = Self {
            geometry,
            options,
            buffers,
            uses_second: false,
            frame: None,
            points: ScanPoints::new(),
            newest: Column::NONE,
            previous: Column::NONE,
            people: People::new(),
            counters: WindowCounters::default(),
        };
        window.clear();
        Ok(window)
    }

    /// Forgets all surfaces and people; counters stay.
    pub fn clear(&mut self) {
        for buffer in &mut self.buffers {
            buffer.as_mut().fill(WindowCell::EMPTY);
        }
        self.newest = Column::NONE;
        self.previous = Column::NONE;
        self.people = People::new();
    }

    /// Columns, rows, edge of a cell.
    #[must_use]
    pub const fn geometry(&self) -> &WindowGeometry {
        &self.geometry
    }

    /// What was dropped.
    #[must_use]
    pub const fn counters(&self) -> WindowCounters {
        self.counters
    }

    /// Where the window's frame stands in odometry; the origin before the first pose.
    #[must_use]
    pub fn frame_in_odometry(&self) -> Pose2 {
        self.frame.unwrap_or_default()
    }

    /// The cells of a grid, row by row from the floor, from right to left.
    #[must_use]
    pub fn cells(&self, face: Face) -> &[WindowCell] {
        let [first, second] = &self.buffers;
        let buffer = if self.uses_second { second } else { first };
        let start = face.number().saturating_mul(self.geometry.face_cells());
        let end = start.saturating_add(self.geometry.face_cells());
        buffer.as_ref().get(start..end).unwrap_or(&[])
    }

    pub(super) fn cells_mut(&mut self, face: Face) -> &mut [WindowCell] {
        let start = face.number().saturating_mul(self.geometry.face_cells());
        let end = start.saturating_add(self.geometry.face_cells());
        self.both_buffers().0.get_mut(start..end).unwrap_or(&mut [])
    }

    /// All cells that are in use, and those that the next compensation writes.
    pub(super) fn both_buffers(&mut self) -> (&mut [WindowCell], &mut [WindowCell]) {
        let [first, second] = &mut self.buffers;
        let (used, spare) = if self.uses_second { (second, first) } else { (first, second) };
        (used.as_mut(), spare.as_mut())
    }

    pub(super) const fn swap_buffers(&mut self) {
        self.uses_second = !self.uses_second;
    }

    /// Every cell that is not empty: surfaces and places of people. Cost: one pass over all cells.
    pub fn points(&self) -> impl Iterator<Item = WindowPoint> + '_ {
        Face::ALL.into_iter().flat_map(move |face| {
            let filled = |(_, cell): &(usize, &WindowCell)| cell.content != CellContent::Empty;
            self.cells(face).iter().enumerate().filter(filled).map(move |(index, cell)| WindowPoint {
                face,
                index,
                content: cell.content,
                point: face.point(self.geometry.place(index, cell)),
            })
        })
    }
}

#[cfg(test)]
#[path = "window_tests.rs"]
mod tests;
