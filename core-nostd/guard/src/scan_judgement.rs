//! What a scan of either safety scanner says, and what follows from it.

use super::scan_check::ScanFinding;
use super::supervisor::Supervisor;
use crate::protection::{Cause, CauseRecord, Decision, FaultKind, Source, Unit};
use floorguard_types::sensing::Scan;
use floorguard_types::time::Stamp;

impl Supervisor {
    /// A scan of the second safety scanner, judged as those of the first one (FG-REQ-029).
    pub fn on_rear_scan(&mut self, scan: &Scan, now: Stamp) -> Decision {
        self.take_scan((Source::RearScanner, scan), now)
    }

    #[inline]
    pub(super) fn take_scan(&mut self, (source, scan): (Source, &Scan), now: Stamp) -> Decision {
        self.begin(now);
        self.accept(source, (scan.stamp, scan.sequence), now);
        let (table, repetition) = match (source, &self.rear[..]) {
            (Source::RearScanner, [rear, ..]) => (&rear.table, &rear.repetition),
            _ => (&self.scan_table, &self.contents.scanner),
        };
        let (is_frozen, fits) = (repetition.is_frozen, table.fits(scan));
        self.monitor(source, |monitor| monitor.repeats = is_frozen);
        if fits {
            self.judge_scan((source, scan), now);
        } else {
            self.fault(source, FaultKind::WrongGeometry);
        }
        self.decide(now)
    }

    /// Two adjacent beams in two consecutive scans stop (book, Guard: Scanner check); one scan holds back a larger
    /// field.
    fn judge_scan(&mut self, (source, scan): (Source, &Scan), now: Stamp) {
        let thresholds = self.config.thresholds;
        let how = (thresholds.scan_adjacent_beams, &self.body);
        let rear = (&self.rear[..], &mut self.state.rear_scans_with_hit[..]);
        let (table, scans_with_hit) = match (source, rear) {
            (Source::RearScanner, ([rear, ..], [scans, ..])) => (&rear.table, scans),
            _ => (&self.scan_table, &mut self.state.scans_with_hit),
        };
        let finding = table.check(scan, self.state.selection.active, how);
        let age_us = scan.stamp.past_us(now);
        *scans_with_hit = if finding.protective { scans_with_hit.saturating_add(1) } else { 0 };
        if *scans_with_hit >= thresholds.scan_consecutive {
            let record = CauseRecord::new(Cause::ScanProtective, now).aged(age_us);
            self.state.machine.raise(record.metres(finding.nearest_m, finding.nearest_limit_m));
        }
        if finding.warning {
            let record = CauseRecord::new(Cause::Warning, now).aged(age_us);
            self.state.machine.raise(record.limited_to(thresholds.warning_speed_mps));
        }
        if finding.is_blind() {
            self.state.machine.raise(blind_record(&finding, now).aged(age_us));
        }
        self.state.note_blocked(finding.blocked, now);
        if let Some(candidate) = self.state.selection.candidate {
            let ahead = table.check(scan, candidate, how);
            if ahead.protective || ahead.is_blind() {
                self.state.selection.candidate_blocked(now);
            }
        }
    }
}

fn blind_record(finding: &ScanFinding, now: Stamp) -> CauseRecord {
    let limit = super::scan_check::SILENT_PERCENT_MAX;
    CauseRecord::new(Cause::BlindSector, now).measured(finding.silent_percent, limit, Unit::Percent)
}
