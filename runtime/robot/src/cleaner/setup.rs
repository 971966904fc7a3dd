//! A mission with where it tells of itself and where it is saved: what a world hands to the robot's tasks.

use std::fmt;

use floorguard_runtime::configuration::RobotConfiguration;

use super::cleaning_orders::CleaningOrders;
use super::mission::{Cleaner, SharedWatch};
use super::orders::MissionOrders;
use super::plan::MissionPlan;
use super::queue::MissionQueue;
use super::store::Store;

/// A mission that is about to begin.
#[derive(Clone)]
pub struct MissionSetup {
    /// Its input.
    pub plan: MissionPlan,
    /// Where it tells its progress.
    pub watch: SharedWatch,
    /// Where it is saved.
    pub store: Store,
    /// What the operator orders of it.
    pub orders: MissionOrders,
    /// Somebody outside orders what is cleaned, beside a drive to goals; the mission does not begin by itself.
    pub ordered: Option<CleaningOrders>,
}

impl fmt::Debug for MissionSetup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MissionSetup").field("strategy", &self.plan.strategy).finish_non_exhaustive()
    }
}

impl MissionSetup {
    /// With nobody watching yet.
    #[must_use]
    pub fn new(plan: MissionPlan, store: Store) -> Self {
        Self { plan, watch: SharedWatch::default(), store, orders: MissionOrders::default(), ordered: None }
    }

    /// The same, with cleanings that somebody outside orders.
    #[must_use]
    pub fn ordered_by(self, ordered: Option<CleaningOrders>) -> Self {
        Self { ordered, ..self }
    }

    /// The mission of a robot, begun or gone on with.
    ///
    /// # Errors
    /// The plan has no floor for this robot.
    pub fn begin(&self, robot: &RobotConfiguration) -> anyhow::Result<Cleaner> {
        Cleaner::new(&self.plan, robot, (self.watch.clone(), self.store.clone()))
    }

    /// The same with the missions that an operator orders after it.
    ///
    /// # Errors
    /// As [`Self::begin`].
    pub fn begin_queue(&self, robot: &RobotConfiguration) -> anyhow::Result<MissionQueue> {
        MissionQueue::new(self, robot)
    }
}
