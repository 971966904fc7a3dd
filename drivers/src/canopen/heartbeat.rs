//! Is a node alive, and in which state?

use floorguard_types::time::{Age, Stamp};

/// Network state of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeState {
    /// It has just started.
    BootUp,
    /// Process data stopped.
    Stopped,
    /// Process data flow.
    Operational,
    /// It can be configured.
    PreOperational,
}

impl NodeState {
    /// From the byte of a heartbeat; bit 7 is the toggle bit of the old node guarding.
    #[must_use]
    pub const fn from_byte(byte: u8) -> Option<Self> {
        match byte & 0x7F {
            0x00 => Some(Self::BootUp),
            0x04 => Some(Self::Stopped),
            0x05 => Some(Self::Operational),
            0x7F => Some(Self::PreOperational),
            _ => None,
        }
    }
}

/// Watches one node.
///
/// ```
/// use floorguard_drivers::canopen::{HeartbeatMonitor, NodeState};
/// use floorguard_types::time::Stamp;
///
/// let mut monitor = HeartbeatMonitor::NONE;
/// monitor.hear(NodeState::Operational, Stamp::from_micros(1_000_000));
/// let state_at = |micros| monitor.state(Stamp::from_micros(micros), 350_000);
/// assert_eq!(state_at(1_300_000), Some(NodeState::Operational));
/// assert_eq!(state_at(1_400_000), None);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct HeartbeatMonitor {
    heard: Option<(Stamp, NodeState)>,
}

impl HeartbeatMonitor {
    /// Nothing heard yet.
    pub const NONE: Self = Self { heard: None };

    /// A heartbeat arrived.
    pub const fn hear(&mut self, state: NodeState, now: Stamp) {
        self.heard = Some((now, state));
    }

    /// Forgets the node.
    pub const fn forget(&mut self) {
        self.heard = None;
    }

    /// The state, unless it is older than the time-out or from the future.
    #[must_use]
    pub fn state(&self, now: Stamp, time_out_us: u64) -> Option<NodeState> {
        let (at, state) = self.heard?;
        matches!(at.age(now), Age::Past(us) if us <= time_out_us).then_some(state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_and_clocks_that_ran_backwards_are_loss() {
        let at = Stamp::from_micros;
        let mut monitor = HeartbeatMonitor::default();
        assert_eq!(monitor.state(at(0), 300_000), None);
        monitor.hear(NodeState::Operational, at(1_000_000));
        assert_eq!(monitor.state(at(1_300_000), 300_000), Some(NodeState::Operational));
        assert_eq!(monitor.state(at(1_300_001), 300_000), None);
        assert_eq!(monitor.state(at(999_999), 300_000), None);
    }

    #[test]
    fn bytes_of_the_table() {
        let states = [0, 4, 5, 0x7F, 0x85, 3].map(NodeState::from_byte);
        use NodeState::{BootUp, Operational, PreOperational, Stopped};
        let expected =
            [Some(BootUp), Some(Stopped), Some(Operational), Some(PreOperational), Some(Operational), None];
        assert_eq!(states, expected);
    }
}
