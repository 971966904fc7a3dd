//! Controllers of the wheels other than CiA 402 drives: what `[base]` says of them (book, Motor controllers).

use floorguard_drivers::motor_drives::{MotorDrivesConfiguration, MotorProtocol};
use floorguard_drivers::roboteq::WATCHDOG_VARIABLE;

use super::address::SerialAddress;
use super::devices::read_serial;
use super::reader::Reader;
use super::wheels::Wheels;

/// As `drives` names them; CiA 402 drives are none of these.
pub(super) const PROTOCOLS: [(&str, Option<MotorProtocol>); 6] = [
    ("cia402", None),
    ("odrive", Some(MotorProtocol::Odrive)),
    ("vesc", Some(MotorProtocol::Vesc)),
    ("roboteq", Some(MotorProtocol::Roboteq)),
    ("roboteq-can", Some(MotorProtocol::RoboteqCan)),
    ("wheel-line", Some(MotorProtocol::WheelLine)),
];

/// Which sides' motors are mounted the other way round.
const REVERSED: [(&str, [bool; 2]); 4] =
    [("none", [false, false]), ("left", [true, false]), ("right", [false, true]), ("both", [true, true])];

/// An ODrive reports turns: steps of its position in one turn are made here.
const STEPS_PER_TURN: f32 = 10_000.0;
/// A VESC counts sixths of an electrical turn.
const STEPS_PER_ELECTRICAL_TURN: f32 = 6.0;
/// After so long a silence they must have stopped by themselves, milliseconds.
const WATCHDOG_MS: i64 = 200;

/// The controllers, and their line where they are on one.
#[derive(Clone, Debug)]
pub(super) struct Motors {
    pub configuration: MotorDrivesConfiguration,
    pub line: Option<SerialAddress>,
}

impl Motors {
    /// Counts of a wheel in a metre; none where `[robot]` says.
    pub fn ticks_per_m(&self) -> Option<f32> {
        let MotorDrivesConfiguration { protocol, counts_per_turn, metres_per_turn, .. } = self.configuration;
        (protocol != MotorProtocol::WheelLine).then(|| counts_per_turn / metres_per_turn[0].abs().max(1.0e-4))
    }
}

/// The keys of `[base]` that only such controllers have.
pub(super) fn read_motors(
    section: &Reader<'_>,
    protocol: MotorProtocol,
    wheels: Option<Wheels>,
) -> Option<Motors> {
    let count = match wheels {
        Some(Wheels::Differential) => 2,
        Some(Wheels::Omnidirectional) if protocol != MotorProtocol::Roboteq => 4,
        _ => {
            section.refuse(
                section.span(),
                "[base]: `drives` names controllers of wheels that are not steered, and `kind` does not fit them",
                "write kind = \"differential\", or with four controllers \"omnidirectional\" (a Roboteq has two channels); steered \
                 bases have CiA 402 drives, or take velocities by `source`",
            );
            2
        }
    };
    let travel_m = match protocol {
        MotorProtocol::WheelLine => 1.0,
        _ => section.number("metres_per_turn", 0.001..=5.0),
    };
    let pole_pairs = match protocol {
        MotorProtocol::Vesc => section.integer("pole_pairs", 1..=60) as f32,
        _ => 1.0,
    };
    let counts_per_turn = match protocol {
        MotorProtocol::Odrive | MotorProtocol::WheelLine => STEPS_PER_TURN,
        MotorProtocol::Vesc => STEPS_PER_ELECTRICAL_TURN * pole_pairs,
        MotorProtocol::Roboteq | MotorProtocol::RoboteqCan => {
            section.integer("counts_per_turn", 4..=1_000_000) as f32
        }
    };
    let reversed = section.choice("reversed", &REVERSED)?;
    let [left_m, right_m] = reversed.map(|is_reversed| if is_reversed { -travel_m } else { travel_m });
    let has_brakes = section.flag_or("brakes", false);
    let watchdog_ms = section.integer_or("watchdog_ms", 50..=WATCHDOG_MS, WATCHDOG_MS) as u16;
    let line = if protocol.is_serial() { Some(read_serial(section)?) } else { None };
    Some(Motors {
        configuration: MotorDrivesConfiguration {
            protocol,
            wheels: count,
            metres_per_turn: [left_m, right_m, left_m, right_m],
            counts_per_turn,
            pole_pairs,
            has_brakes,
            watchdog_ms,
            ..MotorDrivesConfiguration::default()
        },
        line,
    })
}

/// What such controllers do not do: read by `check`.
pub(super) fn shortcomings(motors: &MotorDrivesConfiguration) -> Vec<String> {
    let mut lines = Vec::new();
    match motors.protocol {
        MotorProtocol::Vesc => lines.push(format!(
            "[base] drives: a VESC does not say whether it stops when this computer is silent, nor that it has a fault: set its timeout \
             to {} ms or less (App Settings, General, Timeout) with a brake current, pull the plug of the bus at walking pace, and see \
             it stop; below its least speed it holds nothing, so a robot on a slope rolls",
            motors.watchdog_ms
        )),
        MotorProtocol::Odrive => lines.push(
            "[base] drives: an ODrive whose watchdog acts takes the torque away and does not brake".to_owned(),
        ),
        MotorProtocol::RoboteqCan => lines.push(format!(
            "[base] drives: no CANopen object of a Roboteq tells its watchdog: a script in the controller sets it and shows it in user \
             variable {WATCHDOG_VARIABLE} (book, Motor controllers: Roboteq by CAN), and nothing drives before 1 to {} ms are read there. That \
             the script tells the truth is yours to see: pull the plug of the bus at walking pace, and see it stop",
            motors.watchdog_ms
        )),
        MotorProtocol::Roboteq | MotorProtocol::WheelLine => {}
    }
    if !motors.has_brakes {
        lines.push(
            "[base] `brakes` is not true: without torque nothing holds the wheels. A stop of category 0 is driven as one of category 1 \
             (ramp first), and after a fault of a controller the robot rolls on; fit brakes that grip without power"
                .to_owned(),
        );
    }
    lines.push("[base] drives: none of these controllers watches standstill or how a stop goes; the guard alone does".to_owned());
    lines
}
