//! From a datagram to a stamped [`LidarPacketOf`]: clock, losses, plausibility.
//!
//! Of two echoes the nearer one is kept, as for the Velodyne lidars: for a stop the near one counts.

use floorguard_types::number::{truncating_u8, truncating_u32};
use floorguard_types::profile::{Native, Profile, Size, Table};
use floorguard_types::sensing::{LidarColumnOf, LidarPacketOf};
use floorguard_types::time::Stamp;

use super::decode_error::DecodeError;
use super::packet::{BLOCKS, Block, Packet, ReturnMode};
use crate::second_rings::SecondRings;
use crate::velodyne::HourClock;

/// From a firing to the next, microseconds (book, Hesai: Times).
const FIRING_US: u32 = 50;
/// From the packet's time to the first laser of its last firing, 5.632 + 0.368 µs (book, Hesai: Times), rounded.
const LAST_FIRING_US: u32 = 6;
const HOUR_US: u32 = 3_600_000_000;
/// A packet that is older than the one before by up to this was repeated or overtaken on the way; by more, the sensor's clock was
/// set.
const REORDER_US: u32 = 500_000;
/// A number that falls back by at most this was repeated or overtaken: half a second of packets with two echoes.
const REORDER_PACKETS: u32 = 2_500;
/// A longer silence is a restart, not a number of lost packets: a second of packets with two echoes.
const LOST_MAX: u32 = 5_000;
/// Turned from a firing to the next at 1,200 turns a minute: 36; with a reserve, as for the Velodyne lidars.
const GAP_MAX_CDEG: u16 = 100;
const TURN_CDEG: u16 = 36_000;

/// What happened to the datagrams; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Packets that gave columns.
    pub accepted: u32,
    /// Datagrams refused, for any reason.
    pub refused: u32,
    /// Packets missing between two accepted ones.
    pub lost: u32,
    /// Packets repeated or overtaken (also counted as refused).
    pub not_newer: u32,
    /// Returns nearer than the blind range, taken for the robot itself and entered as unknown.
    pub self_returns: u32,
}

/// Decodes the stream of one lidar.
///
/// ```
/// use floorguard_drivers::hesai::Decoder;
/// use floorguard_types::time::Stamp;
///
/// // Eight firings, 0.18° apart. The lowest laser of the second sees something 1 m away.
/// let mut bytes = [0; 568];
/// bytes[..12].copy_from_slice(&[0xEE, 0xFF, 6, 1, 0, 0, 16, 8, 0, 4, 1, 1]);
/// for (azimuth_cdeg, block) in (0_u16..).step_by(18).zip(bytes[12..540].chunks_exact_mut(66)) {
///     block[..2].copy_from_slice(&azimuth_cdeg.to_le_bytes());
/// }
/// bytes[12 + 66 + 62..][..2].copy_from_slice(&250_u16.to_le_bytes());
/// bytes[550..553].copy_from_slice(&[0x37, 0x58, 0x02]);
///
/// let mut decoder = Decoder::new();
/// let (packet, lost) = decoder.decode(&bytes, Stamp::from_micros(5_000_000)).unwrap();
/// assert_eq!((lost, packet.columns.len(), packet.rings), (0, 8, 16));
/// let column = &packet.columns[1];
/// let range_mm = column.range_raw[0] * u16::from(packet.range_unit_mm);
/// assert_eq!((column.azimuth_cdeg, column.offset_us, range_mm), (18, 50, 1_000));
/// assert!(decoder.decode(b"not a packet", Stamp::from_micros(5_000_400)).is_err());
/// assert_eq!(decoder.counters().refused, 1);
/// ```
#[derive(Clone, Debug)]
pub struct DecoderOf<P: Profile> {
    blind_range_mm: u16,
    lasers_max: u8,
    /// Of an XT-32 every second laser is used.
    is_thinned: bool,
    /// The others, for a second look for people.
    second: SecondRings<P>,
    last: Option<Last>,
    clock: HourClock,
    counters: Counters,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    sequence: Option<u32>,
    hour_us: u32,
}

/// For the lidars of the target.
pub type Decoder = DecoderOf<Native>;

impl<P: Profile> Default for DecoderOf<P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: Profile> DecoderOf<P> {
    /// A decoder for one lidar.
    #[must_use]
    pub fn new() -> Self {
        Self {
            blind_range_mm: 0,
            lasers_max: truncating_u8(P::Rings::N),
            is_thinned: false,
            second: SecondRings::EMPTY,
            last: None,
            clock: HourClock::default(),
            counters: Counters::default(),
        }
    }

    /// The same decoder for a lidar that sees the robot itself up to `blind_range_mm`: nearer returns become *unknown*.
    #[must_use]
    pub fn with_blind_range_mm(self, blind_range_mm: u16) -> Self {
        Self { blind_range_mm, ..self }
    }

    /// The same decoder for stages that take lidars of at most `lasers_max` rings: packets of a larger one are refused.
    #[must_use]
    pub fn with_lasers_max(mut self, lasers_max: u8) -> Self {
        self.set_lasers_max(lasers_max);
        self
    }

    /// The same decoder for an XT-32 in the place of an XT-16: of its lasers the uppermost, the third and so on are used, which look
    /// where those of an XT-16 do. The others wait for [`Self::put_second_rings`].
    #[must_use]
    pub fn every_second_of_32(self) -> Self {
        Self { is_thinned: true, ..self }
    }

    /// Puts the other lasers of the newest packet behind those that it has, see [`Self::every_second_of_32`]; each a degree
    /// below the one that is used. Nothing where every laser is used.
    pub fn put_second_rings(&self, packet: &mut LidarPacketOf<P>) {
        self.second.put_into(packet);
    }

    /// Packets of a larger lidar are refused from now on.
    pub fn set_lasers_max(&mut self, lasers_max: u8) {
        self.lasers_max = lasers_max.min(truncating_u8(P::Rings::N));
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        self.counters
    }

    /// How often the sensor's clock was set, see [`HourClock`].
    #[must_use]
    pub const fn clock_restarts(&self) -> u32 {
        self.clock.restarts()
    }

    /// Decodes one UDP payload that arrived at `arrival`. Gives the columns and how many packets are missing right before them.
    ///
    /// # Errors
    /// [`DecodeError`]; the datagram is counted and changes nothing else.
    pub fn decode(&mut self, payload: &[u8], arrival: Stamp) -> Result<(LidarPacketOf<P>, u16), DecodeError> {
        let mut packet = LidarPacketOf::EMPTY;
        let lost = self.decode_into(payload, arrival, &mut packet)?;
        Ok((packet, lost))
    }

    /// The same into a packet that is there already: nothing large is moved.
    ///
    /// # Errors
    /// [`DecodeError`]; the datagram is counted, and what stands in `out` has no meaning.
    pub fn decode_into(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, DecodeError> {
        let outcome = self.try_decode(payload, arrival, out);
        let counters = &mut self.counters;
        match outcome {
            Ok(lost) => {
                counters.accepted = counters.accepted.saturating_add(1);
                counters.lost = counters.lost.saturating_add(u32::from(lost));
            }
            Err(error) => {
                counters.refused = counters.refused.saturating_add(1);
                let is_old = matches!(error, DecodeError::NotNewer { .. });
                counters.not_newer = counters.not_newer.saturating_add(u32::from(is_old));
            }
        }
        outcome
    }

    fn try_decode(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, DecodeError> {
        let packet = Packet::new_checked(payload).map_err(DecodeError::Packet)?;
        let is_thinned = self.is_thinned && packet.lasers() == 32;
        let lasers = if is_thinned { packet.lasers() / 2 } else { packet.lasers() };
        if lasers > self.lasers_max {
            return Err(DecodeError::TooManyLasers { lasers, lasers_max: self.lasers_max });
        }
        let echoes = if packet.return_mode() == ReturnMode::Dual { 2 } else { 1 };
        let skipped_us = skipped_us(&packet, echoes)?;
        let lost = self.lost_before(&packet, echoes)?;
        self.last = Some(Last { sequence: packet.sequence(), hour_us: packet.hour_us() });
        let firings = truncating_u32(BLOCKS / echoes);
        let fired_us = firings.saturating_mul(FIRING_US).saturating_add(skipped_us);
        // The packet's time is that of its end: the last firing begins 6 us after it, the others 50 us apart before that.
        let first_before_us = fired_us.saturating_sub(FIRING_US).saturating_sub(LAST_FIRING_US);
        let sensor_us = (u64::from(packet.hour_us()) + u64::from(HOUR_US) - u64::from(first_before_us))
            % u64::from(HOUR_US);
        let stamp = self.clock.stamp(
            truncating_u32(usize::try_from(sensor_us).unwrap_or(0)),
            arrival.minus_micros(u64::from(fired_us)),
        );
        out.stamp = stamp;
        out.range_unit_mm = 4;
        out.rings = lasers;
        // At most eight of the capacity.
        let _ = out.columns.resize(BLOCKS / echoes, LidarColumnOf::SILENT);
        let self_returns = self.convert(&packet, (echoes, skipped_us), out);
        if SecondRings::<P>::FIT && is_thinned {
            self.second.take_from(out);
        } else {
            self.second.forget();
        }
        self.counters.self_returns = self.counters.self_returns.saturating_add(self_returns);
        Ok(lost)
    }

    /// How many packets are missing before this one, by their numbers where they are sent, otherwise by their times.
    fn lost_before(&self, packet: &Packet<'_>, echoes: usize) -> Result<u16, DecodeError> {
        let Some(last) = self.last else { return Ok(0) };
        let stamp_us = packet.hour_us();
        let steps = if let (Some(sequence), Some(before)) = (packet.sequence(), last.sequence) {
            if before.wrapping_sub(sequence) <= REORDER_PACKETS {
                return Err(DecodeError::NotNewer { stamp_us });
            }
            sequence.wrapping_sub(before)
        } else {
            let step_us =
                (u64::from(stamp_us) + 2 * u64::from(HOUR_US) - u64::from(last.hour_us)) % u64::from(HOUR_US);
            let step_us = u32::try_from(step_us).unwrap_or(0);
            if step_us == 0 || HOUR_US.saturating_sub(step_us) <= REORDER_US {
                return Err(DecodeError::NotNewer { stamp_us });
            }
            let period_us = truncating_u32(BLOCKS / echoes.max(1)).saturating_mul(FIRING_US).max(1);
            step_us.saturating_add(period_us / 2) / period_us
        };
        let lost = steps.saturating_sub(1);
        Ok(if lost > LOST_MAX { 0 } else { u16::try_from(lost).unwrap_or(0) })
    }

    /// Enters the returns, the nearer of two echoes; of an XT-32 of which every second laser is used the others behind them,
    /// where they fit. Gives the number of self-returns, at most 256.
    fn convert(
        &self,
        packet: &Packet<'_>,
        (echoes, skipped_us): (usize, u32),
        out: &mut LidarPacketOf<P>,
    ) -> u32 {
        let blind_raw = self.blind_range_mm.div_ceil(4);
        let top = usize::from(out.rings).saturating_sub(1);
        let every = if out.rings < packet.lasers() { 2 } else { 1 };
        let mut self_returns = 0;
        let (mut later_us, mut before_cdeg) = (0, None);
        let has_second = SecondRings::<P>::FIT && every == 2;
        for (firing, column) in out.columns.iter_mut().enumerate() {
            *column = LidarColumnOf::SILENT;
            for block in packet.blocks().skip(firing * echoes).take(echoes) {
                if before_cdeg.is_some_and(|before| turned_cdeg(before, block.azimuth_cdeg) > GAP_MAX_CDEG) {
                    later_us = skipped_us;
                }
                before_cdeg = Some(block.azimuth_cdeg);
                column.azimuth_cdeg = block.azimuth_cdeg;
                self_returns += enter(column, &block, (0, every), (top, blind_raw));
                if has_second {
                    let above = top.saturating_add(usize::from(out.rings));
                    self_returns += enter(column, &block, (1, every), (above, blind_raw));
                }
            }
            column.offset_us = truncating_u32(firing).saturating_mul(FIRING_US).saturating_add(later_us);
        }
        self_returns
    }
}

/// Enters one echo of each laser from a first one on where nothing nearer is. Gives the number of self-returns.
fn enter<P: Profile>(
    column: &mut LidarColumnOf<P>,
    block: &Block<'_>,
    (first, every): (usize, usize),
    (top, blind_raw): (usize, u16),
) -> u32 {
    let mut self_returns = 0;
    for (channel, (raw, reflectivity)) in block.cells().skip(first).step_by(every).enumerate() {
        if raw == 0 || raw < blind_raw {
            self_returns += u32::from(raw != 0);
            continue;
        }
        // The wire goes down, rings go up.
        let ring = top.saturating_sub(channel);
        let Some(range) = column.range_raw.get_mut(ring) else { continue };
        if *range == 0 || raw < *range {
            *range = raw;
            if let Some(brightness) = column.reflectivity.get_mut(ring) {
                *brightness = reflectivity;
            }
        }
    }
    self_returns
}

/// Turned from one azimuth to another, hundredths of a degree, 0…35,999.
fn turned_cdeg(from_cdeg: u16, to_cdeg: u16) -> u16 {
    match to_cdeg.checked_sub(from_cdeg) {
        Some(turned) => turned,
        None => TURN_CDEG.saturating_sub(from_cdeg).saturating_add(to_cdeg),
    }
}

/// The head turns, and blocks of two echoes come in pairs. Gives for how long the lasers did not fire in between, where the lidar is
/// set to a field of view: microseconds by the turning speed that the packet states.
fn skipped_us(packet: &Packet<'_>, echoes: usize) -> Result<u32, DecodeError> {
    let mut before_cdeg: Option<u16> = None;
    let mut skipped_cdeg = None;
    for (index, block) in packet.blocks().enumerate() {
        let Some(from_cdeg) = before_cdeg.replace(block.azimuth_cdeg) else { continue };
        let gap_cdeg = turned_cdeg(from_cdeg, block.azimuth_cdeg);
        if echoes == 2 && index % 2 == 1 {
            if gap_cdeg != 0 {
                return Err(DecodeError::NoPairs { first_cdeg: from_cdeg, second_cdeg: block.azimuth_cdeg });
            }
        } else if gap_cdeg == 0 || (gap_cdeg > GAP_MAX_CDEG && skipped_cdeg.is_some()) {
            return Err(DecodeError::Rotation { gap_cdeg });
        } else if gap_cdeg > GAP_MAX_CDEG {
            skipped_cdeg = Some(gap_cdeg);
        }
    }
    let Some(skipped_cdeg) = skipped_cdeg else { return Ok(0) };
    // A turn a minute is 600 cdeg a second.
    let cdeg_per_s = u64::from(packet.rpm()).saturating_mul(600);
    let skipped = u64::from(skipped_cdeg).saturating_mul(1_000_000).checked_div(cdeg_per_s);
    let skipped = skipped.and_then(|micros| u32::try_from(micros).ok());
    skipped.ok_or(DecodeError::Rotation { gap_cdeg: skipped_cdeg })
}
