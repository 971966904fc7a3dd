//! The bridge before a scanner: one or more datagrams a scan (book, Scan link).

use floorguard_types::random::Pcg32;

use crate::robot::BridgedScans;
use crate::wire::{ScanNote, scan_link_datagrams};

/// From the last beam to the first datagram, microseconds: the device's own link, and the program.
const BRIDGE_US: u64 = 6_000;
/// From a datagram to the next one of its scan: they are written in one go.
const DATAGRAM_US: u64 = 125;

/// The bridge.
#[derive(Clone, Debug)]
pub(super) struct ScanBridge {
    scans: BridgedScans,
    clock_offset_us: u64,
    sender: u32,
}

impl ScanBridge {
    pub(super) fn new(scans: BridgedScans, random: &mut Pcg32) -> Self {
        let clock_offset_us = u64::from(random.below(3_000_000)) * 1_000;
        Self { scans, clock_offset_us, sender: random.below(u32::MAX) | 1 }
    }

    /// First angle and step, degrees.
    pub(super) fn angles_deg(&self) -> (f64, f64) {
        (f64::from(self.scans.first_udeg) * 1.0e-6, f64::from(self.scans.step_udeg) * 1.0e-6)
    }

    /// From scan to scan, microseconds.
    pub(super) fn period_us(&self) -> u64 {
        u64::from(self.scans.period_us)
    }

    /// What it sends of a scan that began at a time and ended now: metres, `None` where nothing came back.
    pub(super) fn send(
        &self,
        (scan, begun_us, now_us): (u32, u64, u64),
        between_ns: u64,
        ranges_m: impl Iterator<Item = Option<f32>>,
    ) -> Vec<(u64, Vec<u8>)> {
        let note = ScanNote {
            sender: self.sender,
            sequence: scan,
            first_beam_us: self.clock_offset_us + begun_us,
            angles_udeg: (self.scans.first_udeg, self.scans.step_udeg),
            between_ns: between_ns as i32,
        };
        let [nearest_mm, farthest_mm] = self.scans.range_mm.map(u32::from);
        let millimetres = |range_m: Option<f32>| {
            let range_mm = range_m.map_or(0, |range_m| (range_m * 1_000.0 + 0.5).max(0.0) as u32);
            if (nearest_mm..=farthest_mm).contains(&range_mm) { range_mm as u16 } else { 0 }
        };
        let ranges_mm: Vec<u16> = ranges_m.map(millimetres).collect();
        let arrives_us = (0..).map(|index| now_us + BRIDGE_US + index * DATAGRAM_US);
        arrives_us.zip(scan_link_datagrams(&note, &ranges_mm)).collect()
    }
}
