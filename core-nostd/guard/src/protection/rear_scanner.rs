//! A second safety scanner: its own table of the same fields, and what it sent before.

use super::config::{FieldSet, ScannerGeometry};
use super::content_watch::Repetition;
use super::local_memory::LocalMemory;
use super::scan_table::ScanTable;
use floorguard_types::sensing::Scan;

/// A second safety scanner, mounted as high as the first one: both clear what either has met (FG-REQ-029).
#[derive(Clone, Debug, PartialEq)]
pub struct RearScanner {
    /// Where its beams leave the fields.
    pub(crate) table: ScanTable,
    /// What it sent, and whether that stays the same while the robot moves.
    pub(crate) repetition: Repetition,
    scans: usize,
}

impl RearScanner {
    /// No beam is watched.
    pub const EMPTY: Self = Self { table: ScanTable::EMPTY, repetition: Repetition::NONE, scans: 0 };

    /// Precomputes the limits, in place; what it sent is forgotten. `None`: the robot has no second scanner.
    pub fn fill(&mut self, geometry: Option<&ScannerGeometry>, sets: &[FieldSet]) {
        (self.repetition, self.scans) = (Repetition::NONE, 0);
        match geometry {
            Some(geometry) => self.table.fill(geometry, sets),
            None => self.table.clone_from(&ScanTable::EMPTY),
        }
    }

    /// Takes a scan that fits its table into the memory, up to `reach_m` from the scanner, metres.
    pub fn remember(&mut self, scan: &Scan, (memory, reach_m): (&mut LocalMemory, f32)) {
        self.scans = self.scans.wrapping_add(1);
        memory.take_scan_of((scan, self.scans), &self.table, reach_m);
        self.repetition.see_scan(scan, memory.pose());
    }
}
