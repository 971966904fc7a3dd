//! Messages of the standard, with its field names (VDA 5050 2.1.0, chapter 6 and its JSON schemas).

mod incoming;
mod outgoing;
mod topics;

pub use incoming::{Action, InstantActions, Node, Order, OrderEdge};
pub use outgoing::{
    ActionState, AgvPosition, BatteryState, Connection, EdgeState, Information, MapState, NodeState,
    Reference, Report, SafetyState, State, Velocity, Visualization,
};
pub use topics::{Header, Topic, Topics};

/// Version of the standard, as each message names it.
pub const VERSION: &str = "2.1.0";
