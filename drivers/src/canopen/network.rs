//! Frames that the master sends to all.

use crate::can::CanFrame;

/// The state that a node is commanded to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkCommand {
    /// Process data flow.
    Start,
    /// Heartbeat only.
    Stop,
    /// Configuration.
    PreOperational,
    /// Restart the whole device.
    ResetNode,
    /// Restart its communication.
    ResetCommunication,
}

/// NMT: `node` 0 addresses all.
///
/// ```
/// use floorguard_drivers::can::CanFrame;
/// use floorguard_drivers::canopen::{NetworkCommand, network_frame, sync_frame};
///
/// assert_eq!(network_frame(NetworkCommand::Start, 5), CanFrame::standard(0x000, &[1, 5]));
/// assert_eq!(sync_frame(), CanFrame::standard(0x080, &[]));
/// ```
#[must_use]
pub fn network_frame(command: NetworkCommand, node: u8) -> CanFrame {
    let code = match command {
        NetworkCommand::Start => 0x01,
        NetworkCommand::Stop => 0x02,
        NetworkCommand::PreOperational => 0x80,
        NetworkCommand::ResetNode => 0x81,
        NetworkCommand::ResetCommunication => 0x82,
    };
    CanFrame::standard(0x000, &[code, node])
}

/// SYNC without a counter.
#[must_use]
pub fn sync_frame() -> CanFrame {
    CanFrame::standard(0x080, &[])
}

/// The master's own heartbeat, operational.
#[must_use]
pub fn master_heartbeat(node: u8) -> CanFrame {
    CanFrame::standard(0x700 | u16::from(node & 0x7F), &[5])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_vectors() {
        assert_eq!(network_frame(NetworkCommand::Start, 0), CanFrame::standard(0, &[1, 0]));
        assert_eq!(network_frame(NetworkCommand::PreOperational, 5), CanFrame::standard(0, &[0x80, 5]));
        assert_eq!(sync_frame(), CanFrame::standard(0x80, &[]));
        assert_eq!(master_heartbeat(5), CanFrame::standard(0x705, &[5]));
        assert_eq!(master_heartbeat(0xFF), CanFrame::standard(0x77F, &[5]));
    }
}
