//! A base that takes velocities, instead of the drives on a CAN bus (book, Velocity link).

use std::net::SocketAddr;

use floorguard_runtime::configuration::CanConfiguration;

use super::address::{BaseAddress, CanAddress, DatagramAddress, SenderAddress, SerialAddress, parse_serial};
use super::devices::{read_can, read_inputs};
use super::reader::Reader;

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

/// Either `[base]`, or `[can]` with `[inputs]`.
pub(super) fn read_drives(top: &Reader<'_>) -> Option<Drives> {
    if let Some(section) = top.optional_section("base") {
        for other in OF_THE_BUS.into_iter().filter(|other| top.find(other).is_some()) {
            section.refuse(
                section.span(),
                format!("[base] takes velocities, and [{other}] is of drives on a CAN bus"),
                format!("remove [{other}], or [base]"),
            );
        }
        return read_base(section).map(Drives::Velocity);
    }
    let (can, inputs) = (read_can(top.section("can")), read_inputs(top.section("inputs")));
    let (can, address) = can?;
    let (inputs, buttons) = inputs?;
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
    use floorguard_runtime::configuration::BaseKind;

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
            (format!("{EXAMPLE}\n{port}"), "[base] takes velocities, and [can] is of drives on a CAN bus"),
            (without_bus(&port.replace("udp:", "can:")), "no address of this kind"),
            (without_bus(&port.replace("10.0.0.9:7101", "base")), "`controller` is \"base\""),
            (without_bus(""), "section `[can]` is missing"),
            (without_bus(&port.replace("7100", "2368")), "so is that of [lidar]"),
        ] {
            let refused = parse("robot.toml", &text).expect_err(words).to_string();
            assert!(refused.contains(words), "{words} is not in: {refused}");
        }
    }
}
