//! From a datagram to a stamped [`LidarPacketOf`]: sender, losses, clock.

use floorguard_types::number::{truncating_u8, truncating_u16, truncating_u32};
use floorguard_types::profile::{Native, Profile, Size, Table};
use floorguard_types::sensing::{LidarColumnOf, LidarPacketOf};
use floorguard_types::time::Stamp;

use super::decode_error::DecodeError;
use super::frame::{ColumnsFrame, RINGS_MAX};
use crate::datagram_counters::DatagramCounters;
use crate::link::{DatagramOrder, lost_before};
use crate::velodyne::HourClock;

const HOUR_US: u64 = 3_600_000_000;

/// Decodes the stream of one bridge.
#[derive(Clone, Debug)]
pub struct DecoderOf<P: Profile> {
    rings: u8,
    order: DatagramOrder,
    clock: HourClock,
    counters: DatagramCounters,
    profile: core::marker::PhantomData<P>,
}

/// For the lidars of the target.
pub type Decoder = DecoderOf<Native>;

impl<P: Profile> DecoderOf<P> {
    /// A decoder for a lidar of so many rings.
    #[must_use]
    pub fn new(rings: u8) -> Self {
        Self {
            rings: rings.min(truncating_u8(P::Rings::N)).min(RINGS_MAX),
            order: DatagramOrder::default(),
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

    /// Decodes one UDP payload that arrived at `arrival`. Gives the columns and how many datagrams are missing right before them.
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
        self.counters.count(&outcome);
        outcome
    }

    fn try_decode(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, DecodeError> {
        let frame = ColumnsFrame::new_checked(payload).map_err(DecodeError::Frame)?;
        if frame.rings() != self.rings {
            return Err(DecodeError::Rings { found: frame.rings(), expected: self.rings });
        }
        let newest = self.order.newest(frame.sender(), arrival).map_err(DecodeError::Order)?;
        let lost = lost_before(newest, frame.sequence()).map_err(DecodeError::Order)?;
        self.order.accept(frame.sender(), frame.sequence(), arrival);
        let took_us = frame.columns().last().map_or(0, |column| column.offset_us);
        let sensor_us = truncating_u32(frame.sent_us() % HOUR_US);
        out.stamp = self.clock.stamp(sensor_us, arrival.minus_micros(u64::from(took_us)));
        out.range_unit_mm = frame.range_unit_mm();
        out.rings = frame.rings();
        out.columns.clear();
        for column in frame.columns() {
            let mut seen: LidarColumnOf<P> = LidarColumnOf {
                azimuth_cdeg: column.azimuth_cdeg,
                offset_us: u32::from(column.offset_us),
                ..LidarColumnOf::SILENT
            };
            for (ring, (raw, reflectivity)) in column.cells().enumerate() {
                if let Some(range) = seen.range_raw.get_mut(ring) {
                    *range = raw;
                }
                if let Some(brightness) = seen.reflectivity.get_mut(ring) {
                    *brightness = reflectivity;
                }
            }
            // At most 24 columns, the capacity.
            let _full = out.columns.push(seen);
        }
        Ok(truncating_u16(lost))
    }
}
