//! What a section that is missing costs: read at the start and by `check`, so that it is known before it is relied on.

use floorguard_runtime::configuration::BaseKind;

use super::read::HostedConfiguration;

/// A section that is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Absence {
    /// Its name.
    pub section: &'static str,
    /// What the robot cannot do without it.
    pub costs: &'static str,
}

/// Everything that is missing and matters, the costliest first.
#[must_use]
pub fn absences(configuration: &HostedConfiguration) -> Vec<Absence> {
    let HostedConfiguration { robot, carriers, .. } = configuration;
    let is_base = robot.base == BaseKind::Velocity;
    let all = [
        (
            !robot.has_lidar,
            "lidar",
            "nothing above the scanner's plane is seen: table tops, forks, arms; people are not recognised and their paths \
             not foreseen; at most 0.5 m/s",
        ),
        (
            is_base,
            "can",
            "the base alone measures the motion: encoders that disagree with the drive, and a wheel that slips, are not \
             noticed",
        ),
        (
            is_base || robot.can.inputs_node == 0,
            "inputs",
            "emergency stop, bumpers and cliff sensors are not read: they must cut the drives by themselves, no stop of \
             theirs is latched or recorded, and what is too low for the scanner is met without notice",
        ),
        (
            robot.imu.is_none(),
            "imu",
            "a turning rate that the wheels report and the robot does not make is not noticed; the heading drifts with the \
             wheels",
        ),
        (
            carriers.camera.is_none(),
            "camera",
            "objects on the floor that are lower than the scanner's plane, and edges of the floor, are not seen",
        ),
    ];
    let absent = all.into_iter().filter(|(is_absent, _, _)| *is_absent);
    absent.map(|(_, section, costs)| Absence { section, costs }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};

    #[test]
    fn missing_sections_and_costs_are_listed() {
        let names = |text: &str| {
            let read = parse("robot.toml", text).unwrap_or_else(|refused| panic!("{refused}"));
            absences(&read).iter().map(|absence| absence.section).collect::<Vec<_>>()
        };
        assert_eq!(names(EXAMPLE), ["camera"]);
        let (before, rest) = EXAMPLE.split_once("[lidar]").expect("a lidar");
        let scanner = format!("{before}[scanner]{}", rest.split_once("[scanner]").expect("a scanner").1);
        assert_eq!(names(&scanner), ["lidar", "camera"]);
        let (before, rest) = scanner.split_once("[imu]").expect("an inertial sensor");
        let bus = format!("{before}[can]{}", rest.split_once("[can]").expect("a bus").1);
        assert_eq!(names(&bus), ["lidar", "imu", "camera"]);
    }

    /// The scanner is the one protection against people that is certified for it: no robot without.
    #[test]
    fn robot_without_scanner_is_refused_with_reason() {
        let (before, rest) = EXAMPLE.split_once("[scanner]").expect("a scanner");
        let text = format!("{before}[imu]{}", rest.split_once("[imu]").expect("an inertial sensor").1);
        let refused = parse("robot.toml", &text).expect_err("refused").to_string();
        assert!(refused.contains("section `[scanner]` is missing"), "{refused}");
        assert!(refused.contains("feet and children"), "{refused}");
    }
}
