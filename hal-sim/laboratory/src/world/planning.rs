//! Which tasks plan in a simulated run.

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_robot::assembly::{HostedPerception, spawn_mission_ring, spawn_perception_ring};
use floorguard_robot::cleaner::MissionSetup;
use floorguard_robot::navigator::NavigationSetup;
use floorguard_robot::ordered::OrderedWork;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::shared::Shared;
use floorguard_runtime::tasks::{Mission, perceive};

use floorguard_host::executor::TaskSet;

use super::by_hand::drive_by_hand;
use crate::plan::Plan;

/// What plans in a run: a drive to a goal, cleaning, or both by turns as somebody outside orders; none: the route.
pub(super) fn begin_mission(
    robot: &RobotConfiguration,
    (cleaning, goal): (&Option<MissionSetup>, &Option<NavigationSetup>),
) -> anyhow::Result<Option<Box<dyn Mission>>> {
    Ok(match (goal, cleaning) {
        (Some(goal), Some(cleaning)) if OrderedWork::is_meant(goal, cleaning) => {
            Some(Box::new(OrderedWork::new((goal, cleaning), robot)?))
        }
        (Some(goal), _) => Some(Box::new(goal.begin(robot)?)),
        (None, Some(cleaning)) => Some(Box::new(cleaning.begin_queue(robot)?)),
        (None, None) => None,
    })
}

/// The perception ring with what the plan lets the robot do: a goal or cleaning, commands by hand, or its route.
pub(super) fn spawn_planning<'a>(
    tasks: &mut TaskSet<'a>,
    plan: &Plan,
    shared: &'a Shared<NoopRawMutex>,
    (perception, mission): (&'a mut HostedPerception, Option<&'a mut (dyn Mission + 'static)>),
) {
    match mission {
        Some(mission) => spawn_mission_ring(tasks, shared, (perception, mission)),
        None if plan.command.is_some() => tasks.spawn(perceive(shared, perception)),
        None if !plan.scenario.manoeuvre.is_empty() => {
            tasks.spawn(perceive(shared, perception));
            tasks.spawn(drive_by_hand(shared, plan.scenario.manoeuvre.clone()));
        }
        None => spawn_perception_ring(tasks, shared, &plan.robot, perception),
    }
}
