//! Topics and the header that each message has (chapters 6.3 and 6.4).

use serde::{Deserialize, Serialize};

use super::VERSION;
use crate::vehicle::VehicleDescription;

/// Kinds of messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub enum Topic {
    /// To the vehicle: where to drive.
    Order,
    /// To the vehicle: what to do at once.
    InstantActions,
    /// From the vehicle: how it is.
    State,
    /// From the vehicle, often: where it is.
    Visualization,
    /// From the vehicle, kept by the broker: whether it is there.
    Connection,
    /// From the vehicle, on request: what it is.
    Factsheet,
}

impl Topic {
    /// Its last level.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Order => "order",
            Self::InstantActions => "instantActions",
            Self::State => "state",
            Self::Visualization => "visualization",
            Self::Connection => "connection",
            Self::Factsheet => "factsheet",
        }
    }
}

/// The topics of a vehicle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topics(String);

impl Topics {
    /// Those of a vehicle: `interface/v2/manufacturer/serial/…`.
    #[must_use]
    pub fn of(vehicle: &VehicleDescription) -> Self {
        let VehicleDescription { interface, manufacturer, serial, .. } = vehicle;
        Self(format!("{interface}/v2/{manufacturer}/{serial}"))
    }

    /// The whole name of one.
    #[must_use]
    pub fn full(&self, topic: Topic) -> String {
        format!("{}/{}", self.0, topic.name())
    }

    /// Which one a name is, of those to the vehicle.
    #[must_use]
    pub fn incoming(&self, name: &str) -> Option<Topic> {
        [Topic::Order, Topic::InstantActions].into_iter().find(|topic| self.full(*topic) == name)
    }
}

/// What each message begins with.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Header {
    /// Counts the messages of a topic.
    pub header_id: u32,
    /// UTC, ISO 8601.
    pub timestamp: String,
    /// Of the standard.
    pub version: String,
    /// Of the vehicle.
    pub manufacturer: String,
    /// Of the vehicle.
    pub serial_number: String,
}

impl Header {
    /// The header of a vehicle's message.
    pub fn of(vehicle: &VehicleDescription, header_id: u32, timestamp: String) -> Self {
        Self {
            header_id,
            timestamp,
            version: VERSION.to_owned(),
            manufacturer: vehicle.manufacturer.clone(),
            serial_number: vehicle.serial.clone(),
        }
    }
}
