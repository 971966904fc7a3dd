//! Sweeps for display: points out of the raw datagrams, apart from the robot's own tasks.

use floorguard_drivers::lidar::{AnyDecoder, LidarDecoder};
use floorguard_drivers::velodyne::SweepBuilder;
use floorguard_perception::people::RingAngles;
use floorguard_types::sensing::{LidarPacket, Sweep};
use floorguard_types::time::Stamp;

use super::messages::PointRow;

/// Revolutions are cut behind the robot, hundredths of a degree.
const CUT_CDEG: u16 = 18_000;

/// Collects datagrams into sweeps.
pub struct LidarView {
    decoder: AnyDecoder,
    packet: LidarPacket,
    builder: SweepBuilder,
    building: Box<Sweep>,
    angles: RingAngles,
    every: u32,
    sweeps: u32,
}

impl LidarView {
    /// Gives every `every`-th sweep; 0: none.
    pub fn new(decoder: AnyDecoder, angles: RingAngles, every: u32) -> Self {
        Self {
            decoder,
            packet: LidarPacket::EMPTY,
            builder: SweepBuilder::new(CUT_CDEG),
            building: Box::new(Sweep::EMPTY),
            angles,
            every,
            sweeps: 0,
        }
    }

    /// A datagram; the points of a sweep when it completes one that is wanted, in the lidar's frame.
    pub fn push(&mut self, datagram: &[u8], arrival: Stamp) -> Option<(Stamp, Vec<PointRow>)> {
        if self.every == 0 {
            return None;
        }
        let lost = self.decoder.decode_datagram(datagram, arrival, &mut self.packet).ok()?;
        if let Some(rings) = self.decoder.people_rings() {
            rings.keep_in(&mut self.packet);
        }
        let Self { packet, builder, building, angles, every, sweeps, .. } = self;
        let mut found = None;
        builder.add(packet, lost, building, |sweep| {
            *sweeps = sweeps.wrapping_add(1);
            if *sweeps % *every == 0 {
                found = Some((sweep.stamp, points(sweep, angles)));
            }
        });
        found
    }
}

/// All returns of a sweep in the sensor's frame: x forward, y left, z up.
pub fn points(sweep: &Sweep, angles: &RingAngles) -> Vec<PointRow> {
    let unit_m = f32::from(sweep.range_unit_mm) * 1.0e-3;
    let mut points = Vec::new();
    for column in sweep.used_columns().iter().filter(|column| column.measured) {
        let (sin, cos) = libm::sincosf(f32::from(column.azimuth_cdeg).to_radians() / 100.0);
        let cells = column.range_raw.iter().zip(&column.reflectivity).zip(&angles.rings);
        for (ring, ((raw, reflectivity), (up, along, height_m))) in (0_u16..).zip(cells) {
            if *raw == 0 {
                continue;
            }
            let range_m = f32::from(*raw) * unit_m;
            points.push(PointRow {
                position_m: [range_m * along * cos, -range_m * along * sin, range_m * up + height_m],
                reflectivity: *reflectivity,
                ring,
                time_s: column.offset_us as f32 * 1.0e-6,
            });
        }
    }
    points
}
