//! The part of CANopen (CiA 301) that a robot's master needs: network management, heartbeats, emergencies, expedited
//! SDO, process data mapping. Source: book, CANopen.

mod configurator;
mod emergency;
mod heartbeat;
mod network;
mod script;
mod sdo;

pub use configurator::{ConfigurationFailure, NodeConfigurator, NodePhase};
pub use emergency::Emergency;
pub use heartbeat::{HeartbeatMonitor, NodeState};
pub use network::{NetworkCommand, master_heartbeat, network_frame, sync_frame};
pub use script::{SCRIPT_STEPS_MAX, Script, Step};
pub use sdo::{SdoAnswer, SdoError, SdoRequest, decode_sdo};
