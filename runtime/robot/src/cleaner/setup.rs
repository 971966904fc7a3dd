//! A mission with where it tells of itself and where it is saved: what a world hands to the robot's tasks.

use std::fmt;

use floorguard_runtime::configuration::RobotConfiguration;

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
        Self { plan, watch: SharedWatch::default(), store, orders: MissionOrders::default() }
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
