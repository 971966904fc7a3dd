//! A two-dimensional lidar on its side that a motor turns: where both are, how they are mounted, and how far the motor turns.

use std::net::SocketAddr;
use std::path::Path;

use floorguard_drivers::scan_motor::ScanMotorConfiguration;
use floorguard_types::units::radians;

use super::address::{CanAddress, DatagramAddress, ScipAddress, SerialAddress, parse_serial};
use super::devices::read_source;
use super::reader::Reader;

/// Which sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScipModel {
    /// Hokuyo URG-04LX: a serial line, ten scans a second, 4 m.
    Urg04lx,
    /// Hokuyo UST-10LX: TCP, forty scans a second, 10 m.
    Ust10lx,
}

/// Lidar and motor.
#[derive(Clone, Debug, PartialEq)]
pub struct ActuatedLidarConfiguration {
    /// Which sensor.
    pub model: ScipModel,
    /// Where it is.
    pub source: ScipAddress,
    /// The bus of the motor: one of its own, because the robot's drives are clocked by the same SYNC frames.
    pub motor_source: CanAddress,
    /// The motor: node, gear, limits.
    pub motor: ScanMotorConfiguration,
    /// The motor's axis in the base frame, forward and left, and the height of the lidar's optical centre, metres.
    pub mounted_m: [f32; 3],
    /// From the axis to the optical centre along the level beam, metres.
    pub lever_arm_m: f32,
    /// Tilt of the scan plane about its level beam, radians.
    pub tilt_rad: f32,
    /// Edge of the window's cells, metres.
    pub cell_m: f32,
    /// What hangs higher is no obstacle, metres.
    pub threshold_m: f32,
    /// Where the boxes of people come from, one datagram a picture of a panoramic camera.
    pub people_source: Option<DatagramAddress>,
}

/// For the reference: a lidar as it may stand in the file.
pub(crate) const EXAMPLE_SECTION: &str = "[actuated_lidar]
model = \"urg-04lx\"
source = \"serial:/dev/ttyACM0\"
baud = 115200
motor_source = \"socketcan:can1\"
motor_node = 11
x_m = 0.3
height_m = 0.57
people_source = \"udp:127.0.0.1:7300\"
";

impl ActuatedLidarConfiguration {
    /// The serial lines that it needs for itself.
    pub(crate) fn lines(&self) -> Vec<&Path> {
        let mut lines = Vec::new();
        if let ScipAddress::Serial(line) = &self.source {
            lines.push(line.device.as_path());
        }
        if let CanAddress::Slcan(device) = &self.motor_source {
            lines.push(device.as_path());
        }
        lines
    }

    /// In words, for `check` and the start of a run.
    #[must_use]
    pub fn words(&self) -> String {
        let model = match self.model {
            ScipModel::Urg04lx => "URG-04LX",
            ScipModel::Ust10lx => "UST-10LX",
        };
        let source = match &self.source {
            ScipAddress::Serial(line) => line.device.display().to_string(),
            ScipAddress::Tcp(address) => format!("tcp:{address}"),
        };
        let motor = match &self.motor_source {
            CanAddress::SocketCan(name) => name.clone(),
            CanAddress::Slcan(device) => device.display().to_string(),
            CanAddress::Line(line) => line.device.display().to_string(),
        };
        let people = match self.people_source {
            Some(address) => format!("people by boxes that come to udp:{}", address.local),
            None => "no boxes of people: who walks stays in it until the lidar sweeps there again".to_owned(),
        };
        let (left_deg, sweep_s) = (
            self.motor.left_rad.to_degrees(),
            (self.motor.left_rad - self.motor.right_rad) / self.motor.speed_radps,
        );
        format!(
            "actuated lidar {model} at {source}, motor node {} at {motor}: window of ±{left_deg:.0}° in {sweep_s:.1} s, cells \
             of {} m; {people}",
            self.motor.node, self.cell_m
        )
    }
}

/// Parses `tcp:ADDRESS:PORT` or `serial:DEVICE`; the bit rate is filled in later.
fn parse_scip(text: &str) -> Option<ScipAddress> {
    let address = text.strip_prefix("tcp:").and_then(|address| address.parse().ok()).map(ScipAddress::Tcp);
    address
        .or_else(|| parse_serial(text).map(|device| ScipAddress::Serial(SerialAddress { device, baud: 0 })))
}

/// A text of the section that is an address.
fn read_other<T>(
    section: &Reader<'_>,
    (key, example, found): (&'static str, &str, Option<(&str, std::ops::Range<usize>)>),
    parse: impl Fn(&str) -> Option<T>,
) -> Option<T> {
    let (text, span) = found?;
    let address = parse(text);
    if address.is_none() {
        section.refuse(
            &span,
            format!("{}: `{key}` is \"{text}\", no address of this kind", section.title()),
            format!("write for example \"{example}\""),
        );
    }
    address
}

pub(super) fn read_scip_source(section: &Reader<'_>) -> Option<ScipAddress> {
    let source = read_source(section, "serial:/dev/ttyACM0", parse_scip);
    let baud = section.integer_or("baud", 9_600..=4_000_000, 115_200) as u32;
    Some(match source? {
        ScipAddress::Serial(line) => ScipAddress::Serial(SerialAddress { baud, ..line }),
        tcp @ ScipAddress::Tcp(_) => tcp,
    })
}

fn read_motor(section: &Reader<'_>) -> ScanMotorConfiguration {
    let published = ScanMotorConfiguration::PUBLISHED;
    let half_rad = radians(section.number_or("window_deg", 10.0..=170.0, 112.5));
    ScanMotorConfiguration {
        node: section.integer_or("motor_node", 1..=127, i64::from(published.node)) as u8,
        counts_per_turn: section.number_or("counts_per_turn", -1.0e8..=1.0e8, published.counts_per_turn),
        gear: section.number_or("gear", 0.01..=10_000.0, published.gear),
        ahead_counts: section.integer_or("ahead_counts", -1_000_000_000..=1_000_000_000, 0) as i32,
        left_rad: half_rad,
        right_rad: -half_rad,
        speed_radps: section.number_or("speed_radps", 0.05..=10.0, published.speed_radps),
        ramp_radps2: section.number_or("ramp_radps2", 0.05..=100.0, published.ramp_radps2),
    }
}

/// The section, where it is right.
pub(super) fn read_actuated_lidar(section: Reader<'_>) -> Option<ActuatedLidarConfiguration> {
    let model =
        section.choice("model", &[("urg-04lx", ScipModel::Urg04lx), ("ust-10lx", ScipModel::Ust10lx)]);
    let source = read_scip_source(&section);
    let bus = "socketcan:can1";
    let motor_source =
        read_other(&section, ("motor_source", bus, section.text("motor_source", bus)), CanAddress::parse);
    let motor = read_motor(&section);
    let port = "udp:127.0.0.1:7300";
    let people = section.text_or_absent("people_source", port, "no boxes of people");
    let is_named = people.is_some();
    let people_source = read_other(&section, ("people_source", port, people), DatagramAddress::parse);
    let configuration = ActuatedLidarConfiguration {
        model: model.unwrap_or(ScipModel::Urg04lx),
        source: source.clone().unwrap_or(ScipAddress::Tcp(SocketAddr::from(([0; 4], 0)))),
        motor_source: motor_source.clone().unwrap_or(CanAddress::SocketCan(String::new())),
        motor,
        mounted_m: [
            section.number_or("x_m", -2.0..=3.0, 0.0),
            section.number_or("y_m", -1.5..=1.5, 0.0),
            section.number("height_m", 0.1..=2.0),
        ],
        lever_arm_m: section.number_or("lever_arm_m", -0.5..=0.5, 0.0),
        tilt_rad: radians(section.number_or("tilt_deg", -10.0..=10.0, 0.0)),
        cell_m: section.number_or("cell_m", 0.02..=0.2, 0.05),
        threshold_m: section.number_or("threshold_m", 0.1..=2.0, 1.0),
        people_source,
    };
    if section.good_so_far() && !motor.is_plausible() {
        section.refuse(
            section.span(),
            "[actuated_lidar]: `counts_per_turn` is less than 256: an encoder is finer than 1.4 degrees",
            "write the counts of the encoder for a whole turn of the lidar, gear included",
        );
    }
    section.finish();
    let is_whole = model.is_some() && source.is_some() && motor_source.is_some();
    (is_whole && is_named == people_source.is_some()).then_some(configuration)
}

/// The motor's bus is no other's: two programs that send SYNC would make the robot's drives answer twice.
pub(super) fn check_motor_bus(
    top: &Reader<'_>,
    actuated: Option<&ActuatedLidarConfiguration>,
    can: Option<&CanAddress>,
) {
    let (Some(actuated), Some(can)) = (actuated, can) else { return };
    if matches!(can, CanAddress::SocketCan(_)) && *can == actuated.motor_source {
        top.refuse_to_drive(
            &top.find("actuated_lidar").map_or(0..0, |value| value.span()),
            "[actuated_lidar]: `motor_source` is the bus of [can]: the SYNC frames of the one would clock the other's drives",
            "give the motor a bus of its own, for example \"socketcan:can1\"",
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};

    fn read(section: &str) -> Result<Option<ActuatedLidarConfiguration>, String> {
        let parsed = parse("robot.toml", &format!("{EXAMPLE}\n{section}"));
        parsed.map(|read| read.carriers.actuated_lidar).map_err(|refused| refused.to_string())
    }

    #[test]
    fn section_is_read_with_its_defaults() {
        assert_eq!(read(""), Ok(None));
        let lidar = read(EXAMPLE_SECTION).unwrap().unwrap();
        let ScanMotorConfiguration { left_rad, right_rad, .. } = ScanMotorConfiguration::PUBLISHED;
        assert!(
            (lidar.motor.left_rad - left_rad).abs() < 1.0e-6
                && (lidar.motor.right_rad - right_rad).abs() < 1.0e-6
        );
        assert_eq!(
            ScanMotorConfiguration { left_rad, right_rad, ..lidar.motor },
            ScanMotorConfiguration::PUBLISHED
        );
        assert_eq!((lidar.mounted_m, lidar.cell_m, lidar.threshold_m), ([0.3, 0.0, 0.57], 0.05, 1.0));
        let words = lidar.words();
        assert!(words.contains("URG-04LX") && words.contains("±113°") || words.contains("±112°"), "{words}");
        assert!(words.contains("13.1 s") && words.contains("udp:127.0.0.1:7300"), "{words}");
        let tcp = EXAMPLE_SECTION.replace("serial:/dev/ttyACM0", "tcp:192.168.0.10:10940");
        assert_eq!(
            read(&tcp).unwrap().unwrap().source,
            ScipAddress::Tcp("192.168.0.10:10940".parse().unwrap())
        );
    }

    #[test]
    fn wrong_lines_are_refused_by_name() {
        for (right, wrong, reported) in [
            ("urg-04lx", "urg-4lx", "did you mean"),
            ("serial:/dev/ttyACM0", "ttyACM0", "`source` is \"ttyACM0\""),
            ("serial:/dev/ttyACM0", "serial:/dev/ttyUSB0", "so is that of [scanner]"),
            ("socketcan:can1", "can1", "`motor_source` is \"can1\""),
            ("socketcan:can1", "socketcan:can0", "the bus of [can]"),
            ("socketcan:can1", "slcan:/dev/ttyACM0", "so is that of [actuated_lidar]"),
            ("motor_node = 11", "motor_node = 128", "`motor_node` is 128"),
            ("motor_node = 11", "counts_per_turn = 12.0", "less than 256"),
            ("height_m = 0.57", "height_m = 57.0", "`height_m` is 57"),
            ("height_m = 0.57", "height_cm = 57.0", "wrong unit"),
            ("udp:127.0.0.1:7300", "127.0.0.1", "`people_source` is"),
            ("udp:127.0.0.1:7300", "udp:127.0.0.1:2368", "UDP port 2368"),
        ] {
            let refused = read(&EXAMPLE_SECTION.replace(right, wrong)).unwrap_err();
            assert!(refused.contains(reported), "{wrong}: {refused}");
        }
    }
}
