//! What the model of the lidar decides: its decoder, and where its rings look.

use floorguard_drivers::lidar::AnyDecoder;
use floorguard_drivers::velodyne::{self, ModelChoice};
use floorguard_drivers::{hesai, lidar_link, ouster};
use floorguard_perception::people::RingAngles;
use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::number::truncating_u8;
use floorguard_types::units::radians;

use super::robot::RobotConfiguration;
use super::sources::LidarModel;

impl RobotConfiguration {
    /// The decoder of the lidar's datagrams.
    #[must_use]
    pub fn lidar_decoder(&self) -> AnyDecoder {
        match self.lidar.model {
            LidarModel::PandarXt16 => AnyDecoder::Hesai(hesai::Decoder::new()),
            LidarModel::PandarXt32 => AnyDecoder::Hesai(hesai::Decoder::new().every_second_of_32()),
            LidarModel::Ouster(beams) => {
                let mut decoder = ouster::Decoder::new(beams);
                decoder.set_rings_max(SWEEP_RINGS);
                AnyDecoder::Ouster(decoder)
            }
            LidarModel::Bridged(elevations) => {
                AnyDecoder::Bridged(lidar_link::Decoder::new(truncating_u8(elevations.len())))
            }
            _ => {
                let choice = self.lidar_model().map_or(ModelChoice::Auto, ModelChoice::Fixed);
                AnyDecoder::Velodyne(velodyne::Decoder::new(choice))
            }
        }
    }

    /// Elevation and height of the rings of a sweep. 16 sines: compute once.
    #[must_use]
    pub fn ring_angles(&self) -> RingAngles {
        match self.lidar.model {
            LidarModel::PuckHiRes => RingAngles::even(-10.0, 4.0 / 3.0),
            LidarModel::PandarXt16 | LidarModel::PandarXt32 => RingAngles::pandar_xt16(),
            LidarModel::Ouster(beams) => ouster_angles(beams),
            LidarModel::Bridged(elevations) => {
                let ring = |mdeg: i32| libm::sincosf(radians(mdeg as f32 * 1.0e-3));
                RingAngles { rings: elevations.map(ring).map(|(sin, cos)| (sin, cos, 0.0)) }
            }
            _ => RingAngles::vlp16(),
        }
    }
}

/// Of the beams that are used.
fn ouster_angles(beams: &ouster::Beams) -> RingAngles {
    let mut angles = RingAngles::NONE;
    for (ring, channel) in angles.rings.iter_mut().zip(&beams.rings(SWEEP_RINGS)) {
        let (sin, cos) = libm::sincosf(radians(beams.elevation_deg(*channel)));
        *ring = (sin, cos, beams.height_m(*channel));
    }
    angles
}
