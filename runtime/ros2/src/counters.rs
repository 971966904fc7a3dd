//! What went through the bridge, counted.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

/// What went over the bridge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BridgeFigures {
    /// Messages that were given to DDS.
    pub sent: u64,
    /// Messages that did not fit the queue.
    pub dropped: u64,
    /// Messages that DDS did not take in time.
    pub refused: u64,
    /// Velocities, places and services that came.
    pub received: u64,
    /// Those that cannot be read, are in another frame than the map's, or are too many.
    pub not_understood: u64,
}

impl BridgeFigures {
    /// Each with its name.
    pub(crate) const fn named(&self) -> [(&'static str, u64); 5] {
        [
            ("sent", self.sent),
            ("dropped", self.dropped),
            ("refused by DDS", self.refused),
            ("received", self.received),
            ("not understood", self.not_understood),
        ]
    }
}

impl fmt::Display for BridgeFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = self.named().map(|(name, value)| format!("{value} {name}"));
        f.write_str(&words.join(", "))
    }
}

/// The same while it runs.
#[derive(Debug, Default)]
pub struct Counters {
    /// Messages that were given to DDS.
    pub sent: AtomicU64,
    /// Messages for which the queue was full.
    pub dropped: AtomicU64,
    /// Messages that DDS did not take in time.
    pub refused: AtomicU64,
    /// Velocities, places and services that came.
    pub received: AtomicU64,
    /// Those that are of no use.
    pub not_understood: AtomicU64,
}

impl Counters {
    /// What they show now.
    pub fn figures(&self) -> BridgeFigures {
        let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        BridgeFigures {
            sent: read(&self.sent),
            dropped: read(&self.dropped),
            refused: read(&self.refused),
            received: read(&self.received),
            not_understood: read(&self.not_understood),
        }
    }
}
