//! What every decoder of a spinning lidar does.

use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::profile::{Profile, Size};
use floorguard_types::sensing::{LidarPacketOf, RingChoice};
use floorguard_types::time::Stamp;

use super::error::LidarError;
use crate::hesai;
use crate::lidar_link;
use crate::livox;
use crate::ouster;
use crate::velodyne::{self, ClosedSector};

/// Datagrams in, columns out.
pub trait LidarDecoder<P: Profile> {
    /// Gives at most so many rings from now on: a decoder that cannot choose among them refuses a lidar of more lasers.
    fn limit_lasers(&mut self, lasers_max: u8);

    /// Decodes one UDP payload that arrived at `arrival` into `out`; gives how many packets are missing right before it.
    ///
    /// # Errors
    /// Why the datagram is of no use; it is counted, and what stands in `out` has no meaning.
    fn decode_datagram(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, LidarError>;

    /// Why a block of the newest packet was left out though the packet was taken. Most refuse such a packet whole.
    fn left_out_block(&self) -> Option<LidarError> {
        None
    }

    /// The sector that the lidar leaves out because it is set to a field of view, once it has shown. Where columns carry their
    /// azimuths, what is between two of them stays unknown without a name.
    fn known_closed_sector(&self) -> Option<ClosedSector> {
        None
    }

    /// The rings in which people are looked for, once it is known that the lidar has more of them than a sweep.
    fn people_rings(&self) -> Option<RingChoice> {
        None
    }

    /// Makes of the newest packet, after the guard has judged it, what people are looked for in: the rings of a sweep, and
    /// behind them those of a second look, where the lidar has more. The packet then says 32 rings.
    fn arrange_for_people(&self, _packet: &mut LidarPacketOf<P>) {}
}

impl<P: Profile> LidarDecoder<P> for velodyne::DecoderOf<P> {
    fn limit_lasers(&mut self, lasers_max: u8) {
        self.set_lasers_max(lasers_max);
    }

    fn decode_datagram(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, LidarError> {
        self.decode_into(payload, arrival, out).map_err(LidarError::Velodyne)
    }

    fn left_out_block(&self) -> Option<LidarError> {
        self.odd_block().map(|error| LidarError::Velodyne(velodyne::DecodeError::Packet(error)))
    }

    fn known_closed_sector(&self) -> Option<ClosedSector> {
        self.closed_sector()
    }

    fn people_rings(&self) -> Option<RingChoice> {
        // Without room for more lasers there is nothing to choose, and no code for it.
        if P::Rings::N > SWEEP_RINGS { self.model()?.people_rings() } else { None }
    }

    fn arrange_for_people(&self, packet: &mut LidarPacketOf<P>) {
        let Some(first) = LidarDecoder::people_rings(self) else { return };
        match self.model().and_then(velodyne::Model::second_people_rings) {
            Some(second) => first.put_before(&second, packet),
            None => first.keep_in(packet),
        }
    }
}

impl<P: Profile> LidarDecoder<P> for hesai::DecoderOf<P> {
    fn limit_lasers(&mut self, lasers_max: u8) {
        self.set_lasers_max(lasers_max);
    }

    fn decode_datagram(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, LidarError> {
        self.decode_into(payload, arrival, out).map_err(LidarError::Hesai)
    }

    fn arrange_for_people(&self, packet: &mut LidarPacketOf<P>) {
        self.put_second_rings(packet);
    }
}

impl<P: Profile> LidarDecoder<P> for ouster::DecoderOf<P> {
    /// So many of its beams are chosen, see [`ouster::Beams::rings`].
    fn limit_lasers(&mut self, lasers_max: u8) {
        self.set_rings_max(usize::from(lasers_max));
    }

    fn decode_datagram(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, LidarError> {
        self.decode_into(payload, arrival, out).map_err(LidarError::Ouster)
    }

    fn arrange_for_people(&self, packet: &mut LidarPacketOf<P>) {
        self.put_second_rings(packet);
    }
}

impl<P: Profile> LidarDecoder<P> for lidar_link::DecoderOf<P> {
    /// It has as many rings as the robot's file names elevations for.
    fn limit_lasers(&mut self, _: u8) {}

    fn decode_datagram(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, LidarError> {
        self.decode_into(payload, arrival, out).map_err(LidarError::Bridged)
    }
}

impl<P: Profile> LidarDecoder<P> for livox::DecoderOf<P> {
    /// It has as many rings as a sweep.
    fn limit_lasers(&mut self, _: u8) {}

    fn decode_datagram(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, LidarError> {
        self.decode_into(payload, arrival, out).map_err(LidarError::Livox)
    }
}
