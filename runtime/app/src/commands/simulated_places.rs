//! Where a simulated robot drives instead of cleaning or the route.

use std::path::PathBuf;

use clap::{Args, ValueEnum as _};
use floorguard_laboratory::world::Plan;
use floorguard_types::geometry::Pose2;

use super::choices::DrivingPlanner;
use super::tour::read_places;
use super::values::goal;

/// A goal, or a tour.
#[derive(Clone, Debug, Default, Args)]
pub struct PlacesArguments {
    /// Drive to this place of the scenario's map instead of cleaning or the route, x and y in metres, heading in degrees:
    /// `--navigate 14.5,4.5,90`. The run ends at the goal, or when the robot gives up; --duration is then the longest that it may
    /// take. `[navigation]` of --robot says how.
    #[arg(long, value_name = "X,Y,YAW", allow_hyphen_values = true, value_parser = goal, group = "driven", conflicts_with_all = ["tape", "strategy", "until_clean", "real_io"])]
    pub navigate: Option<Pose2>,
    /// Look from each place of this file, one after another, as `tour` does. The run ends behind the last one.
    #[arg(long, value_name = "FILE.csv", group = "driven", conflicts_with_all = ["tape", "strategy", "until_clean", "real_io"])]
    pub tour: Option<PathBuf>,
    /// With --navigate: then come back to where it began, and stand there within a centimetre and a degree, by what the scanner saw there.
    #[arg(long, requires = "navigate")]
    pub dock: bool,
    /// With --navigate or --tour: drive with this planner, whatever [navigation] says.
    #[arg(long, value_enum, requires = "driven")]
    pub planner: Option<DrivingPlanner>,
}

impl PlacesArguments {
    /// Something is given.
    pub(super) const fn are_given(&self) -> bool {
        self.navigate.is_some() || self.tour.is_some()
    }

    /// The run to these places.
    ///
    /// # Errors
    /// The file holds no tour, or the scene makes no map.
    pub(super) fn plan(&self, mut plan: Plan) -> anyhow::Result<Plan> {
        if let Some(planner) = self.planner {
            plan.navigation_settings.uses_dwa = planner == DrivingPlanner::Dwa;
        }
        match (&self.tour, self.navigate) {
            (Some(file), _) => {
                let places = read_places(file)?.of_robot(&plan.robot.lidar.mounting);
                plan.touring(&places)
            }
            (None, Some(goal)) if self.dock => Ok(plan.docking(goal)?),
            (None, Some(goal)) => Ok(plan.navigating(goal)?),
            (None, None) => Ok(plan),
        }
    }

    /// The options that repeat it.
    pub(super) fn repeat(&self, option: &mut impl FnMut(&str, &str)) {
        if let Some(goal) = self.navigate {
            option("navigate", &format!("{},{},{}", goal.x_m, goal.y_m, goal.heading_rad.to_degrees()));
        }
        if self.dock {
            option("dock", "");
        }
        if let Some(file) = &self.tour {
            option("tour", &file.display().to_string());
        }
        if let Some(planner) = self.planner.and_then(|planner| planner.to_possible_value()) {
            option("planner", planner.get_name());
        }
    }
}
