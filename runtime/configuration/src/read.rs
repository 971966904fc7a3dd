//! The meaning of every key of `robot.toml`.
//!
//! Nothing starts half-configured: all mistakes are collected and any one refuses the whole file.

use std::path::Path;

use floorguard_guard::{Thresholds, UnseenLimits};
use floorguard_runtime::configuration::{Deadlines, Limits, RobotConfiguration};
use floorguard_runtime::mission::{ROUTE_WAYPOINTS_MAX, Route, RouteLimits};
use floorguard_types::geometry::Point2;
use toml::de::DeTable;

use super::actuated_lidar::ActuatedLidarConfiguration;
use super::address::{BaseAddress, CanAddress, DatagramAddress, ImuAddress, ScannerAddress, SerialAddress};
use super::base::{BaseSection, Drives};
use super::camera::{CameraConfiguration, CameraSource};
use super::command::{CommandConfiguration, read_command};
use super::coverage::{
    Accepted, AcceptedGap, Coverage, DirectionLimit, GapSpeed, Refusal, read_accepted, unseen_limits,
};
use super::fields::read_fields;
use super::fleet::{FleetConfiguration, read_fleet};
use super::learning::{LearningConfiguration, read_learning};
use super::limits::{read_deadlines, read_limits};
use super::mission::{MissionConfiguration, read_mission};
use super::navigation::{NavigationConfiguration, read_navigation};
use super::panel::{PanelConfiguration, read_panel};
use super::problem::{Problem, Refused};
use super::reader::{Problems, Reader};
use super::ros2::{RosConfiguration, read_ros2};
use super::scanner::ReadScanner;
use super::sensors::{Sensors, fitted};

/// The addresses of the carriers.
#[derive(Clone, Debug, PartialEq)]
pub struct Carriers {
    /// Lidar; a robot can do without.
    pub lidar: Option<DatagramAddress>,
    /// Safety scanner.
    pub scanner: ScannerAddress,
    /// Second safety scanner; a robot can do without.
    pub rear_scanner: Option<SerialAddress>,
    /// Inertial measurement unit.
    pub imu: Option<ImuAddress>,
    /// CAN bus, of a robot whose drives are on one.
    pub can: Option<CanAddress>,
    /// The base, of a robot with one that takes velocities.
    pub base: Option<BaseAddress>,
    /// Floor camera.
    pub camera: Option<CameraConfiguration>,
    /// Lidar on its side that a motor turns.
    pub actuated_lidar: Option<ActuatedLidarConfiguration>,
}

/// A complete, checked configuration.
#[derive(Clone, Debug)]
pub struct HostedConfiguration {
    /// What the robot is.
    pub robot: RobotConfiguration,
    /// Where its bytes come from.
    pub carriers: Carriers,
    /// What it cleans; without a mission it drives its route.
    pub mission: Option<MissionConfiguration>,
    /// How it drives to a goal.
    pub navigation: Option<NavigationConfiguration>,
    /// The fleet that it belongs to, if it does.
    pub fleet: Option<FleetConfiguration>,
    /// How it is in ROS 2, if it is.
    pub ros2: Option<RosConfiguration>,
    /// How it learns what people look like; without it, it does not.
    pub learning: Option<LearningConfiguration>,
    /// What no sensor sees, and the file accepts.
    pub accepted_gaps: Vec<AcceptedGap>,
    /// Those of them that are accepted up to a speed.
    pub gap_speeds: Vec<GapSpeed>,
    /// So fast it may be behind a scanner that is no safety device, if it has one, m/s.
    pub uncertified_mps: Option<f32>,
    /// Who drives it from outside; without it, it drives itself.
    pub command: Option<CommandConfiguration>,
    /// What the operator's panel shows besides the robot.
    pub panel: PanelConfiguration,
}

impl HostedConfiguration {
    /// What the sensors see of the volume that the body goes into, and why the robot is refused for what they do not see: empty
    /// where the file accepts all of it by name.
    #[must_use]
    pub fn coverage(&self) -> (Coverage, Vec<Refusal>) {
        let coverage = self.sight();
        let refusals = coverage.refusals(&self.accepted_gaps);
        (coverage, refusals)
    }

    fn sight(&self) -> Coverage {
        // Recorded pictures show nothing of what is there.
        let is_there = |camera: &&CameraConfiguration| matches!(camera.source, CameraSource::Devices { .. });
        Coverage::of(&self.robot, self.carriers.camera.as_ref().filter(is_there))
    }

    /// Directions that are slower for what no sensor sees, each with the gap that costs it most (FG-REQ-063).
    #[must_use]
    pub fn direction_limits(&self, coverage: &Coverage) -> Vec<DirectionLimit> {
        coverage.limits(&self.gap_speeds)
    }

    /// The guard gets the limits by direction.
    fn limit_unseen(&mut self) {
        let slower = !self.gap_speeds.is_empty();
        let limits = if slower { self.direction_limits(&self.sight()) } else { Vec::new() };
        let unseen = unseen_limits(&self.robot, &limits);
        self.robot.unseen = self.uncertified_mps.map_or(unseen, |mps| limited(unseen, mps));
    }
}

/// No direction is faster than this, m/s.
fn limited(limits: UnseenLimits, mps: f32) -> UnseenLimits {
    UnseenLimits {
        forward_mps: limits.forward_mps.min(mps),
        turning_mps: limits.turning_mps.min(mps),
        spinning_mps: limits.spinning_mps.min(mps),
        reverse_mps: limits.reverse_mps.min(mps),
        unknown_rear_mps: limits.unknown_rear_mps.min(mps),
        ..limits
    }
}

/// Reads and checks a file.
///
/// # Errors
/// The file cannot be read, or [`Refused`].
pub fn load(path: &Path) -> anyhow::Result<HostedConfiguration> {
    let text = std::fs::read_to_string(path).map_err(|error| {
        anyhow::anyhow!("{}: cannot be read ({error}); give the path of a robot.toml", path.display())
    })?;
    Ok(parse(&path.display().to_string(), &text)?)
}

/// Checks a text; `file` is the name for messages.
///
/// # Errors
/// Every mistake with its line.
pub fn parse(file: &str, text: &str) -> Result<HostedConfiguration, Refused> {
    match parse_recorded(file, text)? {
        RecordedConfiguration { configuration, findings: None } => Ok(configuration),
        RecordedConfiguration { findings: Some(refused), .. } => Err(refused),
    }
}

/// The configuration of a robot that drove once.
#[derive(Clone, Debug)]
pub struct RecordedConfiguration {
    /// What it was.
    pub configuration: HostedConfiguration,
    /// Why no robot drives with it today, if so.
    pub findings: Option<Refused>,
}

/// The same for a text that a recording holds: a robot that is refused today for what was allowed then can still be replayed.
///
/// # Errors
/// What the text means is not clear: every mistake with its line.
pub fn parse_recorded(file: &str, text: &str) -> Result<RecordedConfiguration, Refused> {
    let document = DeTable::parse(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start);
        let what = format!("not TOML: {}", error.message().lines().next().unwrap_or_default());
        let remedy = "correct the syntax".to_owned();
        Refused::new(file, text, vec![Problem { offset, what, remedy, is_understood: false }])
    })?;
    let problems = Problems::default();
    let top = Reader::new(document.get_ref(), "", 0..0, &problems);
    let configuration = read_top(top);
    let problems = problems.into_inner();
    let is_understood = problems.iter().all(|problem| problem.is_understood);
    let findings = (!problems.is_empty()).then(|| Refused::new(file, text, problems));
    match configuration {
        Some(mut configuration) if is_understood => {
            configuration.limit_unseen();
            Ok(RecordedConfiguration { configuration, findings })
        }
        _ => Err(findings.unwrap_or_else(|| Refused::new(file, text, Vec::new()))),
    }
}

fn read_top(top: Reader<'_>) -> Option<HostedConfiguration> {
    let base = BaseSection::read(&top);
    let (geometry, train) = base.read_geometry(top.section("robot")).unzip();
    let deadlines = top.optional_section("deadlines").map_or(Deadlines::DEFAULT, read_deadlines);
    let sensors = Sensors::read(&top);
    let limits = sensors.slowed(read_limits(top.section("limits")));
    let (thresholds, accepted) = optional(&top, "guard", read_thresholds);
    let drives = base.read_drives(&top);
    let fields = read_fields(&top, &geometry, &limits);
    let (route, route_limits) = optional(&top, "route", |section| read_route(section, &limits));
    let mission = top.optional_section("mission").and_then(read_mission);
    let (fleet, ros2, command) = read_outside(&top);
    let navigation = top.optional_section("navigation").map(|section| read_navigation(section, &limits));
    let learning = top.optional_section("learning").and_then(read_learning);
    let panel = optional(&top, "panel", |section| read_panel(section, drives.as_ref().and_then(Drives::bus)));
    finish(top, &sensors, (drives.as_ref(), command.as_ref()));
    let ((lidar, lidar_address), (imu, imu_address)) = (fitted(sensors.lidar)?, fitted(sensors.imu)?);
    let ReadScanner { scanner, address: scanner_address, accepted_mps } = sensors.scanner?;
    let (rear_scanner, rear_scanner_address) = fitted(sensors.rear_scanner)?;
    let (can, can_address, base_address) = drives?.parted();
    Some(HostedConfiguration {
        robot: RobotConfiguration {
            geometry: geometry?,
            limits,
            deadlines,
            base: base.by,
            train: train.unwrap_or_default(),
            has_lidar: lidar.is_some(),
            lidar: lidar.unwrap_or_default(),
            scanner,
            rear_scanner,
            imu,
            can,
            motors: base.motors(&can),
            fields,
            route,
            route_limits,
            thresholds,
            unseen: UnseenLimits::NONE,
        },
        carriers: Carriers {
            lidar: lidar_address,
            scanner: scanner_address,
            rear_scanner: rear_scanner_address,
            imu: imu_address,
            can: can_address,
            base: base_address,
            camera: sensors.camera,
            actuated_lidar: sensors.actuated_lidar.flatten(),
        },
        mission,
        navigation,
        fleet,
        ros2,
        learning,
        accepted_gaps: accepted.gaps,
        gap_speeds: accepted.speeds,
        uncertified_mps: accepted_mps,
        command,
        panel,
    })
}

/// Who else knows the robot or drives it.
type Outside = (Option<FleetConfiguration>, Option<RosConfiguration>, Option<CommandConfiguration>);

fn read_outside(top: &Reader<'_>) -> Outside {
    let fleet = top.optional_section("fleet").and_then(read_fleet);
    let ros2 = top.optional_section("ros2").and_then(|section| read_ros2(top, section));
    (fleet, ros2, top.optional_section("command").and_then(|section| read_command(top, section)))
}

/// Refuses lines that two devices share, and every key that was not read.
fn finish(top: Reader<'_>, sensors: &Sensors, by: (Option<&Drives>, Option<&CommandConfiguration>)) {
    if let (Some(drives), command) = by {
        sensors.check(&top, (drives.can(), drives.base(), command.map(|command| &command.address)));
    }
    top.finish();
}

/// What a section says, or what stands for it where it is missing.
fn optional<T: Default>(top: &Reader<'_>, name: &'static str, read: impl FnOnce(Reader<'_>) -> T) -> T {
    top.optional_section(name).map_or_else(T::default, read)
}

/// The guard's thresholds that a site may want to change, and the gaps of the sensors that it accepts; the other thresholds follow from
/// the standards.
fn read_thresholds(section: Reader<'_>) -> (Thresholds, Accepted) {
    let defaults = Thresholds::default();
    let thresholds = Thresholds {
        warning_speed_mps: section.number_or("warning_speed_mps", 0.05..=0.5, defaults.warning_speed_mps),
        person_speed_mps: section.number_or("person_speed_mps", 0.05..=0.5, defaults.person_speed_mps),
        person_near_m: section.number_or("person_near_m", 0.5..=5.0, defaults.person_near_m),
        ..defaults
    };
    let accepted = read_accepted(&section);
    section.finish();
    (thresholds, accepted)
}

fn read_route(section: Reader<'_>, limits: &Limits) -> (Route, RouteLimits) {
    let mut route = Route { repeat: section.flag_or("repeat", false), ..Route::default() };
    if let Some((points, span)) = section.points("waypoints_m") {
        for [x_m, y_m] in points {
            if route.waypoints.push(Point2::new(x_m, y_m)).is_err() {
                section.refuse(
                    &span,
                    format!("more than {ROUTE_WAYPOINTS_MAX} waypoints"),
                    "shorten the route",
                );
                break;
            }
        }
    }
    let defaults = RouteLimits::default();
    let greatest_mps = if section.good_so_far() { limits.speed_mps } else { f32::MAX };
    let speed_mps = section.number_or("speed_mps", 0.05..=greatest_mps, defaults.speed_mps.min(greatest_mps));
    section.finish();
    (route, RouteLimits { speed_mps, turn_radps: defaults.turn_radps.min(limits.turn_radps), ..defaults })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EXAMPLE;
    use crate::camera::EXAMPLE_SECTION;
    use floorguard_types::sensing::ImageSize;

    /// The guard judges every ring of a lidar of 32, and people are looked for in sixteen of them.
    #[test]
    fn lidars_of_32_rings_are_taken() {
        for (model, lowest_deg, highest_deg) in [("vlp32c", -25.0, 15.0), ("hdl32e", -30.67, 10.67)] {
            let text = EXAMPLE.replace("model = \"vlp16\"", &format!("model = \"{model}\""));
            let robot = parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).robot;
            let elevations_deg = robot.lidar_elevations_deg();
            assert_eq!(
                (elevations_deg.len(), elevations_deg[0], elevations_deg[31]),
                (32, lowest_deg, highest_deg)
            );
            let sines = robot.ring_angles().rings.map(|(sine, ..)| sine);
            assert!(sines.is_sorted() && sines[0] < -0.25 && sines[15] > 0.18, "{model}: {sines:?}");
        }
        for model in ["auto", "puck-hi-res"] {
            let text = EXAMPLE.replace("model = \"vlp16\"", &format!("model = \"{model}\""));
            let robot = parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).robot;
            assert_eq!(robot.lidar_elevations_deg().len(), 16);
        }
    }

    #[test]
    fn upward_camera_is_refused() {
        let text = format!("{EXAMPLE}\n{EXAMPLE_SECTION}");
        let camera = parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).carriers.camera;
        let camera = camera.expect("there is a camera");
        assert_eq!(
            (camera.size, camera.mounting.position.z_m),
            (ImageSize { width: 640, height: 480 }, 0.72)
        );
        let devices =
            CameraSource::Devices { depth: "/dev/video2".into(), colour: Some("/dev/video4".into()) };
        assert_eq!(camera.source, devices);
        for (from, to) in [
            ("45.0", "-45.0"),
            ("v4l2:/dev/video4", "udp:1"),
            ("width = 640", "width = 6400"),
            ("width = 640", "rate_hz = 5.0\nwidth = 640"),
            ("v4l2:/dev/video2", "folder:frames"),
            ("v4l2:/dev/video2", "folder:"),
        ] {
            let refused = parse("robot.toml", &text.replace(from, to)).expect_err("refused").to_string();
            assert!(refused.contains("[camera]") || refused.contains("width"), "{refused}");
        }
        let folder = text.replace("v4l2:/dev/video2", "folder:frames");
        for (colour, rate_hz) in [("", None), ("rate_hz = 5.0", Some(5.0))] {
            let folder = folder.replace("colour_source = \"v4l2:/dev/video4\"", colour);
            let camera =
                parse("robot.toml", &folder).unwrap_or_else(|refused| panic!("{refused}")).carriers.camera;
            let source = CameraSource::Folder { path: "frames".into(), rate_hz };
            assert_eq!(camera.map(|camera| camera.source), Some(source));
        }
    }

    /// A robot of a time when one channel, or none that notices a cut wire, was enough: it drives no more, its recordings are read.
    #[test]
    fn refused_channels_are_read_from_recordings() {
        let pair = "emergency_stop_bits = [32, 33]";
        assert!(EXAMPLE.contains(pair));
        let all_inverted = format!("inverted_bits = [32, 33]\n{pair}");
        for (written, words) in
            [("emergency_stop_bits = [32]", "one channel"), (all_inverted.as_str(), "a cut wire")]
        {
            let text = EXAMPLE.replace(pair, written);
            let refused = parse("robot.toml", &text).expect_err("no robot drives with it").to_string();
            assert!(refused.contains(words), "{refused}");
            let recorded = parse_recorded("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}"));
            assert_eq!(recorded.findings.map(|findings| findings.to_string()), Some(refused));
            let robot = recorded.configuration.robot;
            assert_eq!((robot.fields.len(), robot.can.inputs.emergency_stop.bits[0]), (4, 32));
        }
        let unclear = EXAMPLE.replace(pair, "emergency_stop_bits = [3200]");
        assert!(parse_recorded("robot.toml", &unclear).is_err(), "what it was is not clear");
        let example = parse_recorded("robot.toml", EXAMPLE).unwrap_or_else(|refused| panic!("{refused}"));
        assert!(example.findings.is_none());
    }

    #[test]
    fn the_example_is_accepted() {
        let configuration = parse("robot.toml", EXAMPLE).unwrap_or_else(|refused| panic!("{refused}"));
        assert_eq!(configuration.robot.fields.len(), 4);
        assert_eq!(configuration.robot.can.drive_node, 1);
        configuration.robot.guard().validate().unwrap();
    }
}
