//! How a robot drives to a goal: on which map, with which planner, how fast and how exactly.

use std::path::PathBuf;

use floorguard_runtime::configuration::Limits;

use super::reader::Reader;

/// Which local planner drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NavigationPlanner {
    /// Sampling-based predictive control: expects people, and plans what the guard would permit.
    #[default]
    Ours,
    /// The dynamic window as published, with the limits of this robot.
    Dwa,
}

impl NavigationPlanner {
    /// The name in `robot.toml`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ours => "ours",
            Self::Dwa => "dwa",
        }
    }
}

/// Navigation to a goal.
#[derive(Clone, Debug, PartialEq)]
pub struct NavigationConfiguration {
    /// A ROS `map_server` map, relative to the folder of the file that names it; a simulated robot has that of its scenario.
    pub map: Option<PathBuf>,
    /// Where the robot is switched on: x, y in metres and heading in radians, map frame.
    pub start: [f32; 3],
    /// Which local planner drives.
    pub planner: NavigationPlanner,
    /// Greatest speed requested, m/s.
    pub speed_mps: f32,
    /// Greatest turning rate requested, rad/s.
    pub turn_radps: f32,
    /// The goal counts as reached within, metres.
    pub within_m: f32,
    /// And within, radians.
    pub within_rad: f32,
    /// Obstructed for so long without coming nearer to the goal, the robot calls for help, seconds.
    pub help_after_s: f32,
}

/// What holds without a word about it: the route's own pace.
const SPEED_MPS: f32 = 0.8;
const TURN_RADPS: f32 = 0.6;

impl NavigationConfiguration {
    /// Without the section, for a robot of these limits.
    #[must_use]
    pub fn of_limits(limits: &Limits) -> Self {
        Self {
            map: None,
            start: [0.0; 3],
            planner: NavigationPlanner::Ours,
            speed_mps: SPEED_MPS.min(limits.speed_mps),
            turn_radps: TURN_RADPS.min(limits.turn_radps),
            within_m: 0.25,
            within_rad: 10.0_f32.to_radians(),
            help_after_s: 120.0,
        }
    }
}

pub(super) fn read_navigation(section: Reader<'_>, limits: &Limits) -> NavigationConfiguration {
    let default = NavigationConfiguration::of_limits(limits);
    let is_known = section.good_so_far();
    let greatest = |limit: f32, widest: f32| if is_known { limit } else { widest };
    let map = section.text_or_absent("map", "maps/hall.yaml", "that of the scenario; refused by `goto`");
    let map = match map {
        Some(("", span)) => {
            section.refuse(
                &span,
                "[navigation]: `map` is empty",
                "write the name of a map, such as \"hall.yaml\"",
            );
            None
        }
        other => other.map(|(text, _)| PathBuf::from(text)),
    };
    let place = |key: &'static str| section.number_or(key, -10_000.0..=10_000.0, 0.0);
    let start = [place("start_x_m"), place("start_y_m")];
    let yaw_deg = section.number_or("start_yaw_deg", -360.0..=360.0, 0.0);
    let planners = [("ours", NavigationPlanner::Ours), ("dwa", NavigationPlanner::Dwa)];
    let planner = section.choice_or("planner", &planners, default.planner);
    let speed_mps = section.number_or("speed_mps", 0.05..=greatest(limits.speed_mps, 2.0), default.speed_mps);
    let turn_radps =
        section.number_or("turn_radps", 0.05..=greatest(limits.turn_radps, 2.0), default.turn_radps);
    let within_m = section.number_or("within_m", 0.05..=2.0, default.within_m);
    let within_deg = section.number_or("within_deg", 2.0..=180.0, default.within_rad.to_degrees().round());
    let help_after_s = section.number_or("help_after_s", 10.0..=3_600.0, default.help_after_s);
    section.finish();
    NavigationConfiguration {
        map,
        start: [start[0], start[1], yaw_deg.to_radians()],
        planner,
        speed_mps,
        turn_radps,
        within_m,
        within_rad: within_deg.to_radians(),
        help_after_s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};

    fn read(section: &str) -> Result<Option<NavigationConfiguration>, String> {
        let parsed = parse("robot.toml", &format!("{EXAMPLE}\n{section}"));
        parsed.map(|configuration| configuration.navigation).map_err(|refused| refused.to_string())
    }

    #[test]
    fn navigation_is_configured_only_when_asked() {
        assert_eq!(read(""), Ok(None));
        let limits = parse("robot.toml", EXAMPLE).unwrap().robot.limits;
        let default = read("[navigation]").unwrap().unwrap();
        assert_eq!(default, NavigationConfiguration::of_limits(&limits));
        let own = "[navigation]\nmap = \"hall.yaml\"\nplanner = \"dwa\"\nspeed_mps = 0.5\nstart_yaw_deg = 90.0\nwithin_deg = 5.0";
        let own = read(own).unwrap().unwrap();
        assert_eq!(
            (own.planner, own.speed_mps, own.map),
            (NavigationPlanner::Dwa, 0.5, Some("hall.yaml".into()))
        );
        assert!((own.start[2] - std::f32::consts::FRAC_PI_2).abs() < 1.0e-6);
        assert!((own.within_rad.to_degrees() - 5.0).abs() < 1.0e-4);
        for (wrong, reported) in [
            ("planner = \"teb\"", "not known"),
            ("speed_mps = 1.5", "allowed is 0.05 to 1"),
            ("turn_radps = 0.9", "allowed is 0.05 to 0.8"),
            ("within_m = 0.0", "within_m"),
            ("within_rad = 0.1", "wrong unit"),
            ("help_after_s = 1", "help_after_s"),
            ("map = \"\"", "is empty"),
            ("maps = \"x\"", "did you mean `map`"),
        ] {
            let refused = read(&format!("[navigation]\n{wrong}")).unwrap_err();
            assert!(refused.contains(reported), "{wrong}: {refused}");
        }
    }
}
