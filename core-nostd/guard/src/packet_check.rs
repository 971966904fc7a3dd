//! Lidar packet against the protective field: two comparisons and one product per return, decided within the packet.

use crate::protection::{BIN_CDEG, Bin, Blocked, Body, PacketTable};
use floorguard_types::capacities::PACKET_RINGS_MAX;
use floorguard_types::geometry::Point2;
use floorguard_types::number::nearest_f32;
use floorguard_types::sensing::{LidarColumn, LidarPacket};

/// Azimuth over which a lidar may return nothing at all before it counts as blind, hundredths of a degree: a wall of
/// black glass is narrower, a covered window is wider (FG-REQ-016).
pub const BLIND_RUN_CDEG: u32 = 3_000;

const _: () = assert!(PACKET_RINGS_MAX.is_multiple_of(4));

/// What one packet says about one field set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PacketFinding {
    /// Returns inside the protective field.
    pub returns: u8,
    /// Least distance of those in the plane, metres.
    pub nearest_m: f32,
    /// Reach of the field there, metres.
    pub nearest_limit_m: f32,
    /// Where the robot must not go.
    pub blocked: Blocked,
}

impl PacketTable {
    /// Compares each return with the limits of a set (FG-REQ-023).
    #[must_use]
    pub fn check(&self, packet: &LidarPacket, set: usize, body: &Body) -> PacketFinding {
        let mut finding = PacketFinding { nearest_m: f32::INFINITY, ..PacketFinding::default() };
        let unit_mm = u32::from(packet.range_unit_mm);
        for column in &packet.columns {
            if let Some(bin) = self.bins.get(usize::from(column.azimuth_cdeg / BIN_CDEG)) {
                self.check_column(&mut finding, (column, bin), (set, unit_mm, body));
            }
        }
        finding
    }

    fn check_column(
        &self,
        finding: &mut PacketFinding,
        (column, bin): (&LidarColumn, &Bin),
        (set, unit_mm, body): (usize, u32, &Body),
    ) {
        let reach_mm = u32::from(bin.protective_mm.get(set).copied().unwrap_or(u16::MAX));
        let own_mm = u32::from(bin.own_mm);
        // A return that far lies beyond the field at any elevation; no return, 0, wraps round to far.
        let beyond_mm = reach_mm.wrapping_shl(16).checked_div(u32::from(bin.least_share)).unwrap_or(u32::MAX);
        let beyond_raw = beyond_mm.checked_div(unit_mm).unwrap_or(u32::MAX).saturating_add(1);
        // In fours, because most returns are far, and the board pays for a turn of the loop.
        let (fours, _) = column.range_raw.as_chunks::<4>();
        for (turn, four) in fours.iter().enumerate() {
            if four.iter().all(|raw| u32::from(raw.wrapping_sub(1)) >= beyond_raw) {
                continue;
            }
            for (within, raw) in four.iter().enumerate() {
                let ring = turn.wrapping_mul(4).wrapping_add(within);
                let (share, height_mm) = (bin.plane_share.get(ring), bin.height_mm.get(ring));
                let (Some(share), Some(height_mm)) = (share, height_mm) else { continue };
                let range_mm = u32::from(*raw).saturating_mul(unit_mm);
                let plane_mm = range_mm.saturating_mul(u32::from(*share)) >> 16;
                let below_and_above = *raw != 0 && range_mm < u32::from(*height_mm);
                if below_and_above && plane_mm < reach_mm && plane_mm >= own_mm {
                    self.note_return(finding, (plane_mm, reach_mm), (bin, body));
                }
            }
        }
    }

    fn note_return(
        &self,
        finding: &mut PacketFinding,
        (plane_mm, reach_mm): (u32, u32),
        (bin, body): (&Bin, &Body),
    ) {
        finding.returns = finding.returns.saturating_add(1);
        let plane_m = nearest_f32(plane_mm) * 1.0e-3;
        if plane_m < finding.nearest_m {
            finding.nearest_m = plane_m;
            finding.nearest_limit_m = nearest_f32(reach_mm) * 1.0e-3;
        }
        let x_m = self.origin.x_m + plane_m * bin.direction.x_m;
        let y_m = self.origin.y_m + plane_m * bin.direction.y_m;
        finding.blocked.add(Point2::new(x_m, y_m), body);
    }
}
