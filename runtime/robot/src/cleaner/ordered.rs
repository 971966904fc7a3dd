//! Cleanings that begin where the robot is already on its way, or go on there: on a part of the floor, with a promise of their own.

use std::sync::Arc;

use anyhow::ensure;
use floorguard_cleaning::Verdict;
use floorguard_mapping::{DirtCell, NO_SLOT};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::shared::StampedPose;
use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

use super::areas::{Area, AreaKind};
use super::cleaning_orders::CleaningOrder;
use super::mission::{Cleaner, SharedWatch};
use super::plan::{MissionPlan, MissionStrategy};
use super::progress::{LaneCount, MissionPhase, MissionProgress};
use super::setup::MissionSetup;
use super::store::Store;
use crate::site::RecentPoses;

/// The area of a cleaning, among those that an operator has drawn.
const ORDERED_AREA: &str = "ordered";

/// Where a robot is, as what drove it so far knows.
#[derive(Clone, Debug)]
pub struct Whereabouts {
    /// Believed, map frame.
    pub pose_in_map: Pose2,
    /// Doubt of that, metres.
    pub doubt_m: f32,
    /// It explains what the scanner sees.
    pub is_trusted: bool,
    /// By its wheels.
    pub odometry: StampedPose,
    /// By its wheels, the last second.
    pub poses: RecentPoses,
}

/// How far a cleaning is. Cells are 0.1 m wide.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CleaningCounts {
    /// Cells that were to be cleaned at the start and can be reached.
    pub dirty_cells: u32,
    /// Of those, claimed clean.
    pub clean_cells: u32,
    /// Cells that the cleaning answers for and does not claim.
    pub unclaimed_cells: u32,
    /// Units that may stay in a clean cell, τ.
    pub tolerated_units: u8,
    /// Probability with which a claim may be wrong, δ.
    pub delta: f64,
    /// Lanes, if it drives lanes.
    pub lanes: Option<LaneCount>,
    /// Distance driven, metres.
    pub distance_m: f32,
}

impl CleaningCounts {
    /// Everything that was asked for was done.
    #[must_use]
    pub fn are_complete(&self) -> bool {
        self.lanes.map_or(self.unclaimed_cells == 0, |lanes| lanes.driven >= lanes.planned)
    }

    /// In one line, for people and for a fleet's master.
    #[must_use]
    pub fn words(&self) -> String {
        let Self { dirty_cells, clean_cells, tolerated_units, distance_m, .. } = *self;
        let lanes = self.lanes.map(|lanes| format!("{} of {} lanes driven, ", lanes.driven, lanes.planned));
        let cells = if dirty_cells == 0 {
            "no cell there is expected to be dirty".to_owned()
        } else {
            let sure = 100.0 * (1.0 - self.delta);
            format!(
                "{clean_cells} of {dirty_cells} dirty cells are clean: {tolerated_units} units at most are left in each with {sure:.1} %"
            )
        };
        format!("{}{cells}; {distance_m:.1} m driven", lanes.unwrap_or_default())
    }
}

impl MissionSetup {
    /// The cleaning of an order, from where the robot is. Areas that an operator has drawn hold for it, too.
    ///
    /// # Errors
    /// An area that makes no polygon, or nothing there that the robot could clean from where it stands.
    pub fn begin_ordered(
        &self,
        robot: &RobotConfiguration,
        (order, drawn): (&CleaningOrder, &[Area]),
        whereabouts: &Whereabouts,
    ) -> anyhow::Result<Cleaner> {
        let mut plan = self.plan.clone();
        plan.areas = drawn.iter().filter(|area| area.kind != AreaKind::Clean).cloned().collect();
        if !order.corners_m.is_empty() {
            let corners_m = order.corners_m.clone();
            plan.areas.push(Area { name: ORDERED_AREA.to_owned(), kind: AreaKind::Clean, corners_m });
        }
        super::areas::check_areas(&plan.areas)?;
        plan.tolerated_units = order.tolerated_units.unwrap_or(plan.tolerated_units);
        plan.delta = order.delta.unwrap_or(plan.delta);
        let mut cleaner = prepared((&plan, robot), &self.watch, whereabouts)?;
        if order.goes_on {
            cleaner.go_on_as_saved(&self.store, &plan);
        } else {
            self.store.forget();
        }
        cleaner.store = self.store.clone();
        // A save is found again wherever the robot stands then.
        cleaner.saved_as = Some(plan);
        Ok(cleaner)
    }
}

/// A mission on a plan that begins where the robot is now. Nothing is saved of it yet.
pub(super) fn prepared(
    (plan, robot): (&MissionPlan, &RobotConfiguration),
    watch: &SharedWatch,
    whereabouts: &Whereabouts,
) -> anyhow::Result<Cleaner> {
    let pose = whereabouts.pose_in_map;
    let mut plan = plan.clone();
    plan.start = [pose.x_m, pose.y_m, pose.heading_rad];
    let mut next = Cleaner::new(&plan, robot, (watch.clone(), Store::None))?;
    ensure!(
        next.ground.floor.reachable.contains(&true),
        "the robot cannot clean anything there from where it stands"
    );
    next.odometry = whereabouts.odometry;
    next.poses = whereabouts.poses.clone();
    let odometry = whereabouts.odometry.pose_in_odometry;
    next.localiser.go_on_at((pose, whereabouts.doubt_m), odometry, whereabouts.is_trusted);
    Ok(next)
}

impl Cleaner {
    /// Where the robot is.
    pub(super) fn whereabouts(&self) -> Whereabouts {
        Whereabouts {
            pose_in_map: self.pose(),
            doubt_m: self.localiser.doubt_m(),
            is_trusted: self.localiser.is_trusted(),
            odometry: self.odometry,
            poses: self.poses.clone(),
        }
    }

    /// What was cleaned before the computer lost its power stays cleaned; where the robot is then is another matter.
    fn go_on_as_saved(&mut self, store: &Store, plan: &MissionPlan) {
        let raster = *self.ground.raster();
        let Some(saved) = store.load(plan, raster.cell_count()) else { return };
        let mut cells: Vec<DirtCell> = self.plan.prior(&self.ground.expected);
        saved.restore(&raster, &mut cells);
        for (cell, known) in self.localiser.map.values_mut().iter_mut().zip(cells) {
            *cell = DirtCell { slot: NO_SLOT, ..known };
        }
    }

    /// Its phase.
    #[must_use]
    pub const fn phase(&self) -> MissionPhase {
        self.phase
    }

    /// Its progress, made known at once.
    pub fn publish(&self, now: Stamp) -> Arc<MissionProgress> {
        let progress = Arc::new(self.progress(now));
        self.watch.publish(Arc::clone(&progress));
        progress
    }

    /// How far it is.
    #[must_use]
    pub fn counts(&self) -> CleaningCounts {
        let is_clean = |dirt: &DirtCell| self.rule.verdict(dirt) == Verdict::Clean;
        let prior = self.plan.prior(&self.ground.expected);
        let cells = self.localiser.map.values().iter().zip(&prior).zip(&self.ground.floor.reachable);
        let mut counts = CleaningCounts {
            tolerated_units: self.plan.tolerated_units,
            delta: self.plan.delta,
            lanes: (self.plan.strategy == MissionStrategy::Systematic).then(|| self.lanes.count()),
            distance_m: self.distance_m,
            ..CleaningCounts::default()
        };
        for ((now, before), _) in cells.filter(|(_, is_reachable)| **is_reachable) {
            let was_dirty = self.rule.needs_cleaning(before);
            counts.dirty_cells += u32::from(was_dirty);
            counts.clean_cells += u32::from(was_dirty && is_clean(now));
            counts.unclaimed_cells += u32::from(!is_clean(now));
        }
        counts
    }
}

#[cfg(test)]
impl Cleaner {
    /// Half of the dirty cells are clean by now.
    pub(crate) fn clean_half(&mut self) {
        let dirty = |dirt: &&mut DirtCell| self.rule.needs_cleaning(dirt);
        for cell in self.localiser.map.values_mut().iter_mut().filter(dirty).step_by(2) {
            *cell = DirtCell { expected_units: 0.3, tail: 0, slot: NO_SLOT, heavy_units: 0 };
        }
    }
}
