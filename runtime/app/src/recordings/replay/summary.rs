//! The last line of a replay, for people.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use super::rows::FrameRow;
use floorguard_host::words::counted;

/// Counts while a file is played.
pub struct Summary {
    /// Sweeps or scans so far.
    pub frames: u64,
    /// Legs so far.
    pub legs: u64,
    /// Not later than the one before.
    standing: u64,
    identities: BTreeSet<u32>,
    most: usize,
    started: Instant,
}

impl Summary {
    /// Nothing yet.
    pub fn new() -> Self {
        Self {
            frames: 0,
            legs: 0,
            standing: 0,
            identities: BTreeSet::new(),
            most: 0,
            started: Instant::now(),
        }
    }

    /// A sweep or scan, and the people in it.
    pub fn frame(&mut self, row: &FrameRow) {
        self.frames += 1;
        self.legs += row.legs() as u64;
        self.standing += u64::from(!row.is_newer());
        self.most = self.most.max(row.people().count());
        self.identities.extend(row.people());
    }

    /// Says it where times do not grow.
    pub fn say_standing(&self, what: &str) {
        let Self { standing, frames, .. } = *self;
        if standing > 0 && standing + 1 == frames {
            say!(
                "all {frames} {what}s bear one time: speeds, who stands and who walks cannot be known from this recording"
            );
        } else if standing > 0 {
            say!(
                "{standing} of {frames} {what}s are not later than the one before them, and were not used for tracking"
            );
        }
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
