//! The bridge to ROS 2, as a listener and a link of a run.

use floorguard_configuration::{CommandAddress, CommandConfiguration, DatagramAddress, SenderAddress};
use floorguard_guard::{Action, GuardState};
use floorguard_operator::panel::Order;
use floorguard_operator::telemetry::{LinkMoment, RunLink};
use floorguard_robot::navigator::{DriveOrder, DriveOrders, NavigationSettings, OrderedGoal, WayLimits};
use floorguard_ros2::{
    BridgeOptions, Restraint, RobotMoment, RosBridge, RosRequest, VelocityFeed, VelocityRoute,
};
use floorguard_runtime::shared::RobotStatus;
use floorguard_types::time::Stamp;

use super::{RosEnds, RosOpening};
use crate::commands::exit::BadInput;

/// The way of velocities to the guard, if they come from there.
pub type RosFeed = Option<(VelocityFeed, VelocityRoute)>;

/// Velocities of ROS 2 reach the guard as datagrams of the velocity link: its task listens on a port of the loopback, to the bridge
/// alone.
///
/// # Errors
/// The computer has no free port.
pub(crate) fn take_velocities(command: &mut Option<CommandConfiguration>) -> anyhow::Result<RosFeed> {
    let Some(configuration) = command else { return Ok(None) };
    let CommandAddress::Ros(topic) = &configuration.address else { return Ok(None) };
    let route = VelocityRoute { topic: topic.name.clone(), deadline_ms: topic.deadline_ms };
    let feed = VelocityFeed::open()?;
    let (local, bridge) = feed.addresses()?;
    let sender = Some(SenderAddress { address: bridge.ip(), port: Some(bridge.port()) });
    configuration.address = CommandAddress::Datagrams(DatagramAddress { local, sender });
    Ok(Some((feed, route)))
}

/// Opens the bridge.
///
/// # Errors
/// The domain's ports are taken, or its sockets cannot be kept on this computer.
pub(crate) fn open(opening: RosOpening) -> anyhow::Result<RosEnds> {
    let RosOpening { place, feed, orders } = opening;
    let topic = feed.as_ref().map(|(_, route)| route.topic.clone());
    let options = BridgeOptions { domain: place.domain, address: place.address, velocities: feed };
    let bridge = RosBridge::open(options).map_err(|error| BadInput(error.to_string()))?;
    let reach = match place.address {
        None => "on this computer alone".to_owned(),
        Some(address) => format!("at {address} and on every other network of this computer"),
    };
    say!(
        "  ROS 2: domain {}, {reach}; no DDS security: programs that reach it read everything and",
        place.domain
    );
    say!(
        "    may pause, resume and reset{}",
        if orders.is_some() { ", and send the robot to places" } else { "" }
    );
    if let Some(topic) = topic {
        say!("    velocities come from {topic}; the first writer holds the robot");
    }
    Ok((bridge.listener(), Box::new(Bridged { bridge, orders, goals: 0 })))
}

/// The robot in ROS 2.
struct Bridged {
    bridge: RosBridge,
    orders: Option<(DriveOrders, NavigationSettings)>,
    goals: u32,
}

impl RunLink for Bridged {
    fn attend(&mut self, moment: &LinkMoment<'_>) -> Vec<Order> {
        let shown = || moment.status.map(|status| shown(moment.now, status));
        let requests = self.bridge.attend(moment.now.as_micros(), shown);
        requests.into_iter().filter_map(|request| self.carry_out(request)).collect()
    }
}

impl Bridged {
    /// A button, or an order to the drive.
    fn carry_out(&mut self, request: RosRequest) -> Option<Order> {
        let place = match request {
            RosRequest::Pause => return Some(Order::Pause),
            RosRequest::Resume => return Some(Order::Resume),
            RosRequest::Reset => return Some(Order::Reset),
            RosRequest::Goal(place) | RosRequest::Relocate(place) => place,
        };
        let Some((orders, settings)) = &self.orders else {
            say!("  ROS 2: a place on the map came, and this robot drives to none");
            return None;
        };
        let order = if matches!(request, RosRequest::Goal(_)) {
            self.goals = self.goals.wrapping_add(1);
            let NavigationSettings { within_m, within_rad, .. } = *settings;
            let way = WayLimits::NONE;
            DriveOrder::Goto(OrderedGoal {
                number: self.goals,
                goal_in_map: place,
                within_m,
                within_rad,
                way,
            })
        } else {
            DriveOrder::Relocate(place)
        };
        if !orders.push(order) {
            say!("  ROS 2: the drive takes no more orders");
        }
        None
    }
}

impl Drop for Bridged {
    fn drop(&mut self) {
        say!("  ROS 2: {}", self.bridge.figures());
    }
}

/// What the guard does, for nav2.
fn shown(at: Stamp, status: &RobotStatus) -> RobotMoment {
    let decision = &status.decision;
    let waits = matches!(decision.state, GuardState::Init | GuardState::AwaitsStart);
    let restraint = match decision.action {
        action if action.stops() || waits => Restraint::Stops,
        Action::None => Restraint::None,
        _ => Restraint::Slows,
    };
    let cause = decision.holding_cause.filter(|_| restraint != Restraint::None);
    let cause = cause.map(|record| record.cause.to_string()).unwrap_or_default();
    RobotMoment { at, restraint, cause, limit_mps: decision.speed_limit_mps }
}
