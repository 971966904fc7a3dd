//! Which returns of a sweep came from what moved: whole objects, not single voxels.
//!
//! A voxel at the edge of a cupboard may be free by a ray that just missed it; a column of a person is free nearly everywhere.
//! So columns decide by the share of their returns in free space, columns that touch decide together, and what is removed is
//! the object down to the floor. The floor itself stays.

use floorguard_types::geometry::Point3;

use super::columns::{Column, ColumnGrid, MEMBERS, Mark, Members};
use super::evidence::{Evidence, EvidenceRule};
use super::free_space::FreeSpace;
use super::voxels::VoxelStore;

/// How objects are judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgeRule {
    /// Reads voxels.
    pub evidence: EvidenceRule,
    /// Evidence counts from this height above the floor on, metres: below, rays at a flat angle pass through the floor's voxels.
    pub lowest_m: f32,
    /// Up to this height, metres.
    pub highest_m: f32,
    /// Of an object, returns lower than this above the floor stay, metres. A sweep sees hardly any floor in the columns of a body:
    /// the body hides it.
    pub floor_clearance_m: f32,
    /// Share of a column's returns in free space from which on it may have moved, 0 to 1.
    pub column_share: f32,
    /// The same of a whole object.
    pub object_share: f32,
    /// An object has at least so many returns in free space.
    pub object_points: u32,
    /// Columns beside an object, in which only what is known to stand stays.
    pub beside: u8,
}

impl Default for JudgeRule {
    fn default() -> Self {
        Self {
            evidence: EvidenceRule::default(),
            lowest_m: 0.12,
            highest_m: 2.2,
            floor_clearance_m: 0.0,
            column_share: 0.5,
            object_share: 0.6,
            object_points: 4,
            beside: 2,
        }
    }
}

/// What is decided about a return.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointVerdict {
    /// It stays; evidence of the space around it.
    Kept(Evidence),
    /// It stays: too low or too high for evidence, and not part of an object that moved.
    OutsideBand,
    /// It came from something that moved.
    Moved,
}

/// A sweep to be judged. Invariant: as many verdicts as points.
#[derive(Debug)]
pub struct JudgedSweep<'a> {
    /// Returns, in the map.
    pub points_in_map: &'a [Point3],
    /// Where the sensor was, in the map.
    pub sensor_in_map: Point3,
    /// Height of the floor, in the map.
    pub floor_m: f32,
    /// What was decided, return by return.
    pub verdicts: &'a mut [PointVerdict],
}

/// What came of a sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SweepOutcome {
    /// Returns of what moved.
    pub moved: u32,
    /// Objects that moved.
    pub objects: u32,
    /// Objects with free space in them that stay, because most of them stands.
    pub refused_objects: u32,
}

/// Judges sweep after sweep; holds the columns.
#[derive(Clone, Debug)]
pub struct SweepJudge<C> {
    rule: JudgeRule,
    grid: ColumnGrid<C>,
    members: Members,
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    points: u32,
    free: u32,
}

impl<C: AsRef<[Column]> + AsMut<[Column]>> SweepJudge<C> {
    /// A judge with this grid.
    #[must_use]
    pub const fn new(rule: JudgeRule, grid: ColumnGrid<C>) -> Self {
        Self { rule, grid, members: Members::new() }
    }

    /// Judges a sweep after all evidence is in. Cost: two passes over the returns and one over the columns; each column is
    /// part of one object.
    pub fn judge<S: VoxelStore>(&mut self, space: &FreeSpace<S>, sweep: JudgedSweep<'_>) -> SweepOutcome {
        self.grid.centre_on(sweep.sensor_in_map);
        self.read(space, sweep.points_in_map, sweep.floor_m, sweep.verdicts);
        let mut outcome = self.decide();
        let points = sweep.points_in_map.iter().zip(sweep.verdicts.iter_mut());
        for (point, verdict) in points {
            if self.has_moved(*point, *verdict, sweep.floor_m) {
                *verdict = PointVerdict::Moved;
                outcome.moved = outcome.moved.saturating_add(1);
            }
        }
        outcome
    }

    /// Enters evidence into verdicts and columns.
    fn read<S: VoxelStore>(
        &mut self,
        space: &FreeSpace<S>,
        points: &[Point3],
        floor_m: f32,
        verdicts: &mut [PointVerdict],
    ) {
        let mut reader = space.reader();
        for (point, verdict) in points.iter().zip(verdicts) {
            let height_m = point.z_m - floor_m;
            *verdict = PointVerdict::OutsideBand;
            if !(self.rule.lowest_m..=self.rule.highest_m).contains(&height_m) {
                continue;
            }
            let evidence = self.rule.evidence.read(reader.at(*point));
            *verdict = PointVerdict::Kept(evidence);
            let number = self.grid.number(*point);
            if let Some(column) = number.and_then(|number| self.grid.get_mut(number)) {
                column.points = column.points.saturating_add(1);
                column.free = column.free.saturating_add(u16::from(evidence == Evidence::Free));
            }
        }
    }

    /// Joins columns to objects and marks those that moved.
    fn decide(&mut self) -> SweepOutcome {
        let mut outcome = SweepOutcome::default();
        let share = self.rule.column_share;
        let may_move = move |column: &Column| {
            column.free > 0 && f32::from(column.free) >= share * f32::from(column.points)
        };
        for number in self.grid.numbers() {
            let column = self.grid.get(number);
            if column.mark != Mark::None || !may_move(&column) {
                continue;
            }
            let mut members = core::mem::take(&mut self.members);
            self.grid.part(number, may_move, &mut members);
            if self.is_object(&members) {
                outcome.objects = outcome.objects.saturating_add(1);
                for number in members.iter().take(MEMBERS) {
                    if let Some(column) = self.grid.get_mut(*number) {
                        column.mark = Mark::Moved;
                    }
                }
            } else {
                outcome.refused_objects = outcome.refused_objects.saturating_add(1);
            }
            self.members = members;
        }
        self.mark_beside();
        outcome
    }

    fn is_object(&self, members: &Members) -> bool {
        let mut sums = Sums::default();
        for number in members.iter().take(MEMBERS) {
            let column = self.grid.get(*number);
            sums.points = sums.points.saturating_add(u32::from(column.points));
            sums.free = sums.free.saturating_add(u32::from(column.free));
        }
        let (points, free) = (f64::from(sums.points), f64::from(sums.free));
        sums.free >= self.rule.object_points && free >= f64::from(self.rule.object_share) * points
    }

    /// Columns beside those that moved, once all objects are decided.
    fn mark_beside(&mut self) {
        let reach = i32::from(self.rule.beside);
        for number in self.grid.numbers() {
            if self.grid.get(number).mark != Mark::Moved {
                continue;
            }
            for other in self.grid.around(number, reach) {
                if let Some(column) = self.grid.get_mut(other).filter(|column| column.mark != Mark::Moved) {
                    column.mark = Mark::Beside;
                }
            }
        }
    }

    fn has_moved(&self, point: Point3, verdict: PointVerdict, floor_m: f32) -> bool {
        let mark = self.grid.number(point).map_or(Mark::None, |number| self.grid.get(number).mark);
        let height_m = point.z_m - floor_m;
        match (mark, verdict) {
            (Mark::Moved, PointVerdict::Kept(evidence)) => evidence != Evidence::Occupied,
            (Mark::Moved, PointVerdict::OutsideBand) => {
                (self.rule.floor_clearance_m..self.rule.lowest_m).contains(&height_m)
            }
            (Mark::Beside, PointVerdict::Kept(evidence)) => evidence != Evidence::Occupied,
            _ => false,
        }
    }
}
