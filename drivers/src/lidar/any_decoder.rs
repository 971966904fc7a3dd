//! The decoder of whichever lidar is configured, where memory for the largest of them does not matter.

use floorguard_types::profile::{Native, Profile};
use floorguard_types::sensing::{LidarPacketOf, RingChoice};
use floorguard_types::time::Stamp;

use super::contract::LidarDecoder;
use super::error::LidarError;
use super::straight_columns::StraightColumns;
use crate::hesai;
use crate::lidar_link;
use crate::livox;
use crate::ouster;
use crate::velodyne::{self, ClosedSector};

/// One of the makers' decoders.
///
/// ```
/// use floorguard_drivers::lidar::{AnyDecoder, LidarDecoder};
/// use floorguard_drivers::hesai::Decoder;
/// use floorguard_types::sensing::LidarPacket;
/// use floorguard_types::time::Stamp;
///
/// let mut decoder = AnyDecoder::Hesai(Decoder::new());
/// let error = decoder.decode_datagram(&[0; 1_206], Stamp::ZERO, &mut LidarPacket::EMPTY).unwrap_err();
/// assert_eq!(error.to_string(), "lidar packet starts with 00 00 00; expected EE FF 06");
/// ```
// One lives for the length of a run.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
pub enum AnyDecoderOf<P: Profile> {
    /// VLP-16 and relatives.
    Velodyne(velodyne::DecoderOf<P>),
    /// VLP-32C, whose lasers look beside their columns.
    Straight(velodyne::DecoderOf<P>, StraightColumns<P>),
    /// PandarXT-16 and XT-32.
    Hesai(hesai::DecoderOf<P>),
    /// Ouster OS0, OS1 and OS2.
    Ouster(ouster::DecoderOf<P>),
    /// Any lidar behind a bridge.
    Bridged(lidar_link::DecoderOf<P>),
    /// Livox Mid-360.
    Livox(livox::DecoderOf<P>),
}

/// For the lidars of the target.
pub type AnyDecoder = AnyDecoderOf<Native>;

impl<P: Profile> LidarDecoder<P> for AnyDecoderOf<P> {
    fn limit_lasers(&mut self, lasers_max: u8) {
        match self {
            Self::Velodyne(decoder) | Self::Straight(decoder, _) => decoder.limit_lasers(lasers_max),
            Self::Hesai(decoder) => decoder.limit_lasers(lasers_max),
            Self::Ouster(decoder) => decoder.limit_lasers(lasers_max),
            Self::Bridged(decoder) => decoder.limit_lasers(lasers_max),
            Self::Livox(decoder) => decoder.limit_lasers(lasers_max),
        }
    }

    fn decode_datagram(
        &mut self,
        payload: &[u8],
        arrival: Stamp,
        out: &mut LidarPacketOf<P>,
    ) -> Result<u16, LidarError> {
        match self {
            Self::Velodyne(decoder) => LidarDecoder::decode_datagram(decoder, payload, arrival, out),
            Self::Straight(decoder, columns) => {
                let lost_before = LidarDecoder::decode_datagram(decoder, payload, arrival, out)?;
                columns.put_straight(out, lost_before);
                Ok(lost_before)
            }
            Self::Hesai(decoder) => LidarDecoder::decode_datagram(decoder, payload, arrival, out),
            Self::Ouster(decoder) => LidarDecoder::decode_datagram(decoder, payload, arrival, out),
            Self::Bridged(decoder) => LidarDecoder::decode_datagram(decoder, payload, arrival, out),
            Self::Livox(decoder) => LidarDecoder::decode_datagram(decoder, payload, arrival, out),
        }
    }

    fn left_out_block(&self) -> Option<LidarError> {
        match self {
            Self::Velodyne(decoder) | Self::Straight(decoder, _) => LidarDecoder::left_out_block(decoder),
            Self::Hesai(decoder) => LidarDecoder::left_out_block(decoder),
            Self::Ouster(decoder) => LidarDecoder::left_out_block(decoder),
            Self::Bridged(decoder) => LidarDecoder::left_out_block(decoder),
            Self::Livox(decoder) => LidarDecoder::left_out_block(decoder),
        }
    }

    fn known_closed_sector(&self) -> Option<ClosedSector> {
        match self {
            Self::Velodyne(decoder) | Self::Straight(decoder, _) => {
                LidarDecoder::known_closed_sector(decoder)
            }
            Self::Hesai(decoder) => LidarDecoder::known_closed_sector(decoder),
            Self::Ouster(decoder) => LidarDecoder::known_closed_sector(decoder),
            Self::Bridged(decoder) => LidarDecoder::known_closed_sector(decoder),
            Self::Livox(decoder) => LidarDecoder::known_closed_sector(decoder),
        }
    }

    fn people_rings(&self) -> Option<RingChoice> {
        match self {
            Self::Velodyne(decoder) | Self::Straight(decoder, _) => LidarDecoder::people_rings(decoder),
            Self::Hesai(decoder) => LidarDecoder::people_rings(decoder),
            Self::Ouster(decoder) => LidarDecoder::people_rings(decoder),
            Self::Bridged(decoder) => LidarDecoder::people_rings(decoder),
            Self::Livox(decoder) => LidarDecoder::people_rings(decoder),
        }
    }

    fn arrange_for_people(&self, packet: &mut LidarPacketOf<P>) {
        match self {
            Self::Velodyne(decoder) | Self::Straight(decoder, _) => {
                LidarDecoder::arrange_for_people(decoder, packet);
            }
            Self::Hesai(decoder) => LidarDecoder::arrange_for_people(decoder, packet),
            Self::Ouster(decoder) => LidarDecoder::arrange_for_people(decoder, packet),
            Self::Bridged(decoder) => LidarDecoder::arrange_for_people(decoder, packet),
            Self::Livox(decoder) => LidarDecoder::arrange_for_people(decoder, packet),
        }
    }
}
