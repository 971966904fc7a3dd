//! Gives the robot the packets of a recorded lidar instead of the simulated ones.

use std::sync::Arc;

use floorguard_sim::{Payload, Stream, WireEvent};

use crate::plan::RecordedLidar;

/// How far a recorded lidar has been played; without one the simulated lidar is heard.
pub(super) struct LidarPlayback {
    recorded: Option<Arc<RecordedLidar>>,
    next: usize,
}

impl LidarPlayback {
    pub(super) const fn new(recorded: Option<Arc<RecordedLidar>>) -> Self {
        Self { recorded, next: 0 }
    }

    fn packet(&self) -> Option<&(u64, Vec<u8>)> {
        self.recorded.as_ref()?.packets.get(self.next)
    }

    /// When the next packet comes, microseconds.
    pub(super) fn next_us(&self) -> u64 {
        self.packet().map_or(u64::MAX, |(at_us, _)| *at_us)
    }

    /// The simulated lidar is not heard.
    pub(super) fn replaces(&self, event: &WireEvent) -> bool {
        self.recorded.is_some() && matches!(event.stream, Stream::LidarData | Stream::LidarPosition)
    }

    /// What has come up to now.
    pub(super) fn release(&mut self, now_us: u64, deliver: &mut impl FnMut(WireEvent)) {
        while let Some((at_us, bytes)) = self.packet().filter(|(at_us, _)| *at_us <= now_us) {
            let payload = Payload::Bytes(bytes.clone());
            deliver(WireEvent { at_us: *at_us, stream: Stream::LidarData, payload });
            self.next += 1;
        }
    }
}
