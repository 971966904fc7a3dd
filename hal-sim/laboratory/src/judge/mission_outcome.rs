//! A mission judged by what really lay on the floor.

use std::collections::BTreeMap;
use std::sync::Arc;

use floorguard_mapping::GridGeometry;
use floorguard_sim::dirt::DirtyFloor;
use floorguard_types::geometry::Pose2;
use serde::Serialize;

use floorguard_robot::cleaner::MissionPlan;
use floorguard_robot::cleaner::{CellState, LaneCount, MissionPhase, MissionProgress};

/// What a mission came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MissionReport {
    /// How the robot decided where to clean.
    pub strategy: String,
    /// Nothing was left that the robot could do; how much is claimed clean is another matter.
    pub finished: bool,
    /// Lanes planned and driven, if it drove lanes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lanes: Option<LaneCount>,
    /// Share of the cells that were dirty and can be reached which is claimed clean.
    pub completion: f32,
    /// Share of all cells that the mission answers for which is claimed clean.
    pub claimed_fraction: f32,
    /// Cells of 0.1 x 0.1 m that were dirtier than tolerated or expected to be, and can be reached.
    pub dirty_cells: u32,
    /// Of those, claimed clean.
    pub claimed_cells: u32,
    /// Of those claimed, in truth dirtier than tolerated.
    pub falsely_claimed_cells: u32,
    /// Of all dirty cells, in truth clean at the end.
    pub truly_clean_cells: u32,
    /// Dirt that really lay within reach before and after, units.
    pub dirt_before_units: u32,
    /// See `dirt_before_units`.
    pub dirt_after_units: u32,
    /// Units that may stay in a clean cell, and the probability with which a claim may be wrong.
    pub tolerated_units: u8,
    /// See `tolerated_units`.
    pub delta: f64,
    /// Cells that are not claimed, by the reason.
    pub uncertain_cells: BTreeMap<String, u32>,
    /// Dirty cells that the robot cannot get to.
    pub unreachable_cells: usize,
    /// Distance driven, metres.
    pub distance_m: f32,
    /// When nothing was left to do, seconds since the start.
    pub finished_after_s: Option<f64>,
    /// Time lost to people and other obstacles, seconds.
    pub people_cost_s: f32,
    /// Where the time went, seconds by reason; the sum is the time of the mission.
    pub time_s: BTreeMap<String, f32>,
    /// Times that the robot took a detour.
    pub detours: u32,
    /// Distance of the believed from the true place, mean and largest, metres.
    pub localisation_error_m: Option<f64>,
    /// See `localisation_error_m`.
    pub localisation_error_max_m: Option<f64>,
}

/// A mission, its judgement, and the dirt of each cell.
#[derive(Clone, Debug, PartialEq)]
pub struct MissionOutcome {
    /// In numbers.
    pub report: MissionReport,
    /// The robot's final report.
    pub progress: Arc<MissionProgress>,
    /// Units that really lay in each cell at the start.
    pub before: Vec<u32>,
    /// Units that really lie there at the end.
    pub after: Vec<u32>,
}

/// Watches a mission beside the truth.
#[derive(Clone, Debug)]
pub struct MissionJudge {
    plan: MissionPlan,
    start: Option<DirtyFloor>,
    errors_m: Vec<f64>,
    finished_after_s: Option<f64>,
    newest: Option<Arc<MissionProgress>>,
}

impl MissionJudge {
    /// For a plan, before anything was cleaned.
    #[must_use]
    pub fn new(plan: &MissionPlan, dirt: Option<&DirtyFloor>) -> Self {
        Self {
            plan: plan.clone(),
            start: dirt.cloned(),
            errors_m: Vec::new(),
            finished_after_s: None,
            newest: None,
        }
    }

    /// The robot reported its progress while it was at `robot` in the world and believed to be at `odometry`.
    pub fn observe(
        &mut self,
        progress: &Arc<MissionProgress>,
        (robot, odometry, seconds): (Pose2, Pose2, f64),
    ) {
        let believed = progress.odometry_in_map.compose(odometry);
        self.errors_m.push(f64::from((believed.x_m - robot.x_m).hypot(believed.y_m - robot.y_m)));
        if progress.phase == MissionPhase::Done {
            self.finished_after_s.get_or_insert(seconds);
        }
        self.newest = Some(progress.clone());
    }

    /// The end.
    #[must_use]
    pub fn judge(&self, dirt: Option<&DirtyFloor>) -> Option<MissionOutcome> {
        let progress = self.newest.clone()?;
        let raster: GridGeometry = progress.geometry;
        let units = |floor: Option<&DirtyFloor>| {
            floor.map_or_else(|| vec![0; raster.cell_count()], |floor| floor.units_on(&raster))
        };
        let (before, after) = (units(self.start.as_ref()), units(dirt));
        let report = self.report(&progress, (&before, &after));
        Some(MissionOutcome { report, progress, before, after })
    }

    fn report(&self, progress: &MissionProgress, (before, after): (&[u32], &[u32])) -> MissionReport {
        let tolerated = u32::from(self.plan.tolerated_units);
        let rule = floorguard_cleaning::CleanRule::per_cell(self.plan.tolerated_units, self.plan.delta);
        let prior = self.plan.prior(&progress.expected_before);
        let mut report = MissionReport {
            strategy: self.plan.strategy.name().to_owned(),
            finished: progress.phase == MissionPhase::Done,
            lanes: progress.lanes,
            completion: progress.completion,
            claimed_fraction: progress.claimed_fraction,
            tolerated_units: self.plan.tolerated_units,
            delta: self.plan.delta,
            unreachable_cells: progress.unreachable_cells,
            distance_m: progress.distance_m,
            finished_after_s: self.finished_after_s,
            people_cost_s: progress.waited_s,
            time_s: progress.times.iter().map(|(spent, time_s)| (spent.words().to_owned(), time_s)).collect(),
            detours: progress.detours,
            ..MissionReport::default()
        };
        for (cell, state) in
            progress.cells.iter().enumerate().filter(|(_, state)| **state != CellState::OffLimits)
        {
            report.dirt_before_units += before[cell];
            report.dirt_after_units += after[cell];
            let (claimed, clean) = (*state == CellState::Clean, after[cell] <= tolerated);
            if before[cell] > tolerated || rule.needs_cleaning(&prior[cell]) {
                report.dirty_cells += 1;
                report.claimed_cells += u32::from(claimed);
                report.falsely_claimed_cells += u32::from(claimed && !clean);
                report.truly_clean_cells += u32::from(clean);
            }
        }
        for cell in &progress.uncertain {
            *report.uncertain_cells.entry(cell.doubt.words().to_owned()).or_default() += 1;
        }
        if !self.errors_m.is_empty() {
            report.localisation_error_m =
                Some(self.errors_m.iter().sum::<f64>() / self.errors_m.len() as f64);
            report.localisation_error_max_m = Some(self.errors_m.iter().copied().fold(0.0, f64::max));
        }
        report
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_configuration::{EXAMPLE, parse};
    use floorguard_robot::cleaner::{MissionSetup, MissionStrategy, Store, TimeUse};
    use floorguard_sim::scenario::Scenario;
    use floorguard_types::time::Stamp;

    use crate::plan::plan_of_scenario;

    /// Every second has a reason, and what people cost is reported from the same seconds.
    #[test]
    fn the_report_accounts_for_every_second() {
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let scenario = Scenario::named("supermarket").unwrap();
        let plan = plan_of_scenario(&scenario, MissionStrategy::Guarantee, 1).unwrap();
        let cleaner = MissionSetup::new(plan.clone(), Store::Memory(Arc::default())).begin(&robot).unwrap();
        let mut progress = cleaner.progress(Stamp::ZERO);
        (progress.waited_s, progress.detours) = (3.0, 2);
        for (spent, time_s) in [(TimeUse::Paused, 1.0), (TimeUse::HeldPersonApproaches, 3.0)] {
            progress.times.add(spent, Default::default(), time_s);
        }
        let mut judge = MissionJudge::new(&plan, None);
        judge.observe(&Arc::new(progress), (Pose2::default(), Pose2::default(), 4.0));
        let report = judge.judge(None).unwrap().report;
        let reported: Vec<(String, f32)> = report.time_s.into_iter().collect();
        let words = |spent: TimeUse, time_s: f32| (spent.words().to_owned(), time_s);
        assert_eq!(reported, [words(TimeUse::HeldPersonApproaches, 3.0), words(TimeUse::Paused, 1.0)]);
        assert_eq!((report.people_cost_s, report.detours), (3.0, 2));
    }
}
