//! From a datagram to a stamped [`LidarPacketOf`]: order, losses, clock.

use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::number::{truncating_u8, truncating_u16, truncating_u32};
use floorguard_types::profile::{Native, Profile};
use floorguard_types::sensing::LidarPacketOf;
use floorguard_types::time::Stamp;

use super::decode_error::DecodeError;
use super::gathered::{Gathered, TURN_US};
use super::packet::PointPacket;
use super::rings::{Rings, UNIT_MM};
use crate::datagram_counters::DatagramCounters;
use crate::velodyne::HourClock;

const HOUR_US: u64 = 3_600_000_000;
/// What falls back by up to this was repeated or overtaken; by more, the sensor was started anew, nanoseconds.
const REORDER_NS: u64 = 500_000_000;
/// After a longer gap than this nothing that was gathered is new enough, nanoseconds.
const GAP_NS: u64 = TURN_US * 1_000 / 2;
/// A longer gap is a sensor that was started anew, or a clock that was set, not a number of lost datagrams, nanoseconds.
const LOST_NS: u64 = 2_000_000_000;

/// Decodes the stream of one sensor; 26 KB.
#[derive(Clone, Debug)]
pub struct DecoderOf<P: Profile> {
    rings: Rings,
    gathered: Gathered,
    /// The sensor's time after the newest point, nanoseconds.
    end_ns: Option<u64>,
    clock: HourClock,
    counters: DatagramCounters,
    profile: core::marker::PhantomData<P>,
}

/// For the lidars of the target.
pub type Decoder = DecoderOf<Native>;

impl<P: Profile> DecoderOf<P> {
    /// A decoder that makes rings of these elevations in the sensor's frame, thousandths of a degree, rising.
    #[must_use]
    pub fn new(elevations_mdeg: &[i32; SWEEP_RINGS]) -> Self {
        Self {
            rings: Rings::new(elevations_mdeg),
            gathered: Gathered::new(),
            end_ns: None,
            clock: HourClock::default(),
            counters: DatagramCounters::default(),
            profile: core::marker::PhantomData,
        }
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> DatagramCounters {
        self.counters
    }

    /// Decodes one UDP payload that arrived at `arrival`. Gives the columns that are due, and how many datagrams are missing right
    /// before it.
    ///
    /// # Errors
    /// [`DecodeError`]; the datagram is counted.
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
        self.counters.count(&outcome);
        outcome
    }

    fn try_decode(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, DecodeError> {
        let packet = PointPacket::new_checked(payload).map_err(DecodeError::Packet)?;
        let lost = self.follow(&packet)?;
        let end_ns = packet.time_ns().saturating_add(packet.duration_ns());
        self.end_ns = Some(end_ns);
        for point in packet.points() {
            self.gathered.take(&point, &self.rings);
        }
        let was_complete = self.gathered.is_complete();
        let first_ns = self.gathered.give(end_ns, out);
        let sensor_us = truncating_u32((end_ns / 1_000) % HOUR_US);
        let measured = self.clock.stamp(sensor_us, arrival);
        if !was_complete {
            return Err(DecodeError::Gathering);
        }
        // What a column shows is half a turn old in the mean.
        let before_us = end_ns.saturating_sub(first_ns) / 1_000;
        out.stamp = measured.minus_micros(before_us.saturating_add(TURN_US / 2));
        out.range_unit_mm = UNIT_MM;
        out.rings = truncating_u8(SWEEP_RINGS);
        Ok(lost)
    }

    /// How many datagrams are missing before this one, by the sensor's clock: its counter of datagrams begins anew with each of its
    /// frames, whose length is not known. After a gap in which too much went by, all that was gathered is forgotten.
    fn follow(&mut self, packet: &PointPacket<'_>) -> Result<u16, DecodeError> {
        let begin_ns = packet.time_ns();
        let Some(end_ns) = self.end_ns else {
            self.gathered.begin(begin_ns);
            return Ok(0);
        };
        let back_ns = end_ns.saturating_sub(begin_ns);
        if begin_ns < end_ns && back_ns < REORDER_NS {
            return Err(DecodeError::NotNewer { older_us: truncating_u32(back_ns / 1_000) });
        }
        let gap_ns = begin_ns.saturating_sub(end_ns);
        if back_ns >= REORDER_NS || gap_ns > GAP_NS {
            self.gathered.begin(begin_ns);
        }
        // From the last point of one datagram to the first of the next it is as long as from point to point.
        let between_ns =
            packet.duration_ns().checked_div(u64::from(packet.len().saturating_sub(1))).unwrap_or(0);
        let whole_ns = packet.duration_ns().saturating_add(between_ns);
        let missing = gap_ns.checked_div(whole_ns).unwrap_or(0);
        Ok(if gap_ns > LOST_NS { 0 } else { truncating_u16(missing) })
    }
}
