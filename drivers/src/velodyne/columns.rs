//! A packet as columns of the range image: what the guard and the sweep take.
//!
//! Of a dual return the nearer echo is kept: for a stop the near one counts, and behind glass or dust the far one is
//! no proof that the near one is nothing.
//!
//! Limit: the lasers of a VLP-32C look up to 4.2° beside the azimuth of their column; [`Model::ring_angles`] tells how
//! far. They are not moved to a neighbouring column.

use floorguard_types::number::{exact_usize, truncating_u8, truncating_u16, truncating_u32};
use floorguard_types::profile::{Entry, Profile, Table, TableOf};
use floorguard_types::sensing::{LidarColumnOf, LidarPacketOf};
use floorguard_types::time::Stamp;

use super::model::{LaserAngles, Model};
use super::packet::{BLOCKS, Block, BlockTurn, Packet};

/// Lasers of the largest model.
const LASERS_MAX: u32 = 32;

/// Converts packets of one model.
#[derive(Clone, Debug)]
pub(super) struct Columns<P: Profile> {
    model: Model,
    /// Ring of each laser.
    rings: TableOf<u8, P::Rings>,
    /// The same once more (FG-REQ-058).
    copy: TableOf<u8, P::Rings>,
}

impl<P: Profile> Columns<P> {
    pub(super) fn new(model: Model, angles: &TableOf<LaserAngles, P::Rings>) -> Self {
        let mut rings = <TableOf<u8, P::Rings>>::BLANK;
        for (ring, angle) in rings.iter_mut().zip(angles.iter()) {
            *ring = angle.ring;
        }
        Self { model, copy: rings, rings }
    }

    /// The model, and the ring of one laser, are what they were when the model was decided: another laser with each number.
    pub(super) fn is_whole(&self, model: Model, number: u32) -> bool {
        let laser = exact_usize(number % LASERS_MAX);
        self.model == model && self.rings.as_ref().get(laser) == self.copy.as_ref().get(laser)
    }

    /// Writes the columns of all blocks whose direction is known: up to 24 in single, 12 in dual return. Returns nearer
    /// than `blind_range_mm` become unknown; gives their number. What follows a closed sector was fired `skipped_us`
    /// later.
    // Not inlined: its frame is gone when the guard judges the packet.
    #[inline(never)]
    pub(super) fn convert(
        &self,
        (packet, turns): (&Packet<'_>, &[BlockTurn; BLOCKS]),
        ((stamp, skipped_us), blind_range_mm): ((Stamp, u32), u16),
        out: &mut LidarPacketOf<P>,
    ) -> u32 {
        let blind_raw = blind_range_mm.div_ceil(u16::from(self.model.range_unit_mm().max(1)));
        let sequences = self.model.sequences_per_block().clamp(1, 2);
        let step = if packet.is_dual() { 2 } else { 1 };
        out.stamp = stamp;
        out.range_unit_mm = self.model.range_unit_mm();
        out.rings = truncating_u8(self.model.lasers());
        let known = turns.iter().step_by(step).filter(|turn| turn.azimuth_cdeg.is_some()).count();
        // 12 blocks of two sequences are exactly the capacity.
        let _ = out.columns.resize(known * sequences, LidarColumnOf::SILENT);
        let blocks = packet.blocks().zip(turns).step_by(step);
        // The second blocks of the pairs.
        let mut echoes = packet.blocks().skip(1).step_by(step);
        let mut columns = out.columns.iter_mut();
        let mut self_returns = 0;
        let mut later_us = 0;
        for (time_step, (block, turn)) in blocks.enumerate() {
            let echo = if packet.is_dual() { echoes.next() } else { None };
            let Some(block_cdeg) = turn.azimuth_cdeg else { continue };
            if turn.skipped_cdeg > 0 {
                later_us = skipped_us;
            }
            for (sequence, column) in columns.by_ref().take(sequences).enumerate() {
                *column = LidarColumnOf::SILENT;
                column.azimuth_cdeg = self.middle_azimuth(block_cdeg, sequence, turn.gap_cdeg);
                let start_ns = truncating_u32(time_step)
                    .saturating_mul(self.model.block_ns())
                    .saturating_add(truncating_u32(sequence).saturating_mul(self.model.sequence_ns()));
                column.offset_us = (start_ns / 1_000).saturating_add(later_us);
                self_returns += self.enter(column, block, sequence, blind_raw);
                if let Some(echo) = echo {
                    self_returns += self.enter_nearer(column, echo, sequence, blind_raw);
                }
            }
        }
        self_returns
    }

    /// Enters the returns of one sequence that are not the robot itself into a column in which nothing is. Gives the number
    /// of self-returns, at most 32.
    fn enter(&self, column: &mut LidarColumnOf<P>, block: Block<'_>, sequence: usize, blind_raw: u16) -> u32 {
        let lasers = self.model.lasers();
        let known_raw = blind_raw.max(1);
        let mut self_returns = 0;
        // Every model has a multiple of eight lasers: the board pays for the loop once in eight cells.
        let (cells, _) = block.cells(sequence * lasers, lasers).as_chunks::<8>();
        let (rings, _) = self.rings.as_ref().as_chunks::<8>();
        for (cells, rings) in cells.iter().zip(rings) {
            for ([low, high, reflectivity], ring) in cells.iter().zip(rings) {
                let raw = u16::from_le_bytes([*low, *high]);
                if raw < known_raw {
                    self_returns += u32::from(raw != 0);
                    continue;
                }
                let ring = usize::from(*ring);
                let Some(range) = column.range_raw.get_mut(ring) else { continue };
                *range = raw;
                if let Some(brightness) = column.reflectivity.get_mut(ring) {
                    *brightness = *reflectivity;
                }
            }
        }
        self_returns
    }

    /// The same for the second echo: a nearer one replaces a farther one, so that an echo behind a self-return stays.
    fn enter_nearer(
        &self,
        column: &mut LidarColumnOf<P>,
        block: Block<'_>,
        sequence: usize,
        blind_raw: u16,
    ) -> u32 {
        let lasers = self.model.lasers();
        let mut self_returns = 0;
        let cells = block.cells(sequence * lasers, lasers);
        for ([low, high, reflectivity], ring) in cells.iter().zip(self.rings.iter()) {
            let raw = u16::from_le_bytes([*low, *high]);
            if raw == 0 {
                continue;
            }
            let ring = usize::from(*ring);
            let Some(range) = column.range_raw.get_mut(ring) else { continue };
            if raw < blind_raw {
                self_returns += 1;
            } else if raw <= range.wrapping_sub(1) {
                // Nothing yet, 0, wraps round to the greatest number.
                *range = raw;
                if let Some(brightness) = column.reflectivity.get_mut(ring) {
                    *brightness = *reflectivity;
                }
            }
        }
        self_returns
    }

    /// Azimuth at the middle laser of a sequence, rounded.
    fn middle_azimuth(&self, block_cdeg: u16, sequence: usize, gap_cdeg: u16) -> u16 {
        let middle_ns = self.model.laser_ns(self.model.lasers() - 1) / 2;
        let within_ns =
            truncating_u32(sequence).saturating_mul(self.model.sequence_ns()).saturating_add(middle_ns);
        let block_ns = self.model.block_ns().max(1);
        // At most 36,000 times 73 us: fits.
        let turned = u32::from(gap_cdeg).saturating_mul(within_ns).saturating_add(block_ns / 2) / block_ns;
        truncating_u16(u32::from(block_cdeg).saturating_add(turned) % 36_000)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fg_req_058_flipped_ring_is_noticed() {
        let columns = Columns::<floorguard_types::profile::Native>::new(Model::Vlp16, &Model::Vlp16.angles());
        let is_noticed = |columns: &Columns<_>| (0..32).any(|number| !columns.is_whole(Model::Vlp16, number));
        assert!(!is_noticed(&columns));
        for laser in 0..16 {
            for bit in 0..8 {
                let mut flipped = columns.clone();
                flipped.rings.as_mut()[laser] ^= 1 << bit;
                assert!(is_noticed(&flipped), "laser {laser} bit {bit}");
            }
        }
        assert!(is_noticed(&Columns { model: Model::HiRes, ..columns }));
    }

    #[test]
    fn column_azimuth_is_the_middle_lasers_rounded() {
        let columns = Columns::<floorguard_types::profile::Native>::new(Model::Vlp16, &Model::Vlp16.angles());
        // Of a block of 110.592 us the eighth firing ends after 17.28, that of the second sequence 55.296 later.
        assert_eq!(columns.middle_azimuth(1_000, 0, 40), 1_006, "6.25");
        assert_eq!(columns.middle_azimuth(1_000, 1, 40), 1_026, "26.25");
        assert_eq!(columns.middle_azimuth(1_000, 0, 44), 1_007, "6.875");
        assert_eq!(columns.middle_azimuth(35_995, 0, 40), 1, "over the turn");
    }
}
