//! Takes a scan: checks, moves the window, empties what was seen through, and writes the new points.

use floorguard_types::geometry::{Point3, Pose2};
use floorguard_types::time::Stamp;

use super::capacities::WINDOW_BEAMS_MAX;
use super::cell::{CellContent, WindowCell, kept_elevation, tick_of};
use super::clearing::SweptWedge;
use super::compensation::{Rigid, is_finite};
use super::error::ScanError;
use super::face::Face;
use super::fusion::{Reach, ScanPoint, fuse};
use super::lidar::{ColumnScan, for_each_point};
use super::motor::MotorTrack;
use super::window::{CellPolicy, SlidingWindow};

/// The floor is this thick, metres: noise of the lidar where it looks down. What lies deeper is no floor.
const FLOOR_NOISE_M: f32 = 0.05;

/// What became of a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Inserted {
    /// Points that were written as surfaces, after neighbours became one.
    pub surfaces: u16,
    /// Points within person boxes: they mark the place of a person.
    pub people: u16,
    /// Points outside of the window.
    pub outside: u16,
    /// Cells that were emptied because this scan and the one before see through them.
    pub cleared: u32,
    /// Directions swept since the scan before; `None` after a pause.
    pub swept: Option<SweptWedge>,
}

/// A place to write: its cell, and what goes there.
#[derive(Clone, Copy)]
struct Target {
    face: Face,
    index: usize,
    cell: WindowCell,
}

impl<S: AsRef<[WindowCell]> + AsMut<[WindowCell]>> SlidingWindow<S> {
    /// Takes a scan that was measured while the base stood at a pose in odometry (that of the middle of the scan).
    ///
    /// # Errors
    /// [`ScanError`]: nothing was inserted or moved.
    pub fn insert(
        &mut self,
        scan: &ColumnScan<'_>,
        motor: &MotorTrack,
        base_in_odometry: Pose2,
    ) -> Result<Inserted, ScanError> {
        scan.check()?;
        if !is_finite(base_in_odometry) {
            return Err(ScanError::NotFinite);
        }
        if !self.newest.is_none() && scan.first_beam <= self.newest.stamp {
            return Err(ScanError::OutOfOrder { behind_us: scan.first_beam.past_us(self.newest.stamp) });
        }
        if let Some(standing_us) = motor.stalled_us() {
            return Err(ScanError::MotorStalled { standing_us });
        }
        let frame = self.frame_for(base_in_odometry);
        let window_from_base = frame.inverse().compose(base_in_odometry);
        self.points.clear();
        let points = &mut self.points;
        let angles = for_each_point(scan, &self.options.mount, (motor, window_from_base), |point| {
            // As many points as beams, and those were counted: never full.
            let _full = points.push(ScanPoint { point, is_person: false });
        })?;
        self.move_frame(frame);
        let stamp = scan.stamp_of(scan.beams.len());
        self.expire(stamp);
        core::mem::swap(&mut self.previous, &mut self.newest);
        self.newest.take(scan, &self.options.mount, (angles, base_in_odometry));
        let swept = self.swept_wedge();
        let cleared = swept.map_or(0, |wedge| self.clear_swept(wedge, stamp));
        Ok(Inserted { cleared, swept, ..self.write_points(stamp) })
    }

    /// Takes points of another kind of scan, in the base frame at a pose in odometry: a lidar that another mechanism moves.
    /// Neighbours in the order given become one; at most 768 are taken. Without a known direction of the beams no cell is
    /// emptied.
    ///
    /// # Errors
    /// [`ScanError::BeamCount`] for more points, [`ScanError::NotFinite`] for a pose that is not finite: nothing was inserted.
    pub fn insert_points(
        &mut self,
        points_in_base: &[Point3],
        base_in_odometry: Pose2,
        stamp: Stamp,
    ) -> Result<Inserted, ScanError> {
        if points_in_base.len() > WINDOW_BEAMS_MAX {
            return Err(ScanError::BeamCount { beams: points_in_base.len() });
        }
        if !is_finite(base_in_odometry) {
            return Err(ScanError::NotFinite);
        }
        let frame = self.frame_for(base_in_odometry);
        self.move_frame(frame);
        self.expire(stamp);
        let window_from_base = Rigid::of(frame.inverse().compose(base_in_odometry));
        self.points.clear();
        for point in points_in_base.iter().take(WINDOW_BEAMS_MAX) {
            let point = window_from_base.transform(*point);
            // As many as were counted above: never full.
            let _full = self.points.push(ScanPoint { point, is_person: false });
        }
        Ok(self.write_points(stamp))
    }

    /// Masks, fuses and writes the points of the scan.
    fn write_points(&mut self, stamp: Stamp) -> Inserted {
        self.mask(stamp);
        let reach = match self.options.policy {
            CellPolicy::Compat => Reach::OfMean(self.geometry.resolution_m()),
            CellPolicy::Nearest => Reach::OfFirst(self.geometry.resolution_m()),
        };
        fuse(&mut self.points, reach);
        let tick = tick_of(stamp);
        let cell_steps = kept_elevation(self.geometry.resolution_m()).unwrap_or(0);
        let mut inserted = Inserted::default();
        if self.options.policy == CellPolicy::Nearest {
            // The newest reading of a surface replaces the older ones. A surface nearer than it by more than a cell stays:
            // rays of other directions pass the same cell behind it.
            for place in 0..self.points.len().min(WINDOW_BEAMS_MAX) {
                if let Some(target) = self.target(place, tick)
                    && let Some(cell) = self.cells_mut(target.face).get_mut(target.index)
                    && cell.elevation.saturating_add(cell_steps) >= target.cell.elevation
                {
                    cell.content = CellContent::Empty;
                }
            }
        }
        for place in 0..self.points.len().min(WINDOW_BEAMS_MAX) {
            let Some(target) = self.target(place, tick) else {
                inserted.outside = inserted.outside.saturating_add(1);
                continue;
            };
            let count = match target.cell.content {
                CellContent::Person => &mut inserted.people,
                CellContent::Surface | CellContent::Empty => &mut inserted.surfaces,
            };
            *count = count.saturating_add(1);
            self.write(target);
        }
        if inserted.people > 0 {
            self.people.note_marks(stamp);
        }
        self.counters.points_outside =
            self.counters.points_outside.saturating_add(u32::from(inserted.outside));
        inserted
    }

    /// The cell of a point of the scan; `None` outside of the window.
    fn target(&self, place: usize, tick: u16) -> Option<Target> {
        let ScanPoint { point, is_person } = *self.points.get(place)?;
        let face = Face::of_direction(point.x_m, point.y_m)?;
        let mut seen = face.project(point);
        if (-FLOOR_NOISE_M..0.0).contains(&seen.up_m) {
            seen.up_m = 0.0;
        }
        let slot = self.geometry.slot(seen)?;
        let content = if is_person { CellContent::Person } else { CellContent::Surface };
        let elevation = kept_elevation(seen.elevation_m)?;
        let cell = WindowCell { elevation, tick, along: slot.along, up: slot.up, content, hits: 1 };
        Some(Target { face, index: slot.index, cell })
    }

    fn write(&mut self, target: Target) {
        let is_nearest = self.options.policy == CellPolicy::Nearest;
        let Some(cell) = self.cells_mut(target.face).get_mut(target.index) else { return };
        let is_farther = cell.content != CellContent::Empty && cell.elevation <= target.cell.elevation;
        let hits = cell.hits.saturating_add(1);
        if is_nearest && is_farther {
            cell.hits = hits;
        } else {
            *cell = WindowCell { hits, ..target.cell };
        }
    }
}
