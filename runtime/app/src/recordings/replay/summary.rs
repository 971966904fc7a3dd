//! The last line of a replay, for people.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use floorguard_host::words::counted;

/// Counts while a file is played.
pub struct Summary {
    /// Sweeps or scans so far.
    pub frames: u64,
    /// Legs so far.
    pub legs: u64,
    identities: BTreeSet<u32>,
    most: usize,
    started: Instant,
}

impl Summary {
    /// Nothing yet.
    pub fn new() -> Self {
        Self { frames: 0, legs: 0, identities: BTreeSet::new(), most: 0, started: Instant::now() }
    }

    /// The people of one frame.
    pub fn people(&mut self, ids: impl Iterator<Item = u32>) {
        let before = self.frames;
        let mut now = 0;
        for id in ids {
            self.identities.insert(id);
            now += 1;
        }
        self.frames = before + 1;
        self.most = self.most.max(now);
    }

    /// In words; `what` is one of them.
    pub fn line(&self, what: &str) -> String {
        let took: Duration = self.started.elapsed();
        let per_frame_ms = took.as_secs_f64() * 1.0e3 / self.frames.max(1) as f64;
        let legs = match self.legs {
            0 => String::new(),
            legs => format!(" {},", counted(legs, "leg")),
        };
        format!(
            "{}:{legs} {} in all, at most {} at once; {per_frame_ms:.2} ms each",
            counted(self.frames, what),
            counted(self.identities.len() as u64, "person"),
            self.most
        )
    }
}
