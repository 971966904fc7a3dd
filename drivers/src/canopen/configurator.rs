//! Brings one node from power-up to operational, and again whenever it comes back.

use floorguard_types::time::{Age, Stamp};

use super::heartbeat::{HeartbeatMonitor, NodeState};
use super::network::{NetworkCommand, network_frame};
use super::script::Script;
use super::sdo::{SdoAnswer, SdoError, decode_sdo};
use crate::can::CanFrame;

/// A request is sent again after this silence, microseconds (500 to 1,000 ms are usual; book, CANopen: SDO).
const ANSWER_US: u64 = 500_000;
/// Requests for the same step before the node is given up for a while.
const TRIES_MAX: u8 = 3;
/// Pause before a node that refused is tried again, microseconds.
const PAUSE_US: u64 = 2_000_000;
/// Without a heartbeat for this long the node is lost, microseconds: three of 100 ms are missing. Half a period more
/// than three, or the jitter of the bus makes it two.
const HEARTBEAT_US: u64 = 350_000;
/// A silent node is asked to show itself this often, microseconds.
const CALL_US: u64 = 500_000;
/// After the start command the node must say so within this time, microseconds.
const START_US: u64 = 500_000;
/// Producer heartbeat time: 0 in a device that nobody has set up since it was switched on (CiA 301).
const HEARTBEAT_TIME: u16 = 0x1017;
/// Reads kept of a script.
const READS_KEPT: usize = 4;

/// How far a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodePhase {
    /// Not heard of.
    Absent,
    /// Being configured: this step.
    Configuring(usize),
    /// Commanded to start.
    Starting,
    /// Process data flow.
    Operational,
    /// It refused; tried again after a pause.
    Refused,
}

/// Why a node could not be configured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConfigurationFailure {
    /// Object.
    pub index: u16,
    /// Part of it.
    pub subindex: u8,
    /// Its reason; a time-out has the code of one.
    pub error: SdoError,
}

/// The state of one node.
#[derive(Clone, Debug)]
pub struct NodeConfigurator {
    node: u8,
    script: Script,
    phase: NodePhase,
    monitor: HeartbeatMonitor,
    /// When the last frame of this phase was sent.
    sent: Option<Stamp>,
    tries: u8,
    failure: Option<ConfigurationFailure>,
    reads: [u32; READS_KEPT],
    reads_done: usize,
    /// It left operation by itself; reported with the next poll.
    left: bool,
    /// It was heard of since this master runs: what it does now is this master's doing, or it has booted.
    met: bool,
}

impl NodeConfigurator {
    /// A node that was not heard of yet. The script must set its heartbeat (1017h).
    #[must_use]
    pub const fn new(node: u8, script: Script) -> Self {
        Self {
            node,
            script,
            phase: NodePhase::Absent,
            monitor: HeartbeatMonitor::NONE,
            sent: None,
            tries: 0,
            failure: None,
            reads: [0; READS_KEPT],
            reads_done: 0,
            left: false,
            met: false,
        }
    }

    /// Its number.
    #[must_use]
    pub const fn node(&self) -> u8 {
        self.node
    }

    /// How far it is.
    #[must_use]
    pub const fn phase(&self) -> NodePhase {
        self.phase
    }

    /// Process data flow.
    #[must_use]
    pub fn is_operational(&self) -> bool {
        self.phase == NodePhase::Operational
    }

    /// Why it refused last.
    #[must_use]
    pub const fn failure(&self) -> Option<ConfigurationFailure> {
        self.failure
    }

    /// The answer to the n-th read of the script.
    #[must_use]
    pub fn read(&self, number: usize) -> Option<u32> {
        self.reads.get(number).copied().filter(|_| number < self.reads_done)
    }

    /// A heartbeat or boot-up message of this node. True when a master that ran before this one has set it up: it is
    /// operational and this master has not started it, or the first that is heard of it is a heartbeat in another state, as
    /// after the loss of its master (CiA 301, object 1029h).
    pub fn on_heartbeat(&mut self, byte: u8, now: Stamp) -> bool {
        let Some(state) = NodeState::from_byte(byte) else { return false };
        let ours = matches!(self.phase, NodePhase::Starting | NodePhase::Operational);
        let first = !core::mem::replace(&mut self.met, true);
        let found = match state {
            NodeState::BootUp => false,
            NodeState::Operational => !ours,
            NodeState::Stopped | NodeState::PreOperational => first,
        };
        self.monitor.hear(state, now);
        match (self.phase, state) {
            (NodePhase::Starting, NodeState::Operational) => self.phase = NodePhase::Operational,
            (NodePhase::Absent, _) => self.begin(),
            // It restarted, or somebody else took it out of operation.
            (NodePhase::Operational, NodeState::BootUp | NodeState::PreOperational | NodeState::Stopped) => {
                self.left = true;
                self.begin();
            }
            // Whatever was written before is forgotten.
            (_, NodeState::BootUp) => self.begin(),
            _ => {}
        }
        found
    }

    /// An SDO answer of this node. True when it is the first that is heard of it, and tells that a master that ran before
    /// this one has set up its heartbeat.
    pub fn on_answer(&mut self, payload: &[u8], now: Stamp) -> bool {
        let Some((index, subindex, answer)) = decode_sdo(payload) else { return false };
        // An answer to the call: it is there, although it has no heartbeat yet.
        if self.phase == NodePhase::Absent {
            let first = !core::mem::replace(&mut self.met, true);
            self.monitor.hear(NodeState::PreOperational, now);
            self.begin();
            let is_set_up = matches!(answer, SdoAnswer::Value(period_ms) if period_ms != 0);
            return first && index == HEARTBEAT_TIME && is_set_up;
        }
        self.take_step((index, subindex), answer, now);
        false
    }

    /// The answer to a step of the script.
    fn take_step(&mut self, (index, subindex): (u16, u8), answer: SdoAnswer, now: Stamp) {
        let NodePhase::Configuring(step) = self.phase else { return };
        let Some(request) = self.script.step(step) else { return };
        if !request.is_answered_by(index, subindex) {
            return;
        }
        // Configuring shows that it lives, even before its heartbeat is set up.
        self.monitor.hear(NodeState::PreOperational, now);
        match (answer, request.write) {
            (SdoAnswer::Aborted(error), Some(_))
                if error.is_missing_object() && self.script.is_optional(step) => {}
            (SdoAnswer::Aborted(error), _) => {
                self.give_up(ConfigurationFailure { index, subindex, error }, now);
                return;
            }
            // No script reads text.
            (SdoAnswer::Segmented(_), None) => {
                let error = SdoError::TOO_LONG;
                self.give_up(ConfigurationFailure { index, subindex, error }, now);
                return;
            }
            (SdoAnswer::Value(value), None) => {
                if let Some(slot) = self.reads.get_mut(self.reads_done) {
                    *slot = value;
                    self.reads_done = self.reads_done.saturating_add(1);
                }
            }
            (SdoAnswer::Written, Some(_)) => {}
            // An answer to another kind of request, late from before: the time-out asks again.
            (SdoAnswer::Value(_) | SdoAnswer::Segmented(_), Some(_)) | (SdoAnswer::Written, None) => return,
        }
        let next = step.saturating_add(1);
        self.phase =
            if next < self.script.len() { NodePhase::Configuring(next) } else { NodePhase::Starting };
        self.sent = None;
        self.tries = 0;
    }

    /// Time has passed: sends what is due. True when the node was lost or left operation since the last call.
    pub fn poll(&mut self, now: Stamp, send: &mut impl FnMut(&CanFrame)) -> bool {
        let left = core::mem::take(&mut self.left);
        let waited_us = self.sent.map(|sent| match sent.age(now) {
            Age::Past(us) => us,
            Age::Future(_) => u64::MAX,
        });
        match self.phase {
            NodePhase::Absent if waited_us.is_none_or(|us| us >= CALL_US) => {
                send(
                    &super::sdo::SdoRequest { index: HEARTBEAT_TIME, subindex: 0, write: None }
                        .frame(self.node),
                );
                self.sent = Some(now);
            }
            NodePhase::Configuring(step) if waited_us.is_none_or(|us| us >= ANSWER_US) => {
                self.request(step, now, send);
            }
            NodePhase::Starting if waited_us.is_none_or(|us| us >= START_US) => {
                send(&network_frame(NetworkCommand::Start, self.node));
                self.sent = Some(now);
                self.tries = self.tries.saturating_add(1);
                if self.tries > TRIES_MAX {
                    self.forget();
                }
            }
            NodePhase::Operational if self.monitor.state(now, HEARTBEAT_US).is_none() => {
                self.forget();
                return true;
            }
            NodePhase::Refused if waited_us.is_none_or(|us| us >= PAUSE_US) => self.forget(),
            _ => {}
        }
        left
    }

    fn request(&mut self, step: usize, now: Stamp, send: &mut impl FnMut(&CanFrame)) {
        let Some(request) = self.script.step(step).copied() else {
            self.phase = NodePhase::Starting;
            return;
        };
        if self.tries >= TRIES_MAX {
            let error = SdoError::TIME_OUT;
            self.give_up(
                ConfigurationFailure { index: request.index, subindex: request.subindex, error },
                now,
            );
            return;
        }
        if step == 0 && self.tries == 0 {
            // A mapping can be written in this state only.
            send(&network_frame(NetworkCommand::PreOperational, self.node));
        }
        send(&request.frame(self.node));
        self.sent = Some(now);
        self.tries = self.tries.saturating_add(1);
    }

    fn begin(&mut self) {
        self.phase = NodePhase::Configuring(0);
        self.sent = None;
        self.tries = 0;
        self.reads_done = 0;
    }

    fn forget(&mut self) {
        self.monitor.forget();
        self.phase = NodePhase::Absent;
        self.sent = None;
        self.tries = 0;
    }

    fn give_up(&mut self, failure: ConfigurationFailure, now: Stamp) {
        self.failure = Some(failure);
        self.phase = NodePhase::Refused;
        self.sent = Some(now);
    }
}

#[cfg(test)]
#[path = "configurator_tests.rs"]
mod tests;
