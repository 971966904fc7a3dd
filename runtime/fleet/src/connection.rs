//! Whether the vehicle is there (VDA 5050 2.1.0, chapter 6.14), and the time that messages bear.

use jiff::Timestamp;

use super::messages::{Connection, Header};
use super::vehicle::VehicleDescription;

/// The vehicle is connected.
pub const ONLINE: &str = "ONLINE";
/// It has left in order.
pub const OFFLINE: &str = "OFFLINE";
/// The broker says so when it has gone.
pub const BROKEN: &str = "CONNECTIONBROKEN";

/// Now: UTC, ISO 8601, with milliseconds.
pub fn timestamp() -> String {
    Timestamp::now().strftime("%Y-%m-%dT%H:%M:%S.%3fZ").to_string()
}

/// A message of the topic `connection`.
pub fn connection(vehicle: &VehicleDescription, header_id: u32, connection_state: &'static str) -> String {
    let header = Header::of(vehicle, header_id, timestamp());
    serde_json::to_string(&Connection { header, connection_state }).unwrap_or_default()
}
