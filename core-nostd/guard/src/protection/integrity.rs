//! Are the guard's constants still what they were at start? Tables by a sum over each part, the rest by a second copy.
//!
//! The tables are too large to be kept twice or looked at in every tick, so one part of sixteen is examined in each: a
//! flipped bit is found within 160 ms. Each step of the sum is one-to-one in what was summed before, so that a single
//! changed word always changes it.

use super::collision::Body;
use super::config::GuardConfig;
use super::lidar_rays::LidarRays;
use super::packet_table::{BINS, Bin, PacketTable};
use super::rear_scanner::RearScanner;
use super::scan_table::ScanTable;
use floorguard_types::capacities::SCAN_BEAMS_MAX;
use floorguard_types::number::truncating_u32;

/// Parts of the tables.
pub const PARTS: usize = 16;
/// Odd, so that multiplying is one-to-one (the 32-bit FNV prime).
const FACTOR: u32 = 0x0100_0193;
const LANES: usize = 4;

/// What the constants were when the guard was built.
#[derive(Clone, Debug, PartialEq)]
pub struct Integrity {
    sums: [u32; PARTS],
    config: GuardConfig,
    body: Body,
    next: usize,
}

impl Integrity {
    /// Knows nothing: no tables have this sum.
    pub const NONE: Self = Self {
        sums: [0; PARTS],
        config: GuardConfig::NONE,
        body: Body { x_m: [0.0; 2], y_m: [0.0; 2] },
        next: 0,
    };

    /// Remembers them.
    pub fn remember(&mut self, config: &GuardConfig, body: Body, tables: Tables<'_>) {
        for (part, sum) in self.sums.iter_mut().enumerate() {
            *sum = sum_of(part, tables);
        }
        self.config.clone_from(config);
        (self.body, self.next) = (body, 0);
    }

    /// Checks the next part; `false` when something changed. The configuration is a part of its own.
    pub fn check_next(&mut self, config: &GuardConfig, body: Body, tables: Tables<'_>) -> bool {
        let part = self.next % PARTS;
        self.next = part.wrapping_add(1);
        let configured = part != 0 || (self.config == *config && self.body == body && is_of(tables, config));
        configured && self.sums.get(part).copied() == Some(sum_of(part, tables))
    }
}

/// Everything that is precomputed: the tables of the scanners, of the lidar's packets and rays.
type Tables<'a> = ((&'a ScanTable, &'a [RearScanner]), &'a PacketTable, &'a LidarRays);

/// The scanners' tables have the geometry that is configured.
fn is_of(((scan, rear), _, _): Tables<'_>, config: &GuardConfig) -> bool {
    let is_rear =
        |rear: &RearScanner| config.rear_scanner.is_none_or(|geometry| geometry == rear.table.geometry);
    config.scanner == scan.geometry && rear.iter().all(is_rear)
}

fn sum_of(part: usize, ((scan, rear), packet, rays): Tables<'_>) -> u32 {
    let mut sum = Sum(truncating_u32(part));
    sum.scan_table(part, scan);
    rear.iter().for_each(|rear| sum.scan_table(part, &rear.table));
    sum.add(packet.origin.x_m.to_bits());
    sum.add(packet.origin.y_m.to_bits());
    rays.words().for_each(|word| sum.add(word.to_bits()));
    sum.add(truncating_u32(rays.count));
    for bins in packet.bins.chunks(BINS.div_ceil(PARTS)).skip(part).take(1) {
        bins.iter().for_each(|bin| sum.bin(bin));
    }
    sum.0
}

#[derive(Clone, Copy)]
struct Sum(u32);

impl Sum {
    fn add(&mut self, word: u32) {
        self.0 = (self.0 ^ word).wrapping_mul(FACTOR).rotate_left(5);
    }

    /// In [`LANES`] sums side by side, of which none waits for another's multiplication: a changed word changes one of them.
    fn limits(&mut self, limits_mm: &[u16]) {
        let mut lanes = [Self(0); LANES];
        let (groups, rest) = limits_mm.as_chunks::<LANES>();
        for group in groups {
            lanes.iter_mut().zip(group).for_each(|(lane, limit_mm)| lane.add(u32::from(*limit_mm)));
        }
        rest.iter().for_each(|limit_mm| self.add(u32::from(*limit_mm)));
        lanes.iter().for_each(|lane| self.add(lane.0));
    }

    fn scan_table(&mut self, part: usize, scan: &ScanTable) {
        for limits in [&scan.protective, &scan.warning] {
            // Two parts for each set.
            let set = limits.iter().skip(part / 2).take(1);
            let half = set.flat_map(|beams| beams.chunks(SCAN_BEAMS_MAX.div_ceil(2)).skip(part % 2).take(1));
            half.for_each(|limits_mm| self.limits(limits_mm));
        }
        for directions in scan.directions.chunks(SCAN_BEAMS_MAX.div_ceil(PARTS)).skip(part).take(1) {
            for direction in directions {
                self.add(direction.x_m.to_bits());
                self.add(direction.y_m.to_bits());
            }
        }
        scan.watched.iter().for_each(|beams| self.add(u32::from(*beams)));
    }

    fn bin(&mut self, bin: &Bin) {
        self.add(bin.direction.x_m.to_bits());
        self.add(bin.direction.y_m.to_bits());
        for word in bin.plane_share.iter().chain(&bin.height_mm).chain(&bin.protective_mm) {
            self.add(u32::from(*word));
        }
        self.add(u32::from(bin.least_share) | (u32::from(bin.own_mm) << 16));
    }
}

#[cfg(test)]
mod tests {
    use super::{LANES, Sum};

    /// Whatever is left of a half beside whole groups counts, too: which is none on a computer, and two or three limits on a board.
    #[test]
    fn fg_req_017_each_limit_of_any_length_counts() {
        for length in 0..=3 * LANES {
            let limits_mm: std::vec::Vec<u16> = (1..).take(length).collect();
            let sum = |limits_mm: &[u16]| {
                let mut sum = Sum(7);
                sum.limits(limits_mm);
                sum.0
            };
            for at in 0..length {
                let mut changed = limits_mm.clone();
                changed[at] ^= 0x0400;
                assert_ne!(sum(&changed), sum(&limits_mm), "limit {at} of {length}");
            }
        }
    }
}
