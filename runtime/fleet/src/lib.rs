//! A robot in a fleet: VDA 5050, version 2.1, over MQTT.
//!
//! The agent and the orders know neither a network nor a clock: what comes in and what goes out are values. One thread speaks with
//! the broker. What happens while the broker is away waits on the disk, and goes out in its order when the broker is back.
//!
//! Source: VDA 5050, Interface for the communication between automated guided vehicles (AGV) and a master control, version 2.1.0;
//! chapters are named where they are followed.

#[macro_use]
extern crate floorguard_host;

mod agent;
mod broker;
mod cleaning;
mod connection;
mod factsheet;
mod instant;
mod messages;
mod mqtt;
mod order;
mod queue;
mod rules;
mod running;
mod vehicle;

pub use agent::FleetAgent;
pub use broker::FleetLink;
pub use messages::{Topic, Topics};
pub use mqtt::{BrokerAddress, MqttVersion, OpenError};
pub use vehicle::{
    Cleaning, CleaningMoment, CleaningPlace, CleaningPromise, CleaningStage, EmergencyStop, OrderedPlace,
    VehicleCommand, VehicleDescription, VehicleFault, VehicleMoment, VehiclePose,
};

#[cfg(test)]
mod tests;
