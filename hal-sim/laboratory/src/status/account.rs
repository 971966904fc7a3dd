//! The numbers of the report, for the whole floor and for each zone.

use floorguard_cleaning::{CleanRule, Verdict};
use floorguard_mapping::poisson_tail;
use floorguard_mapping::{DirtCell, GridCoordinates};
use floorguard_types::geometry::Point2;
use serde::Serialize;

use super::spots::{Spot, spots};
use crate::mission::TrialResult;
use floorguard_robot::environment::Zone;
use floorguard_robot::site::Floor;

/// What became of a part of the floor, m².
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ZoneStatus {
    /// Name.
    pub zone: String,
    /// Free floor.
    pub floor_m2: f32,
    /// Of that, what the mission answers for: the brush can pass over all of it.
    pub answered_m2: f32,
    /// Of that, what the brush went over.
    pub swept_m2: f32,
    /// Dirty before.
    pub dirty_before_m2: f32,
    /// Of that, promised to be clean now.
    pub cleaned_m2: f32,
    /// Still dirty, where the robot can clean.
    pub dirty_after_m2: f32,
    /// Neither: too little is known to promise anything.
    pub uncertain_m2: f32,
    /// Dirty, and out of the robot's reach.
    pub dirty_unreachable_m2: f32,
    /// Spots before, of two cells at least.
    pub spots_before: usize,
    /// Spots of which any part is not promised to be clean.
    pub spots_after: usize,
}

impl ZoneStatus {
    fn areas_mut(&mut self) -> [&mut f32; 8] {
        [
            &mut self.floor_m2,
            &mut self.answered_m2,
            &mut self.swept_m2,
            &mut self.dirty_before_m2,
            &mut self.cleaned_m2,
            &mut self.dirty_after_m2,
            &mut self.uncertain_m2,
            &mut self.dirty_unreachable_m2,
        ]
    }
}

/// The report of one mission.
pub struct MissionStatus<'a> {
    /// The floor.
    pub floor: &'a Floor,
    /// What the mission came to.
    pub result: &'a TrialResult,
    /// Units that may stay in a clean cell.
    pub tolerated_units: u8,
    /// Confidence of a promise, within (0, 1).
    pub confidence: f64,
    /// Expected units in every cell before.
    pub expected: &'a [f32],
    /// Cells that were dirty before.
    pub is_dirty: Vec<bool>,
    /// Cells that the brush went over.
    pub is_swept: Vec<bool>,
    /// The whole floor.
    pub total: ZoneStatus,
    /// Its zones.
    pub zones: Vec<ZoneStatus>,
    /// The spots, largest first.
    pub spots: Vec<Spot>,
}

impl<'a> MissionStatus<'a> {
    /// Adds up a mission. `brush_m` is the width of the brush.
    #[must_use]
    pub fn new(
        (floor, result, expected): (&'a Floor, &'a TrialResult, &'a [f32]),
        (tolerated_units, delta): (u8, f64),
        brush_m: f32,
        zones: &[Zone],
    ) -> Self {
        let rule = CleanRule::per_cell(tolerated_units, delta);
        let needs_cleaning = |units: &f32| {
            let tail = poisson_tail(u32::from(tolerated_units), f64::from(*units)) as f32;
            rule.needs_cleaning(&DirtCell::poisson(*units, tail))
        };
        let is_dirty: Vec<bool> = expected.iter().map(needs_cleaning).collect();
        let mut all = spots(&floor.cells, expected, &is_dirty);
        for spot in &mut all {
            let clean = spot.cells.iter().filter(|&&cell| is_clean(result, cell)).count();
            spot.clean_share = clean as f32 / spot.cells.len().max(1) as f32;
        }
        let is_swept = swept(floor, &result.path, brush_m);
        let (total, parts) = (ZoneStatus::default(), Vec::new());
        let confidence = 1.0 - delta;
        let mut status = Self {
            floor,
            result,
            tolerated_units,
            confidence,
            expected,
            is_dirty,
            is_swept,
            total,
            zones: parts,
            spots: all,
        };
        status.total = status.account("whole floor", |_| true);
        let named = |zone: &Zone| status.account(&zone.name, |point| zone.contains(point));
        status.zones = zones.iter().map(named).filter(|zone| zone.floor_m2 > 0.0).collect();
        status
    }

    fn account(&self, name: &str, contains: impl Fn(Point2) -> bool) -> ZoneStatus {
        let geometry = &self.floor.cells;
        let cell_m2 = geometry.resolution_m() * geometry.resolution_m();
        let mut zone = ZoneStatus { zone: name.to_owned(), ..ZoneStatus::default() };
        for cell in (0..geometry.cell_count()).filter(|&cell| contains(geometry.centre(cell))) {
            let mut add = |area: fn(&mut ZoneStatus) -> &mut f32, counts: bool| {
                *area(&mut zone) += f32::from(u8::from(counts));
            };
            let answered = self.floor.reachable[cell];
            let was_dirty = self.is_dirty[cell];
            let verdict = self.result.verdicts.get(cell).copied().flatten();
            let is_free =
                self.floor.clearance.clearance_m(geometry.centre(cell)) >= 0.5 * geometry.resolution_m();
            add(|zone| &mut zone.floor_m2, is_free || answered);
            add(|zone| &mut zone.answered_m2, answered);
            add(|zone| &mut zone.swept_m2, answered && self.is_swept[cell]);
            add(|zone| &mut zone.dirty_before_m2, was_dirty);
            add(|zone| &mut zone.cleaned_m2, was_dirty && verdict == Some(Verdict::Clean));
            add(|zone| &mut zone.dirty_after_m2, matches!(verdict, Some(Verdict::Dirty | Verdict::Active)));
            add(|zone| &mut zone.uncertain_m2, verdict == Some(Verdict::Uncertain));
            add(|zone| &mut zone.dirty_unreachable_m2, was_dirty && !answered);
        }
        // Whole cells were counted: their sum is exact.
        for area in zone.areas_mut() {
            *area *= cell_m2;
        }
        let inside = |spot: &&Spot| contains(Point2::new(spot.x_m, spot.y_m));
        zone.spots_before = self.spots.iter().filter(inside).count();
        zone.spots_after = self.spots.iter().filter(inside).filter(|spot| spot.clean_share < 1.0).count();
        zone
    }

    /// The result in one sentence, without promising more than the belief does.
    #[must_use]
    pub fn sentence(&self) -> String {
        let total = &self.total;
        let percent = 100.0 * self.confidence;
        let mut open = Vec::new();
        let mut add = |area_m2: f32, what: &str| {
            if area_m2 > 0.005 {
                open.push(format!("{area_m2:.2} m² {what}"));
            }
        };
        add(total.dirty_after_m2, "still dirty");
        add(total.uncertain_m2, "uncertain");
        add(total.dirty_unreachable_m2, "dirty but out of reach");
        let promise = format!("a cell is called clean only if it is with {percent:.1} % confidence");
        if open.is_empty() {
            format!("Clean: all {:.2} m² that were dirty; {promise}.", total.dirty_before_m2)
        } else {
            format!(
                "Not everything: {:.2} of {:.2} m² that were dirty are clean; {}; {promise}.",
                total.cleaned_m2,
                total.dirty_before_m2,
                open.join(", ")
            )
        }
    }
}

fn is_clean(result: &TrialResult, cell: usize) -> bool {
    result.verdicts.get(cell).copied().flatten() == Some(Verdict::Clean)
}

/// Cells whose middle the brush went over.
fn swept(floor: &Floor, path: &[Point2], brush_m: f32) -> Vec<bool> {
    let geometry = &floor.cells;
    let mut is_swept = vec![false; geometry.cell_count()];
    let reach = (0.5 * brush_m / geometry.resolution_m()).ceil() as i32 + 1;
    let mut touch = |point: Point2| {
        let GridCoordinates { column, row } = geometry.coordinates_of(point);
        for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
            if let Some(cell) = geometry.index(column + dx, row + dy)
                && geometry.centre(cell).distance(point) <= 0.5 * brush_m
            {
                is_swept[cell] = true;
            }
        }
    };
    for pair in path.windows(2) {
        let steps = (pair[0].distance(pair[1]) / 0.02).ceil().max(1.0);
        for step in 0..=steps as usize {
            let share = step as f32 / steps;
            let along = |from: f32, to: f32| from + share * (to - from);
            touch(Point2::new(along(pair[0].x_m, pair[1].x_m), along(pair[0].y_m, pair[1].y_m)));
        }
    }
    is_swept
}
