//! `[fleet]` and `--fleet`: the robot drives to the places that a fleet's master orders.

use std::path::Path;
#[cfg(feature = "fleet")]
use std::path::PathBuf;

use floorguard_configuration::FleetConfiguration;
#[cfg(not(feature = "fleet"))]
use floorguard_operator::telemetry::RunLink;
use floorguard_robot::navigator::{DriveOrders, NavigationSettings};
use floorguard_runtime::configuration::RobotConfiguration;

/// What a robot in a fleet is, and where its orders go.
#[cfg_attr(not(feature = "fleet"), expect(dead_code, reason = "a program without fleets refuses them"))]
pub struct FleetOpening<'a> {
    /// The fleet.
    pub fleet: &'a FleetConfiguration,
    /// The folder of the robot's file: what must outlive the program, and the broker's certificates, lie there.
    pub folder: Option<&'a Path>,
    /// The robot.
    pub robot: &'a RobotConfiguration,
    /// How it drives.
    pub settings: NavigationSettings,
    /// Where its orders go.
    pub orders: DriveOrders,
}

/// A broker on the command line: `HOST:PORT`, or `HOST:PORT/SERIAL`.
///
/// # Errors
/// Anything else, in words.
#[cfg(any(test, feature = "laboratory"))]
pub(super) fn fleet_broker(text: &str) -> Result<FleetConfiguration, String> {
    let (address, serial) = text.split_once('/').unwrap_or((text, "simulated-1"));
    let parts = address.rsplit_once(':').and_then(|(host, port)| Some((host, port.parse::<u16>().ok()?)));
    match parts {
        Some((host, port))
            if !host.is_empty() && port > 0 && !serial.is_empty() && !serial.contains(['/', '+', '#']) =>
        {
            Ok(FleetConfiguration::at(host.to_owned(), port, serial.to_owned()))
        }
        _ => Err("write HOST:PORT or HOST:PORT/SERIAL, for example 127.0.0.1:1883/robot-7".to_owned()),
    }
}

/// Joins the fleet.
///
/// # Errors
/// The folder, certificates, or a program that was built without fleets.
#[cfg(not(feature = "fleet"))]
pub fn join(_opening: FleetOpening<'_>) -> anyhow::Result<Box<dyn RunLink>> {
    let what = "fleets: this program was built without them; build it with `--features fleet`";
    Err(super::exit::WrongUsage(what.to_owned()).into())
}

#[cfg(feature = "fleet")]
pub use joined::join;

/// Where a robot keeps what must outlive the program.
#[cfg(feature = "fleet")]
fn kept_in(folder: &Path, serial: &str) -> PathBuf {
    folder.join(format!("fleet-{serial}"))
}

#[cfg(feature = "fleet")]
mod joined {
    use floorguard_fleet::{
        BrokerAddress, EmergencyStop, FleetLink, MqttVersion, OrderedPlace, VehicleCommand,
        VehicleDescription, VehicleFault, VehicleMoment, VehiclePose,
    };
    use floorguard_guard::{Cause, GuardState};
    use floorguard_operator::panel::Order;
    use floorguard_operator::telemetry::{LinkMoment, RunLink};
    use floorguard_robot::navigator::{
        DriveOrder, DriveOrders, NavigationPhase, NavigationProgress, OrderedGoal, StandingReason,
    };
    use floorguard_runtime::shared::RobotStatus;
    use floorguard_types::geometry::Pose2;

    use super::{FleetOpening, kept_in};
    use crate::commands::exit::BadInput;

    /// The broker's password.
    const PASSWORD_VARIABLE: &str = "FLOORGUARD_FLEET_PASSWORD";
    /// Height of the body where nothing says it, metres.
    const HEIGHT_M: f64 = 1.1;
    /// The robot is shown this often, microseconds.
    const SHOW_EVERY_US: u64 = 50_000;

    /// Joins the fleet.
    ///
    /// # Errors
    /// The folder, certificates, or encryption that the program was built without.
    pub fn join(opening: FleetOpening<'_>) -> anyhow::Result<Box<dyn RunLink>> {
        let FleetOpening { fleet, folder, orders, .. } = &opening;
        let login =
            fleet.user.clone().map(|user| (user, std::env::var(PASSWORD_VARIABLE).unwrap_or_default()));
        let authority =
            fleet.authority.as_ref().map(|file| folder.map_or(file.clone(), |folder| folder.join(file)));
        let mqtt = if fleet.is_mqtt_5 { MqttVersion::V5 } else { MqttVersion::V3 };
        let broker = BrokerAddress { host: fleet.broker.clone(), port: fleet.port, authority, login, mqtt };
        let kept = folder.map(|folder| kept_in(folder, &fleet.serial));
        let link = FleetLink::open(describe(&opening), &broker, kept)
            .map_err(|error| BadInput(format!("[fleet]: {error}")))?;
        let encryption = if broker.authority.is_some() { "encrypted" } else { "not encrypted" };
        say!("  fleet: {} at {}:{}, {encryption}", fleet.serial, broker.host, broker.port);
        Ok(Box::new(Joined { link, orders: orders.clone(), next_us: 0 }))
    }

    fn describe(opening: &FleetOpening<'_>) -> VehicleDescription {
        let FleetOpening { fleet, robot, settings, .. } = opening;
        let corners: Vec<[f64; 2]> = robot
            .geometry
            .footprint
            .iter()
            .map(|corner| [f64::from(corner.x_m), f64::from(corner.y_m)])
            .collect();
        let span = |axis: usize| {
            let along = corners.iter().map(|corner| corner[axis]);
            along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
        };
        VehicleDescription {
            interface: fleet.interface.clone(),
            manufacturer: fleet.manufacturer.clone(),
            serial: fleet.serial.clone(),
            map_id: fleet.map_id.clone(),
            size_m: [span(0), span(1), HEIGHT_M],
            speed_max_mps: f64::from(settings.speed_mps),
            acceleration_max_mps2: [
                f64::from(robot.limits.acceleration_mps2),
                f64::from(robot.limits.braking_mps2),
            ],
            outline_m: corners,
            within_m: f64::from(settings.within_m),
            within_rad: f64::from(settings.within_rad),
        }
    }

    /// The robot in its fleet.
    struct Joined {
        link: FleetLink,
        orders: DriveOrders,
        next_us: u64,
    }

    impl RunLink for Joined {
        fn attend(&mut self, moment: &LinkMoment<'_>) -> Vec<Order> {
            let now_us = moment.now.as_micros();
            let Some(status) = moment.status.filter(|_| now_us >= self.next_us) else { return Vec::new() };
            self.next_us = now_us + SHOW_EVERY_US;
            let shown = shown(now_us, status, moment.drive.map(|drive| &**drive));
            let commands = self.link.attend(shown);
            commands.into_iter().filter_map(|command| self.carry_out(command)).collect()
        }
    }

    impl Joined {
        /// A button, or an order to the drive.
        fn carry_out(&self, command: VehicleCommand) -> Option<Order> {
            let order = match command {
                VehicleCommand::Pause => return Some(Order::Pause),
                VehicleCommand::Resume => return Some(Order::Resume),
                VehicleCommand::Stand => DriveOrder::Stand,
                VehicleCommand::Relocate(pose) => DriveOrder::Relocate(pose_in_map(pose)),
                VehicleCommand::Goto(OrderedPlace { number, pose, within_m, within_rad }) => {
                    DriveOrder::Goto(OrderedGoal {
                        number,
                        goal_in_map: pose_in_map(pose),
                        within_m: within_m as f32,
                        within_rad: within_rad as f32,
                    })
                }
            };
            if !self.orders.push(order) {
                say!("  fleet: the drive takes no more orders");
            }
            None
        }
    }

    fn pose_in_map(pose: VehiclePose) -> Pose2 {
        Pose2::new(pose.x_m as f32, pose.y_m as f32, pose.heading_rad as f32)
    }

    fn shown(now_us: u64, status: &RobotStatus, drive: Option<&NavigationProgress>) -> VehicleMoment {
        let twist = status.pose.twist;
        let cause = status.decision.holding_cause.map(|record| record.cause);
        let of = |phase: NavigationPhase| {
            drive.filter(|drive| drive.phase == phase).map(|drive| drive.goal_number)
        };
        let is_moving = twist.linear_mps.abs() > 0.02 || twist.angular_radps.abs() > 0.02;
        VehicleMoment {
            now_s: now_us as f64 * 1.0e-6,
            pose: drive.map(|drive| VehiclePose {
                x_m: f64::from(drive.pose_in_map.x_m),
                y_m: f64::from(drive.pose_in_map.y_m),
                heading_rad: f64::from(drive.pose_in_map.heading_rad),
            }),
            is_localised: drive.is_some_and(|drive| drive.is_trusted),
            speed: [f64::from(twist.linear_mps), f64::from(twist.angular_radps)],
            is_driving: is_moving,
            is_paused: drive.is_some_and(|drive| drive.is_paused),
            is_automatic: true,
            reached: of(NavigationPhase::Reached),
            unreachable: of(NavigationPhase::Unreachable),
            emergency_stop: emergency_stop(status.decision.state, cause),
            is_field_violated: matches!(cause, Some(Cause::ScanProtective | Cause::LidarProtective)),
            faults: faults(status, drive),
        }
    }

    fn emergency_stop(state: GuardState, cause: Option<Cause>) -> EmergencyStop {
        let is_pressed = cause == Some(Cause::EmergencyStop);
        if is_pressed || state == GuardState::Latched { EmergencyStop::Manual } else { EmergencyStop::None }
    }

    /// Why the robot does not drive, where it is not its own will.
    fn faults(status: &RobotStatus, drive: Option<&NavigationProgress>) -> Vec<VehicleFault> {
        let fault =
            |kind: &str, words: String, is_fatal| VehicleFault { kind: kind.to_owned(), words, is_fatal };
        let needs_person = matches!(status.decision.state, GuardState::Latched | GuardState::AwaitsStart);
        let held = status.decision.holding_cause.filter(|record| record.action.stops());
        // Without numbers: they change all the time.
        let held = held.map(|record| fault("guardHolds", record.cause.to_string(), needs_person));
        let help = drive.filter(|drive| drive.phase == NavigationPhase::NeedsHelp);
        let help = help.map(|drive| {
            let words = match drive.standing {
                Some(StandingReason::Recovery(step)) => step.measure.words().to_owned(),
                _ => drive.phase.name().to_owned(),
            };
            fault("needsHelp", words, true)
        });
        let lost = drive.filter(|drive| !drive.is_trusted);
        let lost = lost
            .map(|_| fault("localizationError", "the pose does not explain what is seen".to_owned(), false));
        held.into_iter().chain(help).chain(lost).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn broker_has_port_and_serial() {
        let fleet = fleet_broker("127.0.0.1:1883/robot-7").unwrap();
        assert_eq!((fleet.port, fleet.serial.as_str()), (1_883, "robot-7"));
        assert_eq!(fleet_broker("broker:8883").unwrap().serial, "simulated-1");
        for wrong in ["", "broker", ":1883", "broker:0", "broker:1883/", "broker:1883/a/b"] {
            assert!(fleet_broker(wrong).is_err(), "{wrong}");
        }
    }
}
