//! What the model of the lidar decides: its decoder, and where its rings look.

use floorguard_drivers::hesai;
use floorguard_drivers::lidar::AnyDecoder;
use floorguard_drivers::velodyne::{self, ModelChoice};
use floorguard_perception::people::RingAngles;

use super::robot::RobotConfiguration;
use super::sources::LidarModel;

impl RobotConfiguration {
    /// The decoder of the lidar's datagrams.
    #[must_use]
    pub fn lidar_decoder(&self) -> AnyDecoder {
        match self.lidar.model {
            LidarModel::PandarXt16 => AnyDecoder::Hesai(hesai::Decoder::new()),
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
            LidarModel::PandarXt16 => RingAngles::pandar_xt16(),
            _ => RingAngles::vlp16(),
        }
    }
}
