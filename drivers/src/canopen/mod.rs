//! The part of CANopen (CiA 301) that a robot's master needs: network management, heartbeats, emergencies, expedited
//! SDO, process data mapping. Source: book, CANopen.
//!
//! A node that boots is configured step by step, then started:
//!
//! ```
//! use floorguard_drivers::canopen::{NodeConfigurator, NodePhase, Script};
//! use floorguard_types::time::Stamp;
//!
//! let mut node = NodeConfigurator::new(5, Script::new().write(0x1017, 0, 100, 2));
//! let mut sent = Vec::new();
//! node.on_heartbeat(0, Stamp::ZERO);
//! node.poll(Stamp::ZERO, &mut |frame| sent.push(*frame));
//! assert_eq!(sent.last().unwrap().payload(), [0x2B, 0x17, 0x10, 0, 100, 0, 0, 0]);
//! node.on_answer(&[0x60, 0x17, 0x10, 0, 0, 0, 0, 0], Stamp::from_micros(1_000));
//! node.poll(Stamp::from_micros(2_000), &mut |frame| sent.push(*frame));
//! assert_eq!(sent.last().unwrap().payload(), [1, 5]);
//! node.on_heartbeat(5, Stamp::from_micros(100_000));
//! assert_eq!(node.phase(), NodePhase::Operational);
//! ```

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
