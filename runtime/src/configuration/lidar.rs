//! What the model of the lidar decides: its decoder, and where its rings look.

use floorguard_drivers::lidar::{AnyDecoder, StraightColumns};
use floorguard_drivers::velodyne::{self, Model, ModelChoice};
use floorguard_drivers::{hesai, lidar_link, livox, ouster};
use floorguard_perception::people::RingAngles;
use floorguard_types::capacities::{PACKET_RINGS_MAX, SWEEP_RINGS};
use floorguard_types::number::{count_f32, truncating_u8};
use floorguard_types::sensing::RingChoice;
use floorguard_types::units::radians;

use super::robot::RobotConfiguration;
use super::sources::LidarModel;

impl RobotConfiguration {
    /// The decoder of the lidar's datagrams. It takes no lidar with other rings than [`Self::lidar_elevations_deg`] tells.
    #[must_use]
    pub fn lidar_decoder(&self) -> AnyDecoder {
        match self.lidar.model {
            LidarModel::PandarXt16 => AnyDecoder::Hesai(hesai::Decoder::new().with_lasers_max(16)),
            LidarModel::PandarXt32 => {
                AnyDecoder::Hesai(hesai::Decoder::new().with_lasers_max(16).every_second_of_32())
            }
            LidarModel::Ouster(beams) => {
                let mut decoder = ouster::Decoder::new(beams);
                decoder.set_second_look();
                AnyDecoder::Ouster(decoder)
            }
            LidarModel::Bridged(elevations) => {
                AnyDecoder::Bridged(lidar_link::Decoder::new(truncating_u8(elevations.len())))
            }
            LidarModel::LivoxMid360(elevations) => AnyDecoder::Livox(livox::Decoder::new(elevations)),
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
        if let LidarModel::Ouster(beams) = self.lidar.model {
            let rings = beams.rings(SWEEP_RINGS.min(PACKET_RINGS_MAX));
            return rings.iter().map(|channel| beams.elevation_deg(*channel)).collect();
        }
        if let LidarModel::Bridged(elevations) | LidarModel::LivoxMid360(elevations) = self.lidar.model {
            return elevations.iter().map(|mdeg| *mdeg as f32 * 1.0e-3).collect();
        }
        let model = self.lidar_model().unwrap_or(Model::Vlp16);
        let angles = model.ring_angles();
        angles.iter().take(model.lasers()).map(|angle| angle.elevation_deg).take(PACKET_RINGS_MAX).collect()
    }

    /// The same of the rings in which people are looked for a second time, which lie between the others and about the
    /// horizon; `None` for a lidar without other rings than those of a sweep. 16 sines: compute once.
    #[must_use]
    pub fn second_ring_angles(&self) -> Option<RingAngles> {
        match self.lidar.model {
            LidarModel::PandarXt32 => Some(level(|ring| -16.0 + 2.0 * count_f32(ring))),
            LidarModel::Vlp32c => {
                Model::Vlp32C.second_people_rings().map(|choice| angles_of(Model::Vlp32C, choice))
            }
            LidarModel::Hdl32e => {
                Model::Hdl32E.second_people_rings().map(|choice| angles_of(Model::Hdl32E, choice))
            }
            LidarModel::Ouster(beams) => {
                let rings = beams.second_rings();
                (!rings.is_empty()).then(|| ouster_angles(beams, &rings))
            }
            _ => None,
        }
    }

    /// Elevation and height of the rings of a sweep. 16 sines: compute once.
    #[must_use]
    pub fn ring_angles(&self) -> RingAngles {
        match self.lidar.model {
            LidarModel::PuckHiRes => RingAngles::even(-10.0, 4.0 / 3.0),
            LidarModel::PandarXt16 | LidarModel::PandarXt32 => RingAngles::pandar_xt16(),
            LidarModel::Vlp32c => chosen(Model::Vlp32C),
            LidarModel::Hdl32e => chosen(Model::Hdl32E),
            LidarModel::Auto | LidarModel::Vlp16 => RingAngles::vlp16(),
            LidarModel::Ouster(beams) => ouster_angles(beams, &beams.rings(SWEEP_RINGS)),
            LidarModel::Bridged(elevations) | LidarModel::LivoxMid360(elevations) => {
                let ring = |mdeg: i32| libm::sincosf(radians(mdeg as f32 * 1.0e-3));
                RingAngles { rings: elevations.map(ring).map(|(sin, cos)| (sin, cos, 0.0)) }
            }
        }
    }
}

/// The angles of those rings of a model that go into a sweep.
fn chosen(model: Model) -> RingAngles {
    model.people_rings().map_or_else(RingAngles::vlp16, |choice| angles_of(model, choice))
}

/// The angles of chosen rings of a model.
fn angles_of(model: Model, choice: RingChoice) -> RingAngles {
    let angles = model.ring_angles();
    let mut sweep = RingAngles::NONE;
    for (slot, ring) in sweep.rings.iter_mut().zip(choice.rings()) {
        if let Some(angle) = angles.get(usize::from(*ring)) {
            *slot = (angle.sin, angle.cos, angle.height_m);
        }
    }
    sweep
}

/// Of lasers that leave from one point, by the elevation of each ring in degrees.
fn level(elevation_deg: impl Fn(usize) -> f32) -> RingAngles {
    let mut angles = RingAngles::NONE;
    for (index, ring) in angles.rings.iter_mut().enumerate() {
        let (sin, cos) = libm::sincosf(radians(elevation_deg(index)));
        *ring = (sin, cos, 0.0);
    }
    angles
}

/// Of the beams that are used.
fn ouster_angles(beams: &ouster::Beams, channels: &[u8]) -> RingAngles {
    let mut angles = RingAngles::NONE;
    for (ring, channel) in angles.rings.iter_mut().zip(channels) {
        let (sin, cos) = libm::sincosf(radians(beams.elevation_deg(*channel)));
        *ring = (sin, cos, beams.height_m(*channel));
    }
    angles
}
