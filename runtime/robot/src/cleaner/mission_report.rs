//! What the mission tells of itself.

use floorguard_cleaning::Verdict;
use floorguard_mapping::DirtCell;
use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

use super::mission::Cleaner;
use super::plan::MissionStrategy;
use super::progress::{CellState, Doubt, MissionProgress, UncertainCell};

/// Centres of a tour that are reported.
const TOUR_REPORTED: usize = 1_024;

impl Cleaner {
    /// The mission now.
    #[must_use]
    pub fn progress(&self, stamp: Stamp) -> MissionProgress {
        let (raster, floor) = (*self.ground.raster(), &self.ground.floor);
        let map = self.localiser.map.values();
        let state = |cell: usize, dirt: &DirtCell| {
            if !floor.reachable[cell] {
                return CellState::OffLimits;
            }
            match self.rule.verdict(dirt) {
                Verdict::Clean => CellState::Clean,
                Verdict::Active => CellState::Active,
                Verdict::Dirty => CellState::Dirty,
                Verdict::Uncertain => CellState::Uncertain,
            }
        };
        let cells: Vec<CellState> = map.iter().enumerate().map(|(cell, dirt)| state(cell, dirt)).collect();
        let was_dirty: Vec<bool> = self
            .plan
            .prior(&self.ground.expected)
            .iter()
            .map(|dirt| self.rule.needs_cleaning(dirt))
            .collect();
        let share = |asked: &dyn Fn(usize) -> bool| {
            let all = (0..cells.len()).filter(|cell| floor.reachable[*cell] && asked(*cell));
            let (count, clean) = all.fold((0_u32, 0_u32), |(count, clean), cell| {
                (count + 1, clean + u32::from(cells[cell] == CellState::Clean))
            });
            if count == 0 { 1.0 } else { clean as f32 / count as f32 }
        };
        let uncertain = cells.iter().enumerate().filter(|(_, state)| {
            matches!(state, CellState::Dirty | CellState::Uncertain | CellState::Active)
        });
        let uncertain = uncertain.map(|(cell, state)| UncertainCell {
            cell,
            expected_units: map.get(cell).map_or(0.0, |dirt| dirt.expected_units),
            doubt: self.doubt(cell, *state),
        });
        let odometry = self.odometry.pose_in_odometry;
        MissionProgress {
            stamp,
            phase: self.phase,
            geometry: raster,
            odometry_in_map: self.pose().compose(odometry.inverse()),
            position_deviation_m: self.localiser.doubt_m(),
            completion: share(&|cell| was_dirty[cell]),
            claimed_fraction: share(&|_| true),
            uncertain: uncertain.collect(),
            unreachable_cells: (0..cells.len())
                .filter(|cell| was_dirty[*cell] && !floor.reachable[*cell])
                .count(),
            tour: self.tours.tour().take(TOUR_REPORTED).map(|cell| raster.centre(cell)).collect(),
            waypoints: self.track.rest().iter().map(|at| place(at.pose_in_map)).collect(),
            distance_m: self.distance_m,
            waited_s: self.times.lost_s(),
            times: self.times,
            detours: self.detours,
            lanes: (self.plan.strategy == MissionStrategy::Systematic).then(|| self.lanes.count()),
            expected_before: self.ground.expected.clone(),
            expected_now: map.iter().map(|dirt| dirt.expected_units).collect(),
            cells,
        }
    }

    fn doubt(&self, cell: usize, state: CellState) -> Doubt {
        if !self.tours.may_visit(cell) {
            Doubt::GivenUp
        } else if state == CellState::Uncertain
            || state == CellState::Active
            || self.tours.visits_of(cell) > 0
        {
            Doubt::PathUnsure
        } else if self.obstructed[cell] {
            Doubt::Obstructed
        } else {
            Doubt::NotVisited
        }
    }
}

const fn place(pose: Pose2) -> floorguard_types::geometry::Point2 {
    floorguard_types::geometry::Point2 { x_m: pose.x_m, y_m: pose.y_m }
}

#[cfg(test)]
mod tests {
    use super::super::mission::SharedWatch;
    use super::super::plan::MissionPlan;
    use super::super::store::{Saved, Store};
    use super::*;
    use floorguard_configuration::{EXAMPLE, parse};
    use floorguard_mapping::NO_SLOT;
    use std::sync::Arc;

    /// A computer that comes back knows where it was and what it had cleaned.
    #[test]
    fn cleaned_cells_survive_a_power_cut() {
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let plan = MissionPlan::supermarket();
        let store = Store::Memory(Arc::default());
        let begin = || Cleaner::new(&plan, &robot, (SharedWatch::default(), store.clone())).unwrap();
        let first = begin();
        assert_eq!(first.progress(Stamp::ZERO).completion, 0.0);
        let prior = plan.prior(&first.ground.expected);
        let mut cells = prior.clone();
        let dirty: Vec<usize> =
            (0..cells.len()).filter(|cell| first.rule.needs_cleaning(&cells[*cell])).collect();
        for cell in dirty.iter().take(dirty.len() / 2) {
            cells[*cell] = DirtCell { expected_units: 0.3, tail: 0, slot: NO_SLOT, heavy_units: 0 };
        }
        let pose = Pose2::new(3.0, 0.5, 1.0);
        store.save(&plan, &Saved::of(pose, &cells, &prior));
        let second = begin();
        let reported = second.progress(Stamp::ZERO);
        assert!((reported.completion - 0.5).abs() < 0.1, "{}", reported.completion);
        assert!((second.pose().x_m - pose.x_m).abs() < 1e-4 && (second.pose().y_m - pose.y_m).abs() < 1e-4);
        assert!(!second.localiser.is_trusted(), "it rolled on without its computer");
    }
}
