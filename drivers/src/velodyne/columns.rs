//! A packet as columns of the range image: what the guard and the sweep take.
//!
//! Of a dual return the nearer echo is kept: for a stop the near one counts, and behind glass or dust the far one is
//! no proof that the near one is nothing.
//!
//! Limit: the lasers of a VLP-32C look up to 4.2° beside the azimuth of their column; [`Model::ring_angles`] tells how
//! far. They are not moved to a neighbouring column.

use floorguard_core::capacities::PACKET_RINGS_MAX;
use floorguard_core::sensing::{LidarColumn, LidarPacket};
use floorguard_core::time::Stamp;
use heapless::Vec;

use super::model::{LaserAngles, Model};
use super::packet::{Block, Packet};

/// A column before its first return.
const NO_RETURN: LidarColumn = LidarColumn {
    azimuth_cdeg: 0,
    offset_us: 0,
    range_raw: [0; PACKET_RINGS_MAX],
    reflectivity: [0; PACKET_RINGS_MAX],
};

/// Converts packets of one model.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    model: Model,
    /// Ring of each laser.
    rings: [u8; PACKET_RINGS_MAX],
}

impl Columns {
    pub(super) fn new(model: Model, angles: &[LaserAngles; PACKET_RINGS_MAX]) -> Self {
        let mut rings = [0; PACKET_RINGS_MAX];
        for (ring, angle) in rings.iter_mut().zip(angles) {
            *ring = angle.ring;
        }
        Self { model, rings }
    }

    /// All columns of a packet; 12 to 24 in single, 6 to 12 in dual return.
    /// Returns nearer than `blind_range_mm` become unknown; their number comes second.
    pub(super) fn convert(
        &self,
        packet: &Packet<'_>,
        stamp: Stamp,
        blind_range_mm: u16,
    ) -> (LidarPacket, u32) {
        let mut columns = Vec::new();
        let blind_raw = blind_range_mm.div_ceil(u16::from(self.model.range_unit_mm().max(1)));
        let mut self_returns = 0;
        let gaps = packet.gaps();
        let step = if packet.is_dual() { 2 } else { 1 };
        let sequences = self.model.sequences_per_block();
        for (time_step, (index, block)) in packet.blocks().enumerate().step_by(step).enumerate() {
            let echo = if packet.is_dual() { packet.blocks().nth(index.saturating_add(1)) } else { None };
            let gap_cdeg = gaps.get(index).copied().unwrap_or(0);
            for sequence in 0..sequences.min(2) {
                let azimuth_cdeg = self.middle_azimuth(block.azimuth_cdeg, sequence, gap_cdeg);
                let mut column = LidarColumn { azimuth_cdeg, ..NO_RETURN };
                for block in [Some(block), echo].into_iter().flatten() {
                    self_returns += self.fill(&mut column, block, sequence, blind_raw);
                }
                let start_ns = (time_step as u32)
                    .saturating_mul(self.model.block_ns())
                    .saturating_add((sequence as u32).saturating_mul(self.model.sequence_ns()));
                // 12 blocks of two sequences are exactly the capacity.
                let _ = columns.push(LidarColumn { offset_us: start_ns / 1_000, ..column });
            }
        }
        let packet = LidarPacket {
            stamp,
            range_unit_mm: self.model.range_unit_mm(),
            rings: self.model.lasers() as u8,
            columns,
        };
        (packet, self_returns)
    }

    /// Enters the returns of one sequence that are not the robot itself; a nearer one replaces a farther one, so that
    /// an echo behind a self-return stays. Gives the number of self-returns, at most 32.
    fn fill(&self, column: &mut LidarColumn, block: Block<'_>, sequence: usize, blind_raw: u16) -> u32 {
        let lasers = self.model.lasers();
        let mut self_returns = 0;
        let cells = block.channels().skip(sequence * lasers).take(PACKET_RINGS_MAX);
        for ((raw, reflectivity), ring) in cells.zip(self.rings.iter().take(lasers)) {
            let ring = usize::from(*ring);
            let (Some(range), Some(brightness)) =
                (column.range_raw.get_mut(ring), column.reflectivity.get_mut(ring))
            else {
                continue;
            };
            if raw != 0 && raw < blind_raw {
                self_returns += 1;
            } else if raw != 0 && (*range == 0 || raw < *range) {
                (*range, *brightness) = (raw, reflectivity);
            }
        }
        self_returns
    }

    /// Azimuth at the middle laser of a sequence, rounded.
    fn middle_azimuth(&self, block_cdeg: u16, sequence: usize, gap_cdeg: u16) -> u16 {
        let middle_ns = self.model.laser_ns(self.model.lasers() - 1) / 2;
        let within_ns = (sequence as u32).saturating_mul(self.model.sequence_ns()).saturating_add(middle_ns);
        let block_ns = u64::from(self.model.block_ns().max(1));
        let turned = (u64::from(gap_cdeg) * u64::from(within_ns) + block_ns / 2) / block_ns;
        ((u64::from(block_cdeg) + turned) % 36_000) as u16
    }
}
