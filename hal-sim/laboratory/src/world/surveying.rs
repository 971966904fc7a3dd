//! The map of a robot that explored, beside the true building.

use floorguard_robot::navigator::{NavigationSetup, locked};
use floorguard_robot::site::Floor;

use super::observer::Observer;
use crate::plan::{Plan, survey};

/// Finishes the map and judges it. A robot that made none has explored nothing.
pub(super) fn judge_survey(plan: &Plan, setup: Option<&NavigationSetup>, observer: &mut Observer<'_>) {
    let Some(made) = setup.and_then(|setup| setup.survey.as_ref()) else { return };
    let radius_m = plan.robot.geometry.footprint.iter().map(|corner| corner.y_m.abs()).fold(0.0, f32::max);
    let truth = survey(&plan.scenario, &plan.scenario.scene.build());
    let floor = truth.and_then(|map| Floor::new(&plan.name, map, radius_m));
    match (locked(made).finish(), floor) {
        (Ok(surveyed), Ok(floor)) => {
            if let Some(judge) = &mut observer.navigation {
                judge.take_survey(&surveyed, &floor);
            }
            observer.seen.surveyed = Some(surveyed);
        }
        (Err(error), _) | (_, Err(error)) => say!("  no map: {error:#}"),
    }
}
