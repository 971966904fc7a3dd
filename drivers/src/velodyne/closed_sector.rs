//! The sector that a lidar leaves out because it is set to a field of view.
//!
//! The wire says nothing about it. It shows as a jump of the azimuth from one block of a packet to the next, and where
//! the edge falls between two packets, as silence at the same place in every turn. Time passes meanwhile: packets of the
//! closed sector are not lost, and what follows the jump was fired later.

use floorguard_types::number::truncating_u16;

use super::packet::{BLOCKS, BlockTurn};

const TURN_CDEG: u32 = 36_000;
/// Silence between packets is a closed sector only if it is as wide as this, hundredths of a degree, …
const SILENCE_MIN_CDEG: u32 = 1_000;
/// … and its edges are the same as a turn before to two blocks at 600 rpm.
const EDGE_CDEG: u32 = 80;

/// A closed sector: clockwise from one azimuth to another, hundredths of a degree, 0…35,999.
///
/// ```
/// use floorguard_drivers::velodyne::ClosedSector;
///
/// let behind = ClosedSector { from_cdeg: 4_100, until_cdeg: 32_000 };
/// assert_eq!((behind.width_cdeg(), behind.open_cdeg()), (27_900, 8_100));
/// assert_eq!(behind.to_string(), "41.0° to 320.0° is closed: 81.0° of 360° are seen");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ClosedSector {
    /// Where the last block before it ended.
    pub from_cdeg: u16,
    /// Where the first block after it began.
    pub until_cdeg: u16,
}

impl ClosedSector {
    /// Its width, hundredths of a degree.
    #[must_use]
    pub fn width_cdeg(&self) -> u32 {
        turned_cdeg(self.from_cdeg, self.until_cdeg)
    }

    /// What is seen of a turn, hundredths of a degree.
    #[must_use]
    pub fn open_cdeg(&self) -> u32 {
        TURN_CDEG.saturating_sub(self.width_cdeg())
    }

    fn is_like(&self, other: &Self) -> bool {
        let near = |a: u16, b: u16| turned_cdeg(a, b).min(turned_cdeg(b, a)) <= EDGE_CDEG;
        near(self.from_cdeg, other.from_cdeg) && near(self.until_cdeg, other.until_cdeg)
    }

    /// It lies between two azimuths, its edges to two blocks.
    fn lies_between(&self, from_cdeg: u16, until_cdeg: u16) -> bool {
        let whole = turned_cdeg(from_cdeg, until_cdeg).saturating_add(2 * EDGE_CDEG);
        let start = (u32::from(from_cdeg) + TURN_CDEG - EDGE_CDEG) % TURN_CDEG;
        let ahead = turned_cdeg(truncating_u16(start), self.from_cdeg);
        ahead.saturating_add(self.width_cdeg()) <= whole
    }

    fn holds(&self, azimuth_cdeg: u16) -> bool {
        let inside = turned_cdeg(self.from_cdeg, azimuth_cdeg);
        inside > EDGE_CDEG && inside.saturating_add(EDGE_CDEG) < self.width_cdeg()
    }
}

impl core::fmt::Display for ClosedSector {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let degrees = |cdeg: u32| (cdeg / 100, cdeg % 100 / 10);
        let (from, from_tenths) = degrees(u32::from(self.from_cdeg));
        let (until, until_tenths) = degrees(u32::from(self.until_cdeg));
        let (open, open_tenths) = degrees(self.open_cdeg());
        write!(
            f,
            "{from}.{from_tenths}° to {until}.{until_tenths}° is closed: {open}.{open_tenths}° of 360° are seen"
        )
    }
}

/// What of a packet matters here.
#[derive(Clone, Copy, Debug)]
pub(super) struct PacketTurn {
    /// Azimuth of the first block.
    pub(super) first_cdeg: u16,
    /// Azimuth at which the last block (pair) ends.
    pub(super) end_cdeg: u16,
    /// The jump within it.
    pub(super) closed: Option<ClosedSector>,
    /// Time that the jump took, microseconds.
    pub(super) skipped_us: u32,
    /// One turn of the head, microseconds.
    pub(super) turn_us: u32,
}

impl PacketTurn {
    /// Of the turns of a packet; `None` if nothing in it turns. `block_ns` is the time of a block; dual returns come in pairs.
    pub(super) fn new(turns: &[BlockTurn; BLOCKS], block_ns: u32, is_dual: bool) -> Option<Self> {
        let step = if is_dual { 2 } else { 1 };
        let (mut first, mut end, mut jump) = (None, 0, None);
        let (mut gaps_cdeg, mut count) = (0_u32, 0_u32);
        for turn in turns.iter().step_by(step) {
            let Some(azimuth_cdeg) = turn.azimuth_cdeg else { continue };
            if turn.skipped_cdeg > 0 {
                let from_cdeg = if first.is_some() { end } else { azimuth_cdeg };
                jump = Some(ClosedSector { from_cdeg, until_cdeg: azimuth_cdeg });
            }
            first = first.or(Some(azimuth_cdeg));
            let turned_cdeg = u32::from(azimuth_cdeg) + u32::from(turn.gap_cdeg);
            end = truncating_u16(if turned_cdeg < TURN_CDEG { turned_cdeg } else { turned_cdeg % TURN_CDEG });
            (gaps_cdeg, count) = (gaps_cdeg + u32::from(turn.gap_cdeg), count + 1);
        }
        let first_cdeg = first?;
        let time_us = |cdeg: u32| {
            let ns = u64::from(cdeg) * u64::from(block_ns) * u64::from(count);
            u32::try_from(ns.checked_div(u64::from(gaps_cdeg) * 1_000).unwrap_or(0)).unwrap_or(u32::MAX)
        };
        let skipped_us = jump.map_or(0, |closed| time_us(closed.width_cdeg()));
        Some(Self { first_cdeg, end_cdeg: end, closed: jump, skipped_us, turn_us: time_us(TURN_CDEG) })
    }
}

/// Learns the closed sector, and tells how much of the time between packets it explains.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SectorWatch {
    known: Option<ClosedSector>,
    /// Silence between two packets that may be one.
    silence: Option<(ClosedSector, u16)>,
    /// The newest accepted packet: where it ended and how long its jump took.
    last: Option<PacketTurn>,
    /// One turn of the head, microseconds: measured over a closed sector, so far better than within a packet.
    turn_us: Option<u32>,
}

impl SectorWatch {
    /// The packet with its times by what is known of the head's speed.
    pub(super) fn timed(&self, packet: PacketTurn) -> PacketTurn {
        // A head that changes its speed is known by its packets alone.
        let steady = |turn_us: &u32| turn_us.abs_diff(packet.turn_us) <= packet.turn_us / 50;
        let Some(turn_us) = self.turn_us.filter(steady) else { return packet };
        let skipped_us = packet.closed.map_or(0, |closed| share_us(closed.width_cdeg(), turn_us));
        PacketTurn { turn_us, skipped_us, ..packet }
    }

    pub(super) const fn known(&self) -> Option<ClosedSector> {
        self.known
    }

    /// Time of the closed sector since the first firing of the last accepted packet, `since_us` ago, microseconds.
    pub(super) fn closed_us(&self, packet: &PacketTurn, since_us: u32, packet_us: u32) -> u32 {
        let Some(PacketTurn { end_cdeg, skipped_us: within_us, .. }) = self.last else { return 0 };
        let Some(known) = self.known else { return within_us };
        let between_us = since_us.saturating_sub(within_us).saturating_sub(packet_us);
        let partial_us = share_us(turned_cdeg(end_cdeg, packet.first_cdeg), packet.turn_us);
        // Only what is at least as long as the rotation between the azimuths took can hold it.
        let whole_us = between_us.saturating_sub(partial_us).saturating_add(packet.turn_us / 2);
        let whole_turns = whole_us.checked_div(packet.turn_us).unwrap_or(0);
        let passed = known.lies_between(end_cdeg, packet.first_cdeg)
            && between_us.saturating_add(packet_us) >= partial_us;
        let passes = whole_turns.saturating_add(u32::from(passed));
        let width_us = share_us(known.width_cdeg(), packet.turn_us);
        within_us.saturating_add(width_us.saturating_mul(passes))
    }

    /// Takes in an accepted packet before which `lost` packets are missing, `since_us` after the one before. Gives how many
    /// of those that were called lost were none, because a closed sector has shown now.
    pub(super) fn accept(&mut self, packet: &PacketTurn, lost: u16, since_us: Option<u32>) -> u32 {
        if let (Some(last), Some(since_us), 0) = (self.last, since_us, lost)
            && last.closed.is_some()
        {
            let turned = u64::from(turned_cdeg(last.first_cdeg, packet.first_cdeg));
            let turn_us = (u64::from(since_us) * u64::from(TURN_CDEG)).checked_div(turned);
            self.turn_us = turn_us.and_then(|turn_us| u32::try_from(turn_us).ok());
        }
        if packet.closed.is_some() {
            self.known = packet.closed;
        } else if self
            .known
            .is_some_and(|known| known.holds(packet.first_cdeg) || known.holds(packet.end_cdeg))
        {
            // It is open now.
            self.known = None;
        }
        let mut taken_back = 0;
        if let Some(PacketTurn { end_cdeg, .. }) = self.last
            && lost > 0
            && self.known.is_none()
        {
            let silence = ClosedSector { from_cdeg: end_cdeg, until_cdeg: packet.first_cdeg };
            let again = self.silence.filter(|(before, _)| before.is_like(&silence));
            if again.is_some() && silence.width_cdeg() >= SILENCE_MIN_CDEG {
                self.known = Some(silence);
                taken_back = u32::from(lost);
            } else {
                self.silence = Some((silence, lost));
            }
        }
        if let (Some(known), Some((silence, before))) = (self.known, self.silence)
            && known.is_like(&silence)
        {
            taken_back = u32::from(before).saturating_add(taken_back);
            self.silence = None;
        }
        self.last = Some(*packet);
        taken_back
    }
}

/// What part of a turn takes, microseconds.
fn share_us(cdeg: u32, turn_us: u32) -> u32 {
    u32::try_from(u64::from(cdeg) * u64::from(turn_us) / u64::from(TURN_CDEG)).unwrap_or(u32::MAX)
}

/// Clockwise from one azimuth to another.
fn turned_cdeg(from_cdeg: u16, until_cdeg: u16) -> u32 {
    (u32::from(until_cdeg) + TURN_CDEG - u32::from(from_cdeg) % TURN_CDEG) % TURN_CDEG
}
