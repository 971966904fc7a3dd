//! What the model of the lidar decides: its decoder, and where its rings look.

use floorguard_drivers::hesai;
use floorguard_drivers::lidar::{AnyDecoder, StraightColumns};
use floorguard_drivers::velodyne::{self, Model, ModelChoice};
use floorguard_perception::people::RingAngles;
use floorguard_types::capacities::{PACKET_RINGS_MAX, SWEEP_RINGS};
use floorguard_types::number::truncating_u8;

use super::robot::RobotConfiguration;
use super::sources::LidarModel;

impl RobotConfiguration {
    /// The decoder of the lidar's datagrams. It takes no lidar with other rings than [`Self::lidar_elevations_deg`] tells.
    #[must_use]
    pub fn lidar_decoder(&self) -> AnyDecoder {
        match self.lidar.model {
            LidarModel::PandarXt16 => AnyDecoder::Hesai(hesai::Decoder::new().with_lasers_max(16)),
            _ => {
                let choice = self.lidar_model().map_or(ModelChoice::Auto, ModelChoice::Fixed);
                let lasers = self.lidar_model().map_or(SWEEP_RINGS, Model::lasers);
                let decoder = velodyne::Decoder::new(choice).with_lasers_max(truncating_u8(lasers));
                match self.lidar_model() {
                    Some(model @ Model::Vlp32C) => AnyDecoder::Straight(decoder, StraightColumns::new(model)),
                    _ => AnyDecoder::Velodyne(decoder),
                }
            }
        }
    }

    /// Elevations of all rings, degrees, lowest first; as many as the capacity. A PandarXT-16 has those of a VLP-16
    /// (book, Hesai: Angles).
    #[must_use]
    pub fn lidar_elevations_deg(&self) -> heapless::Vec<f32, PACKET_RINGS_MAX> {
        let model = self.lidar_model().unwrap_or(Model::Vlp16);
        let angles = model.ring_angles();
        angles.iter().take(model.lasers()).map(|angle| angle.elevation_deg).take(PACKET_RINGS_MAX).collect()
    }

    /// Elevation and height of the rings of a sweep. 16 sines: compute once.
    #[must_use]
    pub fn ring_angles(&self) -> RingAngles {
        match self.lidar.model {
            LidarModel::PuckHiRes => RingAngles::even(-10.0, 4.0 / 3.0),
            LidarModel::PandarXt16 => RingAngles::pandar_xt16(),
            LidarModel::Vlp32c => chosen(Model::Vlp32C),
            LidarModel::Hdl32e => chosen(Model::Hdl32E),
            LidarModel::Auto | LidarModel::Vlp16 => RingAngles::vlp16(),
        }
    }
}

/// The angles of those rings of a model that go into a sweep.
fn chosen(model: Model) -> RingAngles {
    let angles = model.ring_angles();
    let mut sweep = RingAngles::vlp16();
    let choice = model.people_rings();
    let rings = choice.iter().flat_map(|choice| choice.rings());
    for (slot, ring) in sweep.rings.iter_mut().zip(rings) {
        if let Some(angle) = angles.get(usize::from(*ring)) {
            *slot = (angle.sin, angle.cos, angle.height_m);
        }
    }
    sweep
}
