//! Which tasks plan in a simulated run.

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_robot::assembly::{
    HostedPerception, spawn_cleaning_ring, spawn_navigation_ring, spawn_perception_ring,
};
use floorguard_robot::cleaner::Cleaner;
use floorguard_robot::navigator::Navigator;
use floorguard_runtime::shared::Shared;
use floorguard_runtime::tasks::perceive;

use floorguard_host::executor::TaskSet;

use super::by_hand::drive_by_hand;
use crate::plan::Plan;

/// What plans in a run; none: the route.
pub(super) struct Planners {
    pub(super) mission: Option<Cleaner>,
    pub(super) navigator: Option<Navigator>,
}

/// The perception ring with what the plan lets the robot do: a goal, a mission, commands by hand, or its
/// route.
pub(super) fn spawn_planning<'a>(
    tasks: &mut TaskSet<'a>,
    plan: &Plan,
    shared: &'a Shared<NoopRawMutex>,
    (perception, planners): (&'a mut HostedPerception, &'a mut Planners),
) {
    if let Some(navigator) = &mut planners.navigator {
        return spawn_navigation_ring(tasks, shared, (perception, navigator));
    }
    match &mut planners.mission {
        Some(mission) => spawn_cleaning_ring(tasks, shared, (perception, mission)),
        None if plan.command.is_some() => tasks.spawn(perceive(shared, perception)),
        None if !plan.scenario.manoeuvre.is_empty() => {
            tasks.spawn(perceive(shared, perception));
            tasks.spawn(drive_by_hand(shared, plan.scenario.manoeuvre.clone()));
        }
        None => spawn_perception_ring(tasks, shared, &plan.robot, perception),
    }
}
