//! The sections of the sensors and of the bus: model, address, mounting.

use floorguard_drivers::flexisoft::{InputBits, InputMap};
use floorguard_drivers::motor_drives::MotorProtocol;
use floorguard_runtime::configuration::{
    CanConfiguration, ImuConfiguration, ImuModel, Mounting, OperatorButtons,
};
use floorguard_types::geometry::Point3;
use floorguard_types::units::radians;

use super::address::{CanAddress, DatagramAddress, ImuAddress, SenderAddress, SerialAddress, parse_serial};
use super::reader::Reader;
use super::wheels::Wheels;

mod channels;

use channels::{check_bits, check_channels};

pub(super) fn read_mounting(section: Reader<'_>) -> Mounting {
    let mounting = Mounting {
        position: Point3::new(
            section.number("x_m", -2.0..=3.0),
            section.number("y_m", -1.5..=1.5),
            section.number("z_m", 0.02..=3.0),
        ),
        roll_rad: radians(section.number_or("roll_deg", -180.0..=180.0, 0.0)),
        pitch_rad: radians(section.number_or("pitch_deg", -90.0..=90.0, 0.0)),
        yaw_rad: radians(section.number_or("yaw_deg", -180.0..=180.0, 0.0)),
    };
    section.finish();
    mounting
}

pub(super) fn read_source<T>(
    section: &Reader<'_>,
    example: &str,
    parse: impl Fn(&str) -> Option<T>,
) -> Option<T> {
    let (text, span) = section.text("source", example)?;
    let address = parse(text);
    if address.is_none() {
        section.refuse(
            &span,
            format!("{}: `source` is \"{text}\", no address of this kind", section.title()),
            format!("write for example \"{example}\""),
        );
    }
    address
}

/// The port to bind, and the only device that is listened to there, if one is named.
pub(super) fn read_datagrams(section: &Reader<'_>, example: &str) -> Option<DatagramAddress> {
    let source = read_source(section, example, DatagramAddress::parse);
    let text =
        section.text_or_absent("sender", "192.168.1.201", "the sender that is understood first counts");
    let sender = text.as_ref().and_then(|(text, _)| SenderAddress::parse(text));
    if let (Some((text, span)), None) = (&text, sender) {
        section.refuse(
            span,
            format!("{}: `sender` is \"{text}\", no address of a device", section.title()),
            "write for example \"192.168.1.201\", or with its port \"192.168.1.201:2368\"",
        );
    }
    Some(DatagramAddress { sender, ..source? })
}

pub(super) fn read_serial(section: &Reader<'_>) -> Option<SerialAddress> {
    let device = read_source(section, "serial:/dev/ttyUSB0", parse_serial);
    let baud = section.integer("baud", 9_600..=4_000_000) as u32;
    Some(SerialAddress { device: device?, baud })
}

pub(super) fn read_imu(section: Reader<'_>) -> Option<(ImuConfiguration, ImuAddress)> {
    let models =
        [ImuModel::XsensMti, ImuModel::VectorNav, ImuModel::Bridged].map(|model| (model.key(), model));
    let model = section.choice_or("model", &models, ImuModel::XsensMti);
    let source = if model == ImuModel::Bridged && !is_on_line(&section) {
        read_datagrams(&section, "udp:127.0.0.1:2371").map(ImuAddress::Datagrams)
    } else {
        read_serial(&section).map(ImuAddress::Serial)
    };
    let mounting = read_mounting(section.section("mounting"));
    section.finish();
    Some((ImuConfiguration { model, mounting }, source?))
}

/// Frames of a bridge come on a line, too.
fn is_on_line(section: &Reader<'_>) -> bool {
    let source = section.find("source").and_then(|value| value.get_ref().as_str());
    source.is_some_and(|source| source.starts_with("serial:"))
}

/// The keys of the drives' numbers, wheel by wheel.
fn wheel_keys(wheels: Wheels) -> &'static [&'static str] {
    match wheels {
        Wheels::Omnidirectional => &[
            "front_left_drive_node",
            "front_right_drive_node",
            "rear_left_drive_node",
            "rear_right_drive_node",
        ],
        _ => &["left_drive_node", "right_drive_node"],
    }
}

/// A bus of motor controllers other than CiA 402 drives; a gateway may be on it, too.
pub(super) fn read_motor_bus(
    section: Reader<'_>,
    wheels: Wheels,
    (protocol, has_inputs): (MotorProtocol, bool),
) -> Option<(CanConfiguration, CanAddress)> {
    let source = read_source(&section, "socketcan:can0", CanAddress::parse);
    let most = match protocol {
        MotorProtocol::Odrive => 63,
        MotorProtocol::RoboteqCan => 126,
        _ => 254,
    };
    let mut wheel_nodes = [0; 4];
    for (node, key) in wheel_nodes.iter_mut().zip(wheel_keys(wheels)) {
        *node = section.integer(key, 1..=most) as u8;
    }
    let inputs_node = if has_inputs { section.integer("inputs_node", 1..=127) as u8 } else { 0 };
    refuse_numbers(&section, protocol, (&wheel_nodes, inputs_node));
    // Five bits of the identifier are the message: other numbers have identifiers of CANopen.
    let is_clear = |node: &u8| matches!(node, 0..=3 | 60..=63);
    if protocol == MotorProtocol::Odrive && has_inputs && !wheel_nodes.iter().all(is_clear) {
        section.refuse(
            section.span(),
            "[can]: an axis of an ODrive has identifiers that CANopen uses, and [inputs] is on the same bus",
            "give the axes numbers of 1 to 3 or 60 to 63",
        );
    }
    section.finish();
    Some((CanConfiguration { wheel_nodes, inputs_node, ..CanConfiguration::default() }, source?))
}

/// Controllers have numbers of their own; the wheels of a Roboteq's channels share its number.
fn refuse_numbers(section: &Reader<'_>, protocol: MotorProtocol, (wheel_nodes, inputs_node): (&[u8; 4], u8)) {
    if !section.good_so_far() {
        return;
    }
    let fitted: Vec<u8> = wheel_nodes.iter().copied().filter(|node| *node != 0).collect();
    let different: std::collections::BTreeSet<u8> = fitted.iter().copied().collect();
    if protocol != MotorProtocol::RoboteqCan {
        if different.len() < fitted.len() {
            section.refuse(
                section.span(),
                format!("[can]: node numbers {wheel_nodes:?} are not different"),
                "give every controller its own number",
            );
        }
        return;
    }
    let channels = |node: &u8| fitted.iter().filter(|of_wheel| *of_wheel == node).count();
    if different.len() > 2 || different.iter().any(|node| channels(node) > 2) {
        section.refuse(
            section.span(),
            format!("[can]: node numbers {wheel_nodes:?} are not those of one or two Roboteqs with two channels each"),
            "write the number of a controller for each of its wheels, for example front wheels 1, rear wheels 2; the wheel that is named \
             first is its channel 1",
        );
    }
    if different.contains(&inputs_node) {
        section.refuse(
            section.span(),
            format!("[can]: node numbers {wheel_nodes:?} and `inputs_node` {inputs_node} are not different"),
            "give the safety controller's gateway its own number",
        );
    }
}

/// The devices of the base on the bus: which there are, the wheels say.
pub(super) fn read_can(section: Reader<'_>, wheels: Wheels) -> Option<(CanConfiguration, CanAddress)> {
    let source = read_source(&section, "socketcan:can0", CanAddress::parse);
    let node = |key| section.integer(key, 1..=127) as u8;
    let drives = match wheels {
        Wheels::Tricycle | Wheels::Ackermann => CanConfiguration {
            drive_node: node("drive_node"),
            steering_node: node("steering_node"),
            left_encoder_node: node("left_encoder_node"),
            right_encoder_node: node("right_encoder_node"),
            ..CanConfiguration::default()
        },
        Wheels::Differential => CanConfiguration {
            wheel_nodes: [node("left_drive_node"), node("right_drive_node"), 0, 0],
            ..CanConfiguration::default()
        },
        Wheels::Omnidirectional => CanConfiguration {
            wheel_nodes: [
                "front_left_drive_node",
                "front_right_drive_node",
                "rear_left_drive_node",
                "rear_right_drive_node",
            ]
            .map(node),
            ..CanConfiguration::default()
        },
    };
    let can = CanConfiguration {
        inputs_node: node("inputs_node"),
        dirt_sensor_node: section.integer_or_absent("dirt_sensor_node", 1..=127).map(|node| node as u8),
        ..drives
    };
    let CanConfiguration { drive_node, steering_node, left_encoder_node, right_encoder_node, .. } = can;
    let mut nodes = vec![drive_node, steering_node, left_encoder_node, right_encoder_node];
    nodes.extend(can.wheel_nodes);
    nodes.retain(|node| *node != 0);
    nodes.push(can.inputs_node);
    nodes.extend(can.dirt_sensor_node);
    let different: std::collections::BTreeSet<u8> = nodes.iter().copied().collect();
    if section.good_so_far() && different.len() < nodes.len() {
        section.refuse(
            section.span(),
            format!("[can]: node numbers {nodes:?} are not different"),
            "give every device on the bus its own number",
        );
    }
    section.finish();
    Some((can, source?))
}

/// Which bit of the safety controller's process image means what, and which are the operator's buttons.
pub(super) fn read_inputs(section: Reader<'_>) -> Option<(InputMap, OperatorButtons)> {
    let inverted = section.bit_list("inverted_bits");
    let with_polarity = |bits: [u8; 2]| InputBits { bits, inverted: bits.map(|bit| inverted.contains(&bit)) };
    let required = |key| {
        let bits = section.bits_or_absent(key);
        if bits.is_none() && section.good_so_far() {
            section.refuse(
                section.span(),
                format!("[inputs]: `{key}` is missing; nothing moves without it"),
                format!("add for example `{key} = [32, 33]`: the bits of both channels in the process image"),
            );
        }
        bits.map(with_polarity)
    };
    let optional = |key| section.bits_or_absent(key).map(with_polarity);
    let (emergency_stop, bumper_front) = (required("emergency_stop_bits"), required("bumper_front_bits"));
    let (bumper_rear, cliff_front) = (optional("bumper_rear_bits"), optional("cliff_front_bits"));
    let cliff_rear = optional("cliff_rear_bits");
    let discrepancy_us = (section.number_or("discrepancy_s", 0.01..=1.0, 0.5) * 1.0e6) as u64;
    let button = |key| section.integer_or_absent(key, 0..=255).map(|bit| bit as u8);
    let buttons = OperatorButtons { reset_bit: button("reset_bit"), start_bit: button("start_bit") };
    let of_button = |bit: Option<u8>| bit.map(|bit| InputBits::new([bit, bit]));
    let inputs = [
        ("emergency_stop_bits", emergency_stop),
        ("bumper_front_bits", bumper_front),
        ("bumper_rear_bits", bumper_rear),
        ("cliff_front_bits", cliff_front),
        ("cliff_rear_bits", cliff_rear),
    ];
    let of_buttons =
        [("reset_bit", of_button(buttons.reset_bit)), ("start_bit", of_button(buttons.start_bit))];
    check_bits(&section, &[&inputs[..], &of_buttons[..]].concat());
    check_channels(&section, &inputs);
    section.finish();
    let inputs = InputMap {
        emergency_stop: emergency_stop?,
        bumper_front: bumper_front?,
        bumper_rear,
        cliff_front,
        cliff_rear,
        discrepancy_us,
    };
    Some((inputs, buttons))
}

#[cfg(test)]
mod tests {
    use crate::{EXAMPLE, ImuAddress, parse};
    use floorguard_runtime::configuration::ImuModel;

    /// A port of its own, or a line.
    #[test]
    fn bridged_imus_have_ports_or_lines() {
        let (before, after) = EXAMPLE.split_once("[imu]\n").unwrap();
        let (_, mounting) = after.split_once("mounting").unwrap();
        let with = |keys: &str| format!("{before}[imu]\nmodel = \"bridged\"\n{keys}mounting{mounting}");
        let read =
            |keys: &str| parse("robot.toml", &with(keys)).unwrap_or_else(|refused| panic!("{refused}"));
        let port = read("source = \"udp:127.0.0.1:2371\"\nsender = \"127.0.0.1\"\n");
        assert_eq!(port.robot.imu.unwrap().model, ImuModel::Bridged);
        assert!(matches!(port.carriers.imu, Some(ImuAddress::Datagrams(_))));
        let line = read("source = \"serial:/dev/ttyUSB9\"\nbaud = 115200\n");
        assert!(matches!(line.carriers.imu, Some(ImuAddress::Serial(_))));
        for (keys, words) in [
            ("source = \"udp:127.0.0.1:2371\"\nbaud = 115200\n", "baud"),
            ("source = \"serial:/dev/ttyUSB9\"\n", "baud"),
            ("source = \"udp:0.0.0.0:2368\"\n", "UDP port 2368, and so is that of [lidar]"),
        ] {
            let refused = parse("robot.toml", &with(keys)).expect_err("refused").to_string();
            assert!(refused.contains(words), "{words} is not in: {refused}");
        }
    }
}
