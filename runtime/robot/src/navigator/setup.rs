//! A drive to a goal with where it reports: what a world hands to the robot's tasks.

use std::fmt;
use std::sync::{Arc, Mutex};

use floorguard_runtime::configuration::RobotConfiguration;

use super::drive::Navigator;
use super::plan::NavigationPlan;
use super::progress::SharedNavigationWatch;
use super::space_inbox::SpaceInbox;
use super::survey::{SharedSurvey, Survey};

/// A drive that is about to begin.
#[derive(Clone)]
pub struct NavigationSetup {
    /// Its input.
    pub plan: NavigationPlan,
    /// Where it reports its progress.
    pub watch: SharedNavigationWatch,
    /// The map that it makes, if it explores.
    pub survey: Option<SharedSurvey>,
    /// Where it gets what the lidar sees above the floor.
    pub space: SpaceInbox,
}

impl fmt::Debug for NavigationSetup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("NavigationSetup").field("goal", &self.plan.goal).finish_non_exhaustive()
    }
}

impl NavigationSetup {
    /// With nothing reported yet.
    #[must_use]
    pub fn new(plan: NavigationPlan) -> Self {
        let survey = plan.explores.then(|| Arc::new(Mutex::new(Survey::new(plan.start_pose()))));
        Self { plan, watch: SharedNavigationWatch::default(), survey, space: SpaceInbox::default() }
    }

    /// The drive of a robot.
    ///
    /// # Errors
    /// The map has no floor for this robot, or is too large.
    pub fn begin(&self, robot: &RobotConfiguration) -> anyhow::Result<Navigator> {
        Navigator::new(self, robot)
    }
}
