//! What the operator hears of a drive to a goal.

use floorguard_host::executor::StopFlag;
use floorguard_operator::telemetry::TelemetrySender;
use floorguard_robot::navigator::NavigationSetup;
use serde_json::json;

use super::watch::Watch;

/// A word on the drive comes this often, seconds.
const WORD_S: f64 = 5.0;

/// A drive that is watched.
pub(super) struct WatchedDrive {
    pub(super) setup: NavigationSetup,
    reported: u32,
    next_word_s: f64,
}

impl WatchedDrive {
    pub(super) const fn new(setup: NavigationSetup) -> Self {
        Self { setup, reported: 0, next_word_s: 0.0 }
    }
}

impl Watch<'_> {
    /// The drive has reported its progress; at its end the run ends.
    pub(super) fn on_drive(&mut self, flag: &StopFlag, notes: &TelemetrySender<'_>) {
        let elapsed_s = self.elapsed_s();
        let Some(drive) = &mut self.drive else { return };
        let reported = std::mem::replace(&mut drive.reported, drive.setup.watch.published());
        if reported == drive.reported {
            return;
        }
        let is_last = drive.setup.ends_run();
        let Some(progress) = drive.setup.watch.get() else { return };
        notes.navigation(&progress);
        if elapsed_s >= drive.next_word_s || (is_last && progress.phase.is_over()) {
            drive.next_word_s = elapsed_s + WORD_S;
            let line = json!({"type": "drive", "time_s": elapsed_s, "phase": progress.phase.name(),
                "text": progress.words, "left_m": progress.left_m, "distance_m": progress.distance_m});
            self.note_drive(&line, &progress.words);
        }
        if is_last && progress.phase.is_over() {
            flag.stop();
        }
    }
}
