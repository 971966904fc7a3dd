//! The base: how its wheels move it (book, Odometry: Bases), and whether it takes velocities (book, Velocity link) or has its drives on
//! a CAN bus.

use std::net::SocketAddr;
use std::ops::RangeInclusive;

use floorguard_drivers::motor_drives::{MotorDrivesConfiguration, MotorProtocol};
use floorguard_runtime::configuration::{BaseKind, CanConfiguration, DriveTrain, Geometry};
use floorguard_types::units::radians;

use super::address::{BaseAddress, CanAddress, DatagramAddress, SenderAddress, SerialAddress, parse_serial};
use super::devices::{read_can, read_inputs, read_motor_bus};
use super::fields::read_polygon;
use super::motors::{Motors, PROTOCOLS, read_motors};
use super::reader::Reader;
use super::wheels::Wheels;

/// Sections that only a base on a CAN bus has.
const OF_THE_BUS: [&str; 2] = ["can", "inputs"];

/// What drives the robot, and where.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Drives {
    Bus(CanConfiguration, CanAddress),
    Velocity(BaseAddress),
}

impl Drives {
    /// What is on the bus, of a robot whose drives are on one.
    pub const fn bus(&self) -> Option<&CanConfiguration> {
        match self {
            Self::Bus(can, _) => Some(can),
            Self::Velocity(_) => None,
        }
    }

    pub fn can(&self) -> Option<&CanAddress> {
        match self {
            Self::Bus(_, address) => Some(address),
            Self::Velocity(_) => None,
        }
    }

    /// The nodes on the bus, the bus, and the base: whatever is not there is empty.
    pub fn parted(self) -> (CanConfiguration, Option<CanAddress>, Option<BaseAddress>) {
        match self {
            Self::Bus(can, address) => (can, Some(address), None),
            Self::Velocity(address) => (CanConfiguration::default(), None, Some(address)),
        }
    }

    pub fn base(&self) -> Option<&BaseAddress> {
        match self {
            Self::Bus(..) => None,
            Self::Velocity(address) => Some(address),
        }
    }
}

/// What `[base]` says: the wheels, and whether a controller of its own drives them.
#[derive(Clone, Debug, Default)]
pub(super) struct BaseSection {
    /// Who drives the wheels.
    pub by: BaseKind,
    /// What `kind` names; none where a controller that takes velocities does not say.
    pub wheels: Option<Wheels>,
    /// Of the front wheels of a car, radians.
    steering_max_rad: f32,
    /// Of the controller; `None`: wrong.
    address: Option<BaseAddress>,
    /// Controllers other than CiA 402 drives.
    motors: Option<Motors>,
}

impl BaseSection {
    /// Without the section: a tricycle on a CAN bus.
    pub fn read(top: &Reader<'_>) -> Self {
        let Some(section) = top.optional_section("base") else {
            return Self { wheels: Some(Wheels::Tricycle), ..Self::default() };
        };
        let protocol = section.choice_or("drives", &PROTOCOLS, None);
        let takes_velocities = section.find("source").is_some() && protocol.is_none();
        let wheels = if takes_velocities && section.find("kind").is_none() {
            None
        } else {
            section.choice("kind", &Wheels::NAMES)
        };
        let steering_max_rad = match wheels {
            Some(Wheels::Ackermann) => radians(section.number("steering_max_deg", 5.0..=70.0)),
            _ => 0.0,
        };
        let motors = protocol.and_then(|protocol| read_motors(&section, protocol, wheels));
        if takes_velocities || protocol.is_some_and(MotorProtocol::is_serial) {
            for other in OF_THE_BUS.into_iter().filter(|other| top.find(other).is_some()) {
                section.refuse(
                    section.span(),
                    format!("[base] has a line of its own or takes velocities, and [{other}] is of drives on a CAN bus"),
                    format!("remove [{other}], or `source` of [base]"),
                );
            }
        }
        if !takes_velocities {
            section.finish();
            return Self { by: BaseKind::CanBus, wheels, steering_max_rad, address: None, motors };
        }
        Self { by: BaseKind::Velocity, wheels, steering_max_rad, address: read_base(section), motors }
    }

    /// Outline and wheels.
    pub fn read_geometry(&self, section: Reader<'_>) -> Option<(Geometry, DriveTrain)> {
        let footprint = read_polygon(&section, "footprint_m");
        // A base that takes velocities measures them itself, and turns its farthest corner as fast as a wheel there would.
        let farthest_m = footprint.iter().flatten().fold(0.2_f32, |most_m, corner| most_m.max(corner.norm()));
        let number = |key: &'static str, range: RangeInclusive<f32>, without: f32| match self.by {
            BaseKind::CanBus => section.number(key, range),
            BaseKind::Velocity => section.number_or(key, range, without),
        };
        let of_motors = self.motors.as_ref().and_then(Motors::ticks_per_m);
        let ticks_per_m = || of_motors.unwrap_or_else(|| number("ticks_per_m", 100.0..=1.0e6, 1.0e4));
        let between_axles_m = || section.number("wheelbase_m", 0.2..=3.0);
        let track_m = || section.number("track_m", 0.2..=2.0);
        let (wheelbase_m, track_m, ticks_per_m, wheel_lever_m, train) = match self.wheels {
            None | Some(Wheels::Tricycle) => {
                let wheelbase_m = number("wheelbase_m", 0.2..=3.0, farthest_m.min(3.0));
                let track_m = number("track_m", 0.2..=2.0, 0.5);
                (wheelbase_m, track_m, ticks_per_m(), 0.0, DriveTrain::Tricycle)
            }
            Some(Wheels::Differential) => {
                let track_m = track_m();
                (0.5 * track_m, track_m, ticks_per_m(), 0.5 * track_m, DriveTrain::Differential)
            }
            Some(Wheels::Ackermann) => {
                let (wheelbase_m, track_m) = (between_axles_m(), track_m());
                let train = DriveTrain::Ackermann { steering_max_rad: self.steering_max_rad };
                (wheelbase_m, track_m, ticks_per_m(), 0.5 * track_m, train)
            }
            Some(Wheels::Omnidirectional) => {
                let (wheelbase_m, track_m) = (between_axles_m(), track_m());
                // It turns as a differential base of this track does, and both wheels of a side are counted together.
                let alike_m = wheelbase_m + track_m;
                let train = DriveTrain::Omnidirectional { wheelbase_m, track_m };
                (0.5 * alike_m, alike_m, 2.0 * ticks_per_m(), 0.5 * alike_m, train)
            }
        };
        section.finish();
        let footprint = footprint.unwrap_or_default();
        let is_there = !footprint.is_empty();
        let geometry = Geometry { footprint, wheelbase_m, track_m, ticks_per_m, wheel_lever_m };
        is_there.then_some((geometry, train))
    }

    /// The controllers of a robot whose drives are other than CiA 402, with their numbers on the bus.
    pub fn motors(&self, can: &CanConfiguration) -> Option<MotorDrivesConfiguration> {
        let motors = self.motors.as_ref()?.configuration;
        let is_on_bus = !motors.protocol.is_serial();
        let nodes = if is_on_bus { can.wheel_nodes } else { motors.nodes };
        Some(MotorDrivesConfiguration { nodes, ..motors })
    }

    /// Where velocities go, or `[can]` with `[inputs]`.
    pub fn read_drives(&self, top: &Reader<'_>) -> Option<Drives> {
        if self.by == BaseKind::Velocity {
            return self.address.clone().map(Drives::Velocity);
        }
        let wheels = self.wheels.unwrap_or(Wheels::Tricycle);
        if let Some(motors) = &self.motors {
            return read_motor_drives(top, motors, wheels);
        }
        let can = read_can(top.section("can"), wheels);
        let inputs = read_inputs(top.section("inputs"));
        let (can, address) = can?;
        let (inputs, buttons) = inputs?;
        Some(Drives::Bus(CanConfiguration { inputs, buttons, ..can }, address))
    }
}

/// Controllers on a line of their own, or on a bus that may hold a safety controller's gateway as well.
fn read_motor_drives(top: &Reader<'_>, motors: &Motors, wheels: Wheels) -> Option<Drives> {
    if let Some(line) = &motors.line {
        return Some(Drives::Bus(CanConfiguration::default(), CanAddress::Line(line.clone())));
    }
    let protocol = motors.configuration.protocol;
    let has_inputs = top.find("inputs").is_some();
    let (can, address) = read_motor_bus(top.section("can"), wheels, (protocol, has_inputs))?;
    if !has_inputs {
        return Some(Drives::Bus(can, address));
    }
    let (inputs, buttons) = read_inputs(top.section("inputs"))?;
    Some(Drives::Bus(CanConfiguration { inputs, buttons, ..can }, address))
}

fn read_base(section: Reader<'_>) -> Option<BaseAddress> {
    let example = "udp:0.0.0.0:7100";
    let (text, span) = section.text("source", example)?;
    let address = match (DatagramAddress::parse(text), parse_serial(text)) {
        (Some(address), _) => read_controller(&section).map(|controller| {
            let sender = Some(SenderAddress { address: controller.ip(), port: None });
            BaseAddress::Datagrams(DatagramAddress { sender, ..address }, controller)
        }),
        (None, Some(device)) => {
            let baud = section.integer("baud", 57_600..=4_000_000) as u32;
            Some(BaseAddress::Serial(SerialAddress { device, baud }))
        }
        (None, None) => {
            section.refuse(
                &span,
                format!("[base]: `source` is \"{text}\", no address of this kind"),
                format!("write for example \"{example}\" or \"serial:/dev/ttyUSB2\""),
            );
            None
        }
    };
    section.finish();
    address
}

/// Where velocities go; what it measures must come from that computer.
fn read_controller(section: &Reader<'_>) -> Option<SocketAddr> {
    let (text, span) = section.text("controller", "192.168.1.20:7101")?;
    let address = text.parse().ok();
    if address.is_none() {
        section.refuse(
            &span,
            format!("[base]: `controller` is \"{text}\", no address with a port"),
            "write for example \"192.168.1.20:7101\"",
        );
    }
    address
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};
    use floorguard_guard::Source;

    /// The example robot without bus, inputs, encoders and route.
    fn without_bus(section: &str) -> String {
        let (before, rest) = EXAMPLE.split_once("[can]").expect("the example has a bus");
        let guard = rest.split_once("[guard]").expect("and thresholds").1;
        let guard = guard.split("[route]").next().unwrap_or_default();
        let own = before.replace("track_m = 0.60\nticks_per_m = 20000.0\n", "");
        format!("{own}[guard]{guard}{section}")
    }

    #[test]
    fn base_by_velocities_needs_no_bus() {
        let port = "[base]\nsource = \"udp:0.0.0.0:7100\"\ncontroller = \"10.0.0.9:7101\"\n";
        let read = parse("robot.toml", &without_bus(port)).unwrap_or_else(|refused| panic!("{refused}"));
        assert_eq!((read.robot.base, read.carriers.can), (BaseKind::Velocity, None));
        let guard = read.robot.guard();
        guard.validate().unwrap();
        // Without a safety controller nothing is waited for; what is measured of the motion must come.
        assert!(!guard.rules(Source::Discrete).fitted);
        assert!(guard.rules(Source::Wheels).fitted && guard.rules(Source::Drive).fitted);
        let line = "[base]\nsource = \"serial:/dev/ttyUSB2\"\nbaud = 115200\n";
        let read = parse("robot.toml", &without_bus(line)).unwrap_or_else(|refused| panic!("{refused}"));
        assert!(matches!(read.carriers.base, Some(BaseAddress::Serial(_))));
    }

    #[test]
    fn wrong_base_sections_are_refused() {
        let port = "[base]\nsource = \"udp:0.0.0.0:7100\"\ncontroller = \"10.0.0.9:7101\"\n";
        for (text, words) in [
            (
                format!("{EXAMPLE}\n{port}"),
                "[base] has a line of its own or takes velocities, and [can] is of drives on a CAN bus",
            ),
            (without_bus(&port.replace("udp:", "can:")), "no address of this kind"),
            (without_bus(&port.replace("10.0.0.9:7101", "base")), "`controller` is \"base\""),
            (without_bus(""), "section `[can]` is missing"),
            (without_bus(&port.replace("7100", "2368")), "so is that of [lidar]"),
        ] {
            let refused = parse("robot.toml", &text).expect_err(words).to_string();
            assert!(refused.contains(words), "{words} is not in: {refused}");
        }
    }

    const NODES: &str = "drive_node = 1\nsteering_node = 2\nleft_encoder_node = 3\nright_encoder_node = 4\n";

    /// The example robot on other wheels, its drives on the bus.
    fn on_wheels(base: &str, nodes: &str) -> String {
        format!("{}\n[base]\n{base}\n", EXAMPLE.replace(NODES, nodes))
    }

    #[test]
    fn wheels_give_lever_track_and_counts() {
        let text = on_wheels("kind = \"differential\"", "left_drive_node = 7\nright_drive_node = 8\n")
            .replace("wheelbase_m = 0.80\n", "");
        let robot = parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).robot;
        assert_eq!((robot.train, robot.can.wheel_nodes), (DriveTrain::Differential, [7, 8, 0, 0]));
        let drive = robot.guard().drive;
        assert_eq!((drive.wheelbase_m, drive.wheel_lever_m), (0.3, 0.3));
        let four = "front_left_drive_node = 1\nfront_right_drive_node = 2\nrear_left_drive_node = 3\nrear_right_drive_node = 4\n";
        let text = on_wheels("kind = \"omnidirectional\"", four);
        let robot = parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).robot;
        // It turns as a differential base whose track is 0.8 + 0.6 m, and counts two wheels on each side.
        assert!((robot.geometry.track_m - 1.4).abs() < 1.0e-6, "{}", robot.geometry.track_m);
        assert_eq!(robot.geometry.ticks_per_m, 40_000.0);
        assert!((robot.guard().drive.wheel_lever_m - 0.7).abs() < 1.0e-6);
        let text = on_wheels("kind = \"ackermann\"\nsteering_max_deg = 45.0", NODES);
        let robot = parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).robot;
        assert!((robot.ackermann().curvature_max_per_m() - 1.25).abs() < 1.0e-5);
        robot.guard().validate().unwrap();
    }

    #[test]
    fn wheels_that_do_not_fit_are_refused() {
        let pair = "left_drive_node = 1\nright_drive_node = 2\n";
        for (text, words) in [
            (on_wheels("kind = \"diferential\"", pair), "did you mean"),
            (on_wheels("kind = \"differential\"", NODES), "`left_drive_node` is missing"),
            (
                on_wheels("kind = \"differential\"", &pair.replace('2', "5"))
                    .replace("wheelbase_m = 0.80\n", ""),
                "are not different",
            ),
            (on_wheels("kind = \"ackermann\"", NODES), "`steering_max_deg` is missing"),
            (on_wheels("kind = \"differential\"", pair), "`wheelbase_m` is not a known key"),
            (on_wheels("", NODES), "`kind` is missing"),
        ] {
            let refused = parse("robot.toml", &text).expect_err(words).to_string();
            assert!(refused.contains(words), "{words} is not in: {refused}");
        }
    }

    const ROBOTEQ: &str = "kind = \"differential\"\ndrives = \"roboteq-can\"\nmetres_per_turn = 0.02\ncounts_per_turn = 2000\nreversed = \
         \"left\"\nbrakes = true";

    /// The example robot with a Roboteq on its bus.
    fn with_roboteq(nodes: &str) -> String {
        on_wheels(ROBOTEQ, nodes)
            .replace("wheelbase_m = 0.80\n", "")
            .replace("ticks_per_m = 20000.0\n", "")
            .replace("dirt_sensor_node = 6\n", "")
    }

    #[test]
    fn roboteq_on_bus_shares_its_number() {
        let text = with_roboteq("left_drive_node = 1\nright_drive_node = 1\n");
        let robot = parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).robot;
        let motors = robot.motor_drives().expect("controllers");
        assert_eq!((motors.protocol, motors.nodes), (MotorProtocol::RoboteqCan, [1, 1, 0, 0]));
        assert_eq!((motors.counts_per_turn, motors.metres_per_turn[0]), (2_000.0, -0.02));
        assert_eq!(robot.geometry.ticks_per_m, 100_000.0);
        // What it cannot show by itself is named.
        let text = crate::motors::shortcomings(&motors).join("\n");
        assert!(text.contains("user variable 1") && text.contains("1 to 200 ms"), "{text}");
    }

    #[test]
    fn wrong_numbers_of_a_roboteq_are_refused() {
        let four = |numbers: [u8; 4]| {
            let keys = ["front_left", "front_right", "rear_left", "rear_right"];
            let lines =
                keys.iter().zip(numbers).map(|(key, number)| format!("{key}_drive_node = {number}\n"));
            let text =
                on_wheels(&ROBOTEQ.replace("differential", "omnidirectional"), &lines.collect::<String>());
            text.replace("ticks_per_m = 20000.0\n", "").replace("dirt_sensor_node = 6\n", "")
        };
        let _ = parse("robot.toml", &four([1, 1, 2, 2])).unwrap_or_else(|refused| panic!("{refused}"));
        for (text, words) in [
            (four([1, 1, 1, 2]), "one or two Roboteqs with two channels each"),
            (four([1, 2, 3, 4]), "one or two Roboteqs with two channels each"),
            (
                with_roboteq("left_drive_node = 5\nright_drive_node = 5\n"),
                "`inputs_node` 5 are not different",
            ),
            (with_roboteq("left_drive_node = 1\nright_drive_node = 127\n"), "`right_drive_node` is 127"),
            (with_roboteq("left_drive_node = 1\n"), "`right_drive_node` is missing"),
        ] {
            let refused = parse("robot.toml", &text).expect_err(words).to_string();
            assert!(refused.contains(words), "{words} is not in: {refused}");
        }
    }
}
