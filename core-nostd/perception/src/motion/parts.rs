//! Groups the returns that fill formerly free space into parts: what moves, cut out of whatever it touches.
//!
//! Own. A cluster that holds a person and the shelf that he brushes past is neither moving nor static. Its new returns
//! are: they are gathered by their place on the floor, and compared with all the returns around them, so that a wall
//! with a few stray ones is none.

use super::voxels::{Cell, VOXEL_M, Voxels, floor};
use floorguard_types::geometry::Point3;
use floorguard_types::number::{count_f32, exact_usize, saturating_i32, truncating_u32};
use floorguard_types::profile::{Entry, List, ListOf, Profile, Size, Table, TableOf};

/// A return this near to a part belongs to it, metres along x and y each.
const JOIN_M: f32 = 0.25;
/// No part is wider than this, metres: a walking person with swinging arms, or a pushed trolley in two.
const WIDEST_M: f32 = 1.2;
/// Of the returns of a part at least one in so many continues a surface that stands: a board between two rings shows
/// itself line by line as the robot drives, and runs along with it.
const UPRIGHT_ONE_IN: u32 = 4;
/// Edge of a floor cell that counts returns, in voxels: a power of two.
const CELL_VOXELS: usize = 4;
/// The same, metres.
const CELL_M: f32 = VOXEL_M * count_f32(CELL_VOXELS);
const _: () = assert!(CELL_VOXELS.is_power_of_two());

/// Returns of objects per floor cell, by y, then by x: as wide as the voxels; wraps around like them.
type Counts<S> = TableOf<TableOf<u16, S>, S>;

/// Returns that are new and close together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Part {
    /// Smallest x, y, z, in the frame of the odometry, metres.
    pub lower: Point3,
    /// Largest x, y, z.
    pub upper: Point3,
    /// Mean.
    pub centroid: Point3,
    /// New returns.
    pub points: u16,
    /// Returns of objects on the floor cells below it, new or not.
    pub points_around: u16,
    /// Of the new ones those that stand on another of the ring below.
    upright: u16,
    sums: [f32; 3],
}

/// Working memory of one sweep.
#[derive(Clone, Debug)]
pub(super) struct Parts<P: Profile> {
    pub(super) list: ListOf<Part, P::MotionObjects>,
    counts: Counts<P::MotionCells>,
    /// New returns that belong to no part while the part list is full.
    pub(super) dropped: u32,
}

fn index(metres: f32) -> i32 {
    floor(metres * (1.0 / VOXEL_M)) >> CELL_VOXELS.trailing_zeros()
}

fn wrap<S: Size>(index: i32) -> usize {
    exact_usize(truncating_u32(index)) & (S::N - 1)
}

impl<P: Profile> Parts<P> {
    pub(super) const fn new() -> Self {
        const {
            let reach_m = Voxels::<P::MotionVoxels>::REACH_M;
            assert!(
                P::MotionCells::N.is_power_of_two() && count_f32(P::MotionCells::N) * CELL_M > 2.0 * reach_m
            );
        }
        Self { list: List::EMPTY, counts: Entry::BLANK, dropped: 0 }
    }

    /// Starts a sweep.
    pub(super) fn clear(&mut self) {
        self.list.clear();
        self.counts.iter_mut().for_each(|row| row.fill(0));
    }

    /// Counts a return of an object in a voxel, new or not.
    pub(super) fn count(&mut self, (x, y, _): Cell) {
        let coarse = |index: i32| index >> CELL_VOXELS.trailing_zeros();
        let row = self.counts.get_mut(wrap::<P::MotionCells>(coarse(y)));
        if let Some(count) = row.and_then(|row| row.get_mut(wrap::<P::MotionCells>(coarse(x)))) {
            *count = count.saturating_add(1);
        }
    }

    /// Adds a new return to the first part that is near, or starts one. Returns come column by column, so that parts
    /// grow from their neighbours.
    pub(super) fn add(&mut self, point: Point3, is_upright: bool) {
        if let Some(part) = self.list.iter_mut().find(|part| part.takes(point)) {
            part.include(point, is_upright);
            return;
        }
        let mut part = Part { lower: point, upper: point, ..Part::default() };
        part.include(point, is_upright);
        if self.list.push(part).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        }
    }

    /// Ends the sweep: keeps the parts of at least `points_min` returns that make up enough of what is around them
    /// (`points · sensitivity > 2 · around`, as a cluster is judged).
    pub(super) fn finish(&mut self, points_min: u16, sensitivity: u16) {
        self.merge();
        let counts = &self.counts;
        for part in self.list.iter_mut() {
            part.finish::<P::MotionCells>(counts);
        }
        self.list.retain(|part| {
            part.points >= points_min
                && u32::from(part.upright) * UPRIGHT_ONE_IN >= u32::from(part.points)
                && u32::from(part.points) * u32::from(sensitivity) > 2 * u32::from(part.points_around)
        });
    }
}

impl<P: Profile> Parts<P> {
    /// Joins parts that grew together: at most one pass over all pairs.
    fn merge(&mut self) {
        for first in 0..P::MotionObjects::N {
            let Some((head, tail)) = self.list.split_at_mut_checked(first.saturating_add(1)) else { return };
            let Some(part) = head.last_mut().filter(|part| part.points > 0) else { continue };
            for other in tail.iter_mut().filter(|other| other.points > 0) {
                if part.takes(other.lower) && part.takes(other.upper) {
                    part.absorb(other);
                    other.points = 0;
                }
            }
        }
        self.list.retain(|part| part.points > 0);
    }
}

impl Part {
    fn takes(&self, point: Point3) -> bool {
        let fits = |lower: f32, upper: f32, value: f32| {
            value >= lower - JOIN_M
                && value <= upper + JOIN_M
                && upper.max(value) - lower.min(value) <= WIDEST_M
        };
        fits(self.lower.x_m, self.upper.x_m, point.x_m) && fits(self.lower.y_m, self.upper.y_m, point.y_m)
    }

    fn include(&mut self, point: Point3, is_upright: bool) {
        self.upright = self.upright.saturating_add(u16::from(is_upright));
        let Point3 { x_m, y_m, z_m } = point;
        self.points = self.points.saturating_add(1);
        self.lower = Point3::new(self.lower.x_m.min(x_m), self.lower.y_m.min(y_m), self.lower.z_m.min(z_m));
        self.upper = Point3::new(self.upper.x_m.max(x_m), self.upper.y_m.max(y_m), self.upper.z_m.max(z_m));
        let [x, y, z] = self.sums;
        self.sums = [x + x_m, y + y_m, z + z_m];
    }

    fn absorb(&mut self, other: &Self) {
        let least = |a: Point3, b: Point3| Point3::new(a.x_m.min(b.x_m), a.y_m.min(b.y_m), a.z_m.min(b.z_m));
        let most = |a: Point3, b: Point3| Point3::new(a.x_m.max(b.x_m), a.y_m.max(b.y_m), a.z_m.max(b.z_m));
        (self.lower, self.upper) = (least(self.lower, other.lower), most(self.upper, other.upper));
        self.points = self.points.saturating_add(other.points);
        self.upright = self.upright.saturating_add(other.upright);
        let ([x, y, z], [dx, dy, dz]) = (self.sums, other.sums);
        self.sums = [x + dx, y + dy, z + dz];
    }

    fn finish<S: Size>(&mut self, counts: &Counts<S>) {
        let count = f32::from(self.points.max(1));
        let [x, y, z] = self.sums;
        self.centroid = Point3::new(x / count, y / count, z / count);
        // At most WIDEST_M wide: four cells and the one in which it begins.
        const CELLS: i32 = saturating_i32(WIDEST_M / CELL_M) + 1;
        let (first_x, first_y) = (index(self.lower.x_m), index(self.lower.y_m));
        let (last_x, last_y) = (index(self.upper.x_m), index(self.upper.y_m));
        for (dx, dy) in (0..=CELLS).flat_map(|dy| (0..=CELLS).map(move |dx| (dx, dy))) {
            let (x, y) = (first_x.saturating_add(dx), first_y.saturating_add(dy));
            if x <= last_x && y <= last_y {
                let row = counts.get(wrap::<S>(y));
                let around = row.and_then(|row| row.get(wrap::<S>(x))).copied().unwrap_or(0);
                self.points_around = self.points_around.saturating_add(around);
            }
        }
    }

    /// Of the box around it, cubic metres.
    pub(super) fn volume_m3(&self) -> f32 {
        (self.upper.x_m - self.lower.x_m)
            * (self.upper.y_m - self.lower.y_m)
            * (self.upper.z_m - self.lower.z_m)
    }
}
