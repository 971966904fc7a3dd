//! The robot as its fleet sees it, and what the fleet orders as the robot takes it.

use floorguard_fleet::{
    BrokerAddress, Cleaning, CleaningMoment, CleaningPlace, CleaningPromise, CleaningStage, EmergencyStop,
    FleetLink, MqttVersion, OrderedPlace, VehicleCommand, VehicleDescription, VehicleFault, VehicleMoment,
    VehiclePose,
};
use floorguard_guard::{Cause, GuardState};
use floorguard_host::outcome::BadInput;
use floorguard_operator::panel::Order;
use floorguard_operator::telemetry::{LinkMoment, RunLink};
use floorguard_robot::cleaner::{
    CleaningCommand, CleaningCounts, CleaningOrder, CleaningOrders, CleaningStage as Stage, CleaningStatus,
};
use floorguard_robot::navigator::{
    DriveOrder, DriveOrders, NavigationPhase, NavigationProgress, OrderedGoal, StandingReason, WayLimits,
};
use floorguard_runtime::shared::RobotStatus;
use floorguard_types::geometry::Pose2;

use super::opening::{CleaningOffer, FleetOpening, kept_in};

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
    let FleetOpening { fleet, folder, .. } = &opening;
    let login = fleet.user.clone().map(|user| (user, std::env::var(PASSWORD_VARIABLE).unwrap_or_default()));
    let authority =
        fleet.authority.as_ref().map(|file| folder.map_or(file.clone(), |folder| folder.join(file)));
    let mqtt = if fleet.is_mqtt_5 { MqttVersion::V5 } else { MqttVersion::V3 };
    let broker = BrokerAddress { host: fleet.broker.clone(), port: fleet.port, authority, login, mqtt };
    let kept = folder.map(|folder| kept_in(folder, &fleet.serial));
    let link = FleetLink::open(describe(&opening), &broker, kept)
        .map_err(|error| BadInput(format!("[fleet]: {error}")))?;
    let encryption = if broker.authority.is_some() { "encrypted" } else { "not encrypted" };
    say!("  fleet: {} at {}:{}, {encryption}", fleet.serial, broker.host, broker.port);
    if let Err(why) = &opening.cleaning {
        say!("  fleet: cleans nothing on order: {why}");
    }
    Ok(Box::new(Joined::new(link, opening)))
}

pub(super) fn describe(opening: &FleetOpening<'_>) -> VehicleDescription {
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
        cleaning: match &opening.cleaning {
            Ok(CleaningOffer { tolerated_units, delta, .. }) => Cleaning::Offered(CleaningPromise {
                tolerated_units: *tolerated_units,
                // The risk is kept with seven digits.
                confidence: (1.0e6 * (1.0 - delta)).round() * 1.0e-6,
            }),
            Err(why) => Cleaning::Refused(why.clone()),
        },
    }
}

/// Who speaks for the robot in its fleet.
pub(super) trait FleetSide: Send {
    /// Shows the robot as it is now; gives what it is to do. It never waits.
    fn attend(&mut self, moment: VehicleMoment) -> Vec<VehicleCommand>;

    /// It lives by the clock on the wall.
    fn keeps_wall_time(&self) -> bool {
        true
    }
}

impl FleetSide for FleetLink {
    fn attend(&mut self, moment: VehicleMoment) -> Vec<VehicleCommand> {
        Self::attend(self, moment)
    }
}

/// The robot in its fleet.
pub(super) struct Joined<L> {
    pub(super) link: L,
    orders: DriveOrders,
    cleaning: Option<CleaningOrders>,
    next_us: u64,
}

impl<L: FleetSide> RunLink for Joined<L> {
    fn attend(&mut self, moment: &LinkMoment<'_>) -> Vec<Order> {
        let now_us = moment.now.as_micros();
        let Some(status) = moment.status.filter(|_| now_us >= self.next_us) else { return Vec::new() };
        self.next_us = now_us + SHOW_EVERY_US;
        let mut shown = shown(now_us, status, moment.drive.map(|drive| &**drive));
        shown.cleaning = self.cleaning.as_ref().and_then(CleaningOrders::status).map(cleaning_shown);
        let commands = self.link.attend(shown);
        commands.into_iter().filter_map(|command| self.carry_out(command)).collect()
    }

    fn keeps_wall_time(&self) -> bool {
        self.link.keeps_wall_time()
    }
}

impl<L> Joined<L> {
    pub(super) fn new(link: L, opening: FleetOpening<'_>) -> Self {
        let cleaning = opening.cleaning.ok().map(|offer| offer.orders);
        Self { link, orders: opening.orders, cleaning, next_us: 0 }
    }

    fn clean(&self, command: CleaningCommand) {
        if self.cleaning.as_ref().is_some_and(|orders| !orders.push(command)) {
            say!("  fleet: the robot takes no more orders to clean");
        }
    }

    /// A button, or an order to the drive.
    fn carry_out(&self, command: VehicleCommand) -> Option<Order> {
        let order = match command {
            VehicleCommand::Pause => return Some(Order::Pause),
            VehicleCommand::Resume => return Some(Order::Resume),
            VehicleCommand::Clean(place) => {
                self.clean(CleaningCommand::Clean(order_of(place)));
                return None;
            }
            VehicleCommand::EndCleaning => {
                self.clean(CleaningCommand::End);
                return None;
            }
            VehicleCommand::Stand => {
                self.clean(CleaningCommand::End);
                DriveOrder::Stand
            }
            VehicleCommand::Relocate(pose) => DriveOrder::Relocate(pose_in_map(pose)),
            VehicleCommand::Goto(place) => DriveOrder::Goto(goal_of(&place)),
        };
        if !self.orders.push(order) {
            say!("  fleet: the drive takes no more orders");
        }
        None
    }
}

fn goal_of(place: &OrderedPlace) -> OrderedGoal {
    let most = |limit: Option<f64>| limit.map_or(f32::INFINITY, |limit| limit as f32);
    OrderedGoal {
        number: place.number,
        goal_in_map: pose_in_map(place.pose),
        within_m: place.within_m as f32,
        within_rad: place.within_rad as f32,
        way: WayLimits { speed_mps: most(place.speed_max_mps), turn_radps: most(place.turn_max_radps) },
    }
}

fn order_of(place: CleaningPlace) -> CleaningOrder {
    CleaningOrder {
        number: place.number,
        corners_m: place.corners_m.iter().map(|[x_m, y_m]| [*x_m as f32, *y_m as f32]).collect(),
        tolerated_units: place.tolerated_units,
        delta: place.confidence.map(|confidence| 1.0 - confidence),
        goes_on: place.goes_on,
    }
}

fn cleaning_shown(status: CleaningStatus) -> CleaningMoment {
    CleaningMoment {
        number: status.number,
        stage: match status.stage {
            Stage::Cleaning => CleaningStage::Running,
            Stage::Done => CleaningStage::Finished,
            Stage::Failed(why) => CleaningStage::Failed(why),
        },
        words: status.counts.as_ref().map(CleaningCounts::words).unwrap_or_default(),
    }
}

fn pose_in_map(pose: VehiclePose) -> Pose2 {
    Pose2::new(pose.x_m as f32, pose.y_m as f32, pose.heading_rad as f32)
}

fn shown(now_us: u64, status: &RobotStatus, drive: Option<&NavigationProgress>) -> VehicleMoment {
    let twist = status.pose.twist;
    let cause = status.decision.holding_cause.map(|record| record.cause);
    let of =
        |phase: NavigationPhase| drive.filter(|drive| drive.phase == phase).map(|drive| drive.goal_number);
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
        cleaning: None,
    }
}

fn emergency_stop(state: GuardState, cause: Option<Cause>) -> EmergencyStop {
    let is_pressed = cause == Some(Cause::EmergencyStop);
    if is_pressed || state == GuardState::Latched { EmergencyStop::Manual } else { EmergencyStop::None }
}

/// Why the robot does not drive, where it is not its own will.
fn faults(status: &RobotStatus, drive: Option<&NavigationProgress>) -> Vec<VehicleFault> {
    let fault = |kind: &str, words: String, is_fatal| VehicleFault { kind: kind.to_owned(), words, is_fatal };
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
    let lost =
        lost.map(|_| fault("localizationError", "the pose does not explain what is seen".to_owned(), false));
    held.into_iter().chain(help).chain(lost).collect()
}

#[cfg(all(test, feature = "laboratory"))]
#[path = "joined_tests.rs"]
mod tests;
