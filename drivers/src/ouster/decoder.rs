//! From a datagram to a stamped [`LidarPacketOf`]: clock, losses, and beams that look to different sides.
//!
//! A packet gives the columns that it completes: as far back as the beams look apart. Of two echoes the nearer one is kept: for a
//! stop the near one counts.

use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::number::{truncating_u16, truncating_u32};
use floorguard_types::profile::{Native, Profile, Size};
use floorguard_types::sensing::LidarPacketOf;
use floorguard_types::time::Stamp;
use heapless::Vec;

use super::beams::{Beams, CHANNELS_MAX};
use super::decode_error::DecodeError;
use super::packet::Packet;
use super::staggered::Staggered;
use crate::second_rings::SecondRings;
use crate::velodyne::HourClock;

/// Millimetres a count: sixteen bits then reach 262 m.
const UNIT_MM: u8 = 4;
const HOUR_US: u64 = 3_600_000_000;
/// The sensor measures in its own frame from the connector on, which is at its back: half a turn, hundredths of a degree.
const FRONT_CDEG: u64 = 18_000;
const TURN_CDEG: u64 = 36_000;
/// A packet that is older than the newest by up to half a turn was repeated or overtaken; by more, the sensor was started anew.
const REORDER_TURN_SHARE: u64 = 2;
/// A gap of more turns is a restart, not a number of lost packets.
const LOST_TURNS_MAX: u64 = 20;
/// A column takes at most so long: 512 a turn at 5 turns a second, nanoseconds, with a reserve.
const COLUMN_NS_MAX: u64 = 500_000;
/// Where a packet has one measured column alone: 1,024 a turn at 10 turns a second.
const COLUMN_NS: u64 = 97_656;
/// Turns are counted from here, so that columns before the first packet have a number.
const FIRST_COLUMN: u64 = 1 << 20;

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
    /// Columns that the sensor marked as not measured.
    pub invalid_columns: u32,
}

/// Decodes the stream of one lidar.
///
/// ```
/// use floorguard_drivers::ouster::{Beams, Decoder, Packet};
/// use floorguard_types::time::Stamp;
///
/// // Sixteen columns of 16 beams that look straight ahead; the lowest beam of the second sees something 1 m away.
/// let beams = Beams::even(16, (15_000, -15_000));
/// let mut bytes = vec![0; Packet::length(&beams)];
/// for (number, column) in (0_u16..).zip(bytes.chunks_exact_mut(212)) {
///     column[..8].copy_from_slice(&(97_656 * u64::from(number)).to_le_bytes());
///     column[8..10].copy_from_slice(&number.to_le_bytes());
///     column[208..].copy_from_slice(&[0xFF; 4]);
/// }
/// bytes[212 + 16 + 15 * 12..][..2].copy_from_slice(&1_000_u16.to_le_bytes());
///
/// let mut decoder = Decoder::new(&beams);
/// let (packet, lost) = decoder.decode(&bytes, Stamp::from_micros(5_000_000)).unwrap();
/// assert_eq!((lost, packet.columns.len(), packet.rings), (0, 16, 16));
/// let column = &packet.columns[1];
/// let range_mm = column.range_raw[0] * u16::from(packet.range_unit_mm);
/// // Column 0 looks to the connector at the back.
/// assert_eq!((column.azimuth_cdeg, column.offset_us, range_mm), (18_035, 97, 1_000));
/// assert!(decoder.decode(b"not a packet", Stamp::from_micros(5_000_400)).is_err());
/// assert_eq!(decoder.counters().refused, 1);
/// ```
#[derive(Clone, Debug)]
pub struct DecoderOf<P: Profile> {
    beams: Beams,
    rings: Vec<Ring, CHANNELS_MAX>,
    /// The farthest that a ring looks back, in columns.
    behind: u64,
    staggered: Staggered<P>,
    /// The rings above the sixteenth are for a second look for people.
    has_second: bool,
    second: SecondRings<P>,
    last: Option<Last>,
    clock: HourClock,
    counters: Counters,
}

/// A beam that is used.
#[derive(Clone, Copy, Debug)]
struct Ring {
    channel: u8,
    /// Columns that it looks ahead of the one that looks farthest back.
    ahead: u64,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    frame: u16,
    measurement: u16,
    /// The same, counted on since the first packet.
    column: u64,
}

/// For the lidars of the target.
pub type Decoder = DecoderOf<Native>;

impl<P: Profile> DecoderOf<P> {
    /// A decoder for one lidar.
    #[must_use]
    pub fn new(beams: &Beams) -> Self {
        let mut decoder = Self {
            beams: *beams,
            rings: Vec::new(),
            behind: 0,
            staggered: Staggered::EMPTY,
            has_second: false,
            second: SecondRings::EMPTY,
            last: None,
            clock: HourClock::default(),
            counters: Counters::default(),
        };
        decoder.set_rings_max(P::Rings::N);
        decoder
    }

    /// From now on at most so many of its beams become rings, see [`Beams::rings`].
    pub fn set_rings_max(&mut self, rings_max: usize) {
        self.set_rings(&self.beams.rings(rings_max.min(P::Rings::N)));
        self.has_second = false;
    }

    /// From now on sixteen of its beams become rings, and where it has more, those of [`Beams::second_rings`] wait for
    /// [`Self::put_second_rings`].
    pub fn set_second_look(&mut self) {
        let mut chosen = self.beams.rings(SWEEP_RINGS);
        let second = self.beams.second_rings();
        self.has_second = SecondRings::<P>::FIT && !second.is_empty();
        if self.has_second {
            // Twice 16 of 128.
            let _ = chosen.extend_from_slice(&second);
        }
        self.set_rings(&chosen);
    }

    /// Puts the second sixteen rings of the newest packet behind those that it has. Nothing without two looks.
    pub fn put_second_rings(&self, packet: &mut LidarPacketOf<P>) {
        self.second.put_into(packet);
    }

    fn set_rings(&mut self, chosen: &[u8]) {
        let shift = |channel: &u8| self.beams.shift(usize::from(*channel));
        let least = chosen.iter().map(shift).min().unwrap_or(0);
        self.rings.clear();
        for channel in chosen {
            let ahead = u64::from(shift(channel).abs_diff(least));
            // As many as there were asked for, the capacity.
            let _full = self.rings.push(Ring { channel: *channel, ahead });
        }
        // Columns are completed by the ring that looks farthest back.
        self.behind = u64::from(least.min(0).unsigned_abs());
        self.staggered = Staggered::EMPTY;
        self.second = SecondRings::EMPTY;
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
        let packet = Packet::new_checked(payload, &self.beams).map_err(DecodeError::Packet)?;
        let timing = Timing::of(&packet)?;
        let measurement = packet.columns().next().map_or(0, |column| column.measurement());
        let (column, lost) = self.place(packet.frame(), measurement)?;
        self.last = Some(Last { frame: packet.frame(), measurement, column });
        // The last column arrives at once: the first one was measured before by the time of all.
        let sensor_us = truncating_u32((timing.first_ns / 1_000) % HOUR_US);
        let first = self.clock.stamp(sensor_us, arrival.minus_micros(timing.took_ns / 1_000));
        out.stamp = first.minus_micros(self.behind.saturating_mul(timing.column_ns) / 1_000);
        out.range_unit_mm = UNIT_MM;
        out.rings = u8::try_from(self.rings.len()).unwrap_or(u8::MAX);
        self.convert(&packet, (column, timing.column_ns), out);
        if self.has_second {
            self.second.take_from(out);
        }
        Ok(lost)
    }

    /// Where the packet begins, counted since the first one, and how many packets are missing before it.
    fn place(&mut self, frame: u16, measurement: u16) -> Result<(u64, u16), DecodeError> {
        let turn = u64::from(self.beams.columns_per_turn);
        let begin = FIRST_COLUMN.saturating_mul(turn).saturating_add(u64::from(measurement));
        let Some(last) = self.last else { return Ok((begin, 0)) };
        let turns = u64::from(frame.wrapping_sub(last.frame));
        let ahead = turns.saturating_mul(turn).saturating_add(u64::from(measurement));
        let behind = u64::from(last.frame.wrapping_sub(frame)).saturating_mul(turn);
        let behind =
            behind.saturating_add(u64::from(last.measurement)).saturating_sub(u64::from(measurement));
        let is_older = frame == last.frame && measurement <= last.measurement;
        if is_older || (turns > LOST_TURNS_MAX && behind <= turn / REORDER_TURN_SHARE) {
            return Err(DecodeError::NotNewer { frame, column: measurement });
        }
        let steps = ahead.saturating_sub(u64::from(last.measurement));
        if turns > LOST_TURNS_MAX {
            self.staggered = Staggered::EMPTY;
            return Ok((last.column.saturating_add(turn), 0));
        }
        let per_packet = u64::from(self.beams.columns_per_packet).max(1);
        let lost = (steps / per_packet).saturating_sub(1);
        Ok((last.column.saturating_add(steps), truncating_u16(lost)))
    }

    /// Enters the returns, and takes out the columns that are complete. One column of the packet after the other.
    fn convert(&mut self, packet: &Packet<'_>, (begin, column_ns): (u64, u64), out: &mut LidarPacketOf<P>) {
        out.columns.clear();
        let turn = u64::from(self.beams.columns_per_turn).max(1);
        for (number, column) in (0_u64..).zip(packet.columns()) {
            let complete = begin.saturating_add(number).saturating_sub(self.behind);
            if column.is_valid() {
                for (index, ring) in self.rings.iter().enumerate() {
                    let seen = column.pixel(ring.channel).and_then(|(range_mm, reflectivity)| {
                        let raw = u16::try_from(range_mm / u32::from(UNIT_MM)).unwrap_or(u16::MAX);
                        (raw > 0).then_some((raw, reflectivity))
                    });
                    self.staggered.enter(complete.saturating_add(ring.ahead), index, seen);
                }
            } else {
                self.counters.invalid_columns = self.counters.invalid_columns.saturating_add(1);
            }
            if let Some(mut seen) = self.staggered.take(complete) {
                let turned = (complete % turn).saturating_mul(TURN_CDEG) / turn;
                seen.azimuth_cdeg = truncating_u16(turned.saturating_add(FRONT_CDEG) % TURN_CDEG);
                seen.offset_us = truncating_u32(number.saturating_mul(column_ns) / 1_000);
                // At most 24 columns a packet, the capacity.
                let _full = out.columns.push(seen);
            }
        }
    }
}

/// When the columns of a packet were measured.
#[derive(Clone, Copy, Debug)]
struct Timing {
    first_ns: u64,
    /// From the first column to the last.
    took_ns: u64,
    column_ns: u64,
}

impl Timing {
    /// By the columns that were measured: what stands in the others has no meaning.
    fn of(packet: &Packet<'_>) -> Result<Self, DecodeError> {
        let (mut first, mut last, mut count) = (None, None, 0_u64);
        for (index, column) in (0_u64..).zip(packet.columns()) {
            count = index.saturating_add(1);
            if column.is_valid() {
                last = Some((index, column.sensor_ns()));
                first = first.or(last);
            }
        }
        let Some((first_index, first_ns)) = first else { return Err(DecodeError::NothingMeasured) };
        let (last_index, last_ns) = last.unwrap_or((first_index, first_ns));
        let steps = last_index.saturating_sub(first_index);
        let took_ns = last_ns.checked_sub(first_ns);
        let column_ns = match steps {
            0 => COLUMN_NS,
            _ => took_ns.and_then(|took_ns| took_ns.checked_div(steps)).unwrap_or(u64::MAX),
        };
        if !(1..=COLUMN_NS_MAX).contains(&column_ns) {
            let took_us = truncating_u32((took_ns.unwrap_or(0) / 1_000).min(u64::from(u32::MAX)));
            return Err(DecodeError::Times { took_us });
        }
        Ok(Self {
            first_ns: first_ns.saturating_sub(first_index.saturating_mul(column_ns)),
            took_ns: count.saturating_sub(1).saturating_mul(column_ns),
            column_ns,
        })
    }
}
