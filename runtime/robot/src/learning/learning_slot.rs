//! Between the ring that learns and the thread that writes: the newest state, and the file that follows it.
//!
//! The ring never waits for a disk, and a disk that is full does not end the robot's work.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use floorguard_perception::online_learning::Weights;

use super::report::LearningReport;
use super::weights_file::save_weights;

/// The newest state of the learning.
#[derive(Clone, Debug, Default)]
pub struct LearningSlot(Arc<Mutex<Option<(LearningReport, Weights)>>>);

impl LearningSlot {
    /// Lays down the newest state.
    pub fn put(&self, report: LearningReport, weights: &Weights) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some((report, *weights));
    }

    /// The newest state; `None` before the first sweep.
    #[must_use]
    pub fn newest(&self) -> Option<(LearningReport, Weights)> {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Writes what was taken over.
#[derive(Clone, Debug)]
pub struct LearningWriter {
    slot: LearningSlot,
    path: Option<PathBuf>,
    anchors: u32,
    kept: Weights,
    is_failing: bool,
}

impl LearningWriter {
    /// Watches a slot. Without a path nothing is written. `anchors` is their fingerprint.
    pub(super) const fn new(
        slot: LearningSlot,
        path: Option<PathBuf>,
        (anchors, kept): (u32, Weights),
    ) -> Self {
        Self { slot, path, anchors, kept, is_failing: false }
    }

    /// Reads the slot, and saves a correction that was accepted since. Gives what there is to say about it.
    pub fn attend(&mut self) -> Option<String> {
        let (report, weights) = self.slot.newest()?;
        if weights == self.kept {
            return None;
        }
        self.kept = weights;
        let saved = self.path.as_ref().map(|path| save_weights(path, &weights, self.anchors));
        match saved {
            // Logged once: a full disk stays full.
            Some(Err(error)) if !self.is_failing => {
                self.is_failing = true;
                Some(format!(
                    "learning: what was learned cannot be kept: {error:#}; the robot goes on with it until it is switched off"
                ))
            }
            Some(Err(_)) => None,
            _ => {
                self.is_failing = false;
                Some(format!("learning: an update was taken over: {}", report.words()))
            }
        }
    }

    /// What was learned in all.
    #[must_use]
    pub fn report(&self) -> Option<LearningReport> {
        self.slot.newest().map(|(report, _)| report)
    }
}
