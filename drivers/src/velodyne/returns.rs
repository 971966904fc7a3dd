//! The single returns of a packet, each with its own azimuth, time and place: for people who want every point.

use floorguard_types::geometry::Point3;
use floorguard_types::number::{truncating_i64, truncating_u8, truncating_u16, truncating_u32};
use floorguard_types::units::centidegrees_to_radians;

use super::closed_sector::PacketTurn;
use super::model::{Model, NativeAngles};
use super::packet::Packet;

/// One echo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// Nanoseconds after the stamp of the packet.
    pub offset_ns: u32,
    /// Block of the packet, 0…11.
    pub block: u8,
    /// Laser, in the order of the wire.
    pub laser: u8,
    /// Azimuth rounded to hundredths of a degree, 0…35,999, clockwise.
    pub azimuth_cdeg: u16,
    /// Counts of the model's unit, > 0.
    pub distance_raw: u16,
    /// Calibrated reflectivity.
    pub reflectivity: u8,
    /// Metres in the sensor's frame: x forward, y left, z up.
    pub point_in_sensor: Point3,
}

/// Which echoes of a dual-return packet to give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReturnsOf {
    /// An echo that stands in both blocks of a pair once.
    DistinctEchoes,
    /// Every cell of every block.
    AllCells,
}

/// Gives the returns of packets of one model; holds the sines of its lasers.
///
/// ```
/// use floorguard_drivers::velodyne::{Model, Packet, Returns, ReturnsOf};
///
/// let mut bytes = [0; 1_206];
/// bytes[..1_200].chunks_exact_mut(100).for_each(|block| block[..2].copy_from_slice(&[0xFF, 0xEE]));
/// // Laser 15 looks 15° upwards; its origin lies 11.2 mm below the middle.
/// bytes[4 + 15 * 3..][..2].copy_from_slice(&5_000_u16.to_le_bytes());
/// bytes[1_204..].copy_from_slice(&[0x37, 0x22]);
/// let packet = Packet::new_checked(&bytes).unwrap();
/// let mut points = Vec::new();
/// Returns::new(Model::Vlp16).for_each(&packet, ReturnsOf::AllCells, |each| points.push(each.point_in_sensor));
/// let [point] = points[..] else { panic!("one return") };
/// assert!((point.x_m - 9.659_3).abs() < 1.0e-3 && (point.z_m - 2.577).abs() < 1.0e-3);
/// ```
#[derive(Clone, Debug)]
pub struct Returns {
    model: Model,
    angles: NativeAngles,
}

impl Returns {
    /// For one model; computes 32 sines.
    #[must_use]
    pub fn new(model: Model) -> Self {
        Self { model, angles: model.angles() }
    }

    /// Of which model.
    #[must_use]
    pub const fn model(&self) -> Model {
        self.model
    }

    /// Calls `each` for every return of the packet whose direction is known, in the order of the wire. At most 384.
    pub fn for_each(&self, packet: &Packet<'_>, of: ReturnsOf, mut each: impl FnMut(Return)) {
        let dual = packet.is_dual();
        let turns = packet.turns();
        let skipped_us =
            PacketTurn::new(&turns, self.model.block_ns(), dual).map_or(0, |packet| packet.skipped_us);
        let mut later_ns = 0;
        let mut previous = None;
        for ((index, block), turn) in packet.blocks().enumerate().zip(turns) {
            let Some(block_cdeg) = turn.azimuth_cdeg else { continue };
            if turn.skipped_cdeg > 0 {
                later_ns = skipped_us.saturating_mul(1_000);
            }
            let second_of_pair = dual && index % 2 == 1;
            let time_step = truncating_u32(if dual { index / 2 } else { index });
            let first = if second_of_pair { previous } else { None };
            for (channel, (distance_raw, reflectivity)) in block.channels().enumerate() {
                let repeated = of == ReturnsOf::DistinctEchoes
                    && first.is_some_and(|first: super::packet::Block<'_>| {
                        first.channels().nth(channel).is_some_and(|(raw, _)| raw == distance_raw)
                    });
                if distance_raw == 0 || repeated {
                    continue;
                }
                let within_ns = self.within_block_ns(channel);
                each(
                    self.place(
                        Cell { block: truncating_u8(index), channel, distance_raw, reflectivity },
                        block_cdeg,
                        (turn.gap_cdeg, within_ns),
                        time_step
                            .saturating_mul(self.model.block_ns())
                            .saturating_add(within_ns)
                            .saturating_add(later_ns),
                    ),
                );
            }
            previous = Some(block);
        }
    }

    /// From the start of the block to the channel's laser, nanoseconds.
    fn within_block_ns(&self, channel: usize) -> u32 {
        let lasers = self.model.lasers();
        // 16 or 32: never zero.
        let (sequence, laser) = (channel / lasers, channel % lasers);
        truncating_u32(sequence)
            .saturating_mul(self.model.sequence_ns())
            .saturating_add(self.model.laser_ns(laser))
    }

    fn place(&self, cell: Cell, block_cdeg: u16, rotation: (u16, u32), offset_ns: u32) -> Return {
        let laser = cell.channel % self.model.lasers();
        let angles = self.angles.get(laser).copied().unwrap_or_default();
        let (gap_cdeg, within_ns) = rotation;
        let turned = u64::from(gap_cdeg) * u64::from(within_ns);
        let block_ns = u64::from(self.model.block_ns().max(1));
        let rounded = (turned + block_ns / 2) / block_ns;
        let sum = i64::from(block_cdeg) + truncating_i64(rounded) + i64::from(angles.azimuth_cdeg);
        let azimuth_cdeg = truncating_u16(sum.rem_euclid(36_000));
        let range_m = f32::from(cell.distance_raw) * f32::from(self.model.range_unit_mm()) * 1.0e-3;
        let (sin, cos) = libm::sincosf(centidegrees_to_radians(azimuth_cdeg));
        let horizontal_m = range_m * angles.cos;
        Return {
            offset_ns,
            block: cell.block,
            laser: truncating_u8(laser),
            azimuth_cdeg,
            distance_raw: cell.distance_raw,
            reflectivity: cell.reflectivity,
            point_in_sensor: Point3::new(
                horizontal_m * cos,
                -horizontal_m * sin,
                range_m * angles.sin + angles.height_m,
            ),
        }
    }
}

struct Cell {
    block: u8,
    channel: usize,
    distance_raw: u16,
    reflectivity: u8,
}
