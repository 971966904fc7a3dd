//! What differs between the models: angles, times, units. Source: book, Velodyne.

use floorguard_types::number::count_u32;
use floorguard_types::profile::{Entry, Native, Profile, Size, Table, TableOf};
use floorguard_types::units::radians;

/// A lidar model.
///
/// ```
/// use floorguard_drivers::velodyne::Model;
///
/// assert_eq!(Model::from_product_byte(0x22), Some(Model::Vlp16));
/// assert_eq!((Model::Vlp16.lasers(), Model::Vlp16.range_unit_mm()), (16, 2));
/// // Laser 1 looks 1° upwards, ring 8 from the bottom.
/// let laser = Model::Vlp16.angles()[1];
/// assert_eq!((laser.elevation_deg, laser.ring), (1.0, 8));
/// assert_eq!(Model::Vlp16.packet_us(false), 1_327);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Model {
    /// VLP-16 and Puck LITE.
    Vlp16,
    /// Puck Hi-Res.
    HiRes,
    /// VLP-32C.
    Vlp32C,
    /// HDL-32E.
    Hdl32E,
}

/// Sine and cosine of a laser's elevation, and what is added to azimuth and height.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaserAngles {
    /// Elevation, degrees.
    pub elevation_deg: f32,
    /// Sine of the elevation.
    pub sin: f32,
    /// Cosine of the elevation.
    pub cos: f32,
    /// Height of the laser's virtual origin, metres, added to z.
    pub height_m: f32,
    /// Added to the interpolated azimuth, hundredths of a degree.
    pub azimuth_cdeg: i16,
    /// Position from the bottom, 0 lowest.
    pub ring: u8,
}

impl Entry for LaserAngles {
    const BLANK: Self =
        Self { elevation_deg: 0.0, sin: 0.0, cos: 0.0, height_m: 0.0, azimuth_cdeg: 0, ring: 0 };
}

/// The lasers of the largest lidar of the target.
type Lasers = <Native as Profile>::Rings;
/// Angles of the lasers of the largest lidar of the target.
pub type NativeAngles = TableOf<LaserAngles, Lasers>;

const VLP16_DEG: [f32; 16] =
    [-15.0, 1.0, -13.0, 3.0, -11.0, 5.0, -9.0, 7.0, -7.0, 9.0, -5.0, 11.0, -3.0, 13.0, -1.0, 15.0];
/// Two thirds of the VLP-16's: ±10° in steps of 1.333°.
const HI_RES_DEG: [f32; 16] = [
    -10.0, 0.667, -8.667, 2.0, -7.333, 3.333, -6.0, 4.667, -4.667, 6.0, -3.333, 7.333, -2.0, 8.667, -0.667,
    10.0,
];
const VLP32C_DEG: [f32; 32] = [
    -25.0, -1.0, -1.667, -15.639, -11.31, 0.0, -0.667, -8.843, -7.254, 0.333, -0.333, -6.148, -5.333, 1.333,
    0.667, -4.0, -4.667, 1.667, 1.0, -3.667, -3.333, 3.333, 2.333, -2.667, -3.0, 7.0, 4.667, -2.333, -2.0,
    15.0, 10.333, -1.333,
];
const VLP32C_AZIMUTH_CDEG: [i16; 32] = [
    140, -420, 140, -140, 140, -140, 420, -140, 140, -420, 140, -140, 420, -140, 420, -140, 140, -420, 140,
    -420, 420, -140, 140, -140, 140, -140, 140, -420, 420, -140, 140, -140,
];
const HDL32E_DEG: [f32; 32] = [
    -30.67, -9.33, -29.33, -8.0, -28.0, -6.67, -26.67, -5.33, -25.33, -4.0, -24.0, -2.67, -22.67, -1.33,
    -21.33, 0.0, -20.0, 1.33, -18.67, 2.67, -17.33, 4.0, -16.0, 5.33, -14.67, 6.67, -13.33, 8.0, -12.0, 9.33,
    -10.67, 10.67,
];

impl Model {
    /// The model that a product byte names. Early VLP-16 firmware writes the HDL-32E's: see [`detect_model`].
    #[must_use]
    pub const fn from_product_byte(byte: u8) -> Option<Self> {
        match byte {
            0x21 => Some(Self::Hdl32E),
            0x22 => Some(Self::Vlp16),
            0x24 => Some(Self::HiRes),
            0x28 => Some(Self::Vlp32C),
            _ => None,
        }
    }

    /// Name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vlp16 => "VLP-16",
            Self::HiRes => "Puck Hi-Res",
            Self::Vlp32C => "VLP-32C",
            Self::Hdl32E => "HDL-32E",
        }
    }

    /// Lasers of one firing sequence: 16 or 32.
    #[must_use]
    pub const fn lasers(self) -> usize {
        match self {
            Self::Vlp16 | Self::HiRes => 16,
            Self::Vlp32C | Self::Hdl32E => 32,
        }
    }

    /// Firing sequences in one data block.
    #[must_use]
    pub const fn sequences_per_block(self) -> usize {
        32 / self.lasers()
    }

    /// Millimetres per count of distance.
    #[must_use]
    pub const fn range_unit_mm(self) -> u8 {
        match self {
            Self::Vlp32C => 4,
            _ => 2,
        }
    }

    /// From one firing sequence to the next, nanoseconds.
    #[must_use]
    pub const fn sequence_ns(self) -> u32 {
        match self {
            Self::Hdl32E => 46_080,
            _ => 55_296,
        }
    }

    /// From the start of its sequence to laser `laser`, nanoseconds.
    #[must_use]
    pub const fn laser_ns(self, laser: usize) -> u32 {
        let laser = count_u32(laser) & 31;
        match self {
            Self::Vlp16 | Self::HiRes => 2_304 * laser,
            Self::Vlp32C => 2_304 * (laser / 2),
            Self::Hdl32E => 1_152 * laser,
        }
    }

    /// From one block of a single-return packet to the next, nanoseconds.
    #[must_use]
    pub const fn block_ns(self) -> u32 {
        self.sequence_ns() * count_u32(self.sequences_per_block())
    }

    /// From one single-return packet to the next, microseconds, rounded.
    #[must_use]
    pub const fn packet_us(self, dual: bool) -> u32 {
        let blocks = if dual { 6 } else { 12 };
        (self.block_ns() * blocks + 500) / 1_000
    }

    /// Angles of every laser, in the order of the wire; entries above [`Self::lasers`] are zero, lasers above the
    /// capacity are left out. 32 sines: compute
    /// once.
    #[must_use]
    pub fn angles(self) -> NativeAngles {
        self.angles_of::<Lasers>()
    }

    /// The same for so many lasers.
    pub(super) fn angles_of<S: Size>(self) -> TableOf<LaserAngles, S> {
        let (elevations, origin_mm): (&[f32], f32) = match self {
            Self::Vlp16 => (&VLP16_DEG, 41.91),
            Self::HiRes => (&HI_RES_DEG, 41.91),
            Self::Vlp32C => (&VLP32C_DEG, 42.4),
            Self::Hdl32E => (&HDL32E_DEG, 28.83),
        };
        let mut angles = <TableOf<LaserAngles, S>>::BLANK;
        for (laser, (angle, elevation_deg)) in angles.iter_mut().zip(elevations).enumerate() {
            let (sin, cos) = libm::sincosf(radians(*elevation_deg));
            let below = elevations.iter().filter(|other| **other < *elevation_deg).count();
            let azimuth_cdeg = match self {
                Self::Vlp32C => VLP32C_AZIMUTH_CDEG.get(laser).copied().unwrap_or(0),
                _ => 0,
            };
            *angle = LaserAngles {
                elevation_deg: *elevation_deg,
                sin,
                cos,
                // No elevation reaches ±90°, so the cosine is never zero.
                height_m: -origin_mm * 1.0e-3 * sin / cos,
                azimuth_cdeg,
                ring: u8::try_from(below).unwrap_or(0),
            };
        }
        angles
    }

    /// Angles of every ring, 0 lowest: the order of the columns. Entries above [`Self::lasers`] are zero.
    #[must_use]
    pub fn ring_angles(self) -> NativeAngles {
        let mut rings = NativeAngles::BLANK;
        for angle in self.angles().into_iter().take(self.lasers()) {
            if let Some(ring) = rings.get_mut(usize::from(angle.ring)) {
                *ring = angle;
            }
        }
        rings
    }
}

/// Tells an early VLP-16 (product byte 0x21) from an HDL-32E by the time between two consecutive packets,
/// microseconds: 1,327 or 663 against 553 or 276. `None` where neither fits, for instance across a lost packet.
///
/// ```
/// use floorguard_drivers::velodyne::{Model, detect_model};
///
/// assert_eq!(detect_model(0x21, 1_327), Some(Model::Vlp16));
/// assert_eq!(detect_model(0x21, 553), Some(Model::Hdl32E));
/// assert_eq!(detect_model(0x21, 40_000), None);
/// ```
#[must_use]
pub fn detect_model(product_byte: u8, packet_period_us: u32) -> Option<Model> {
    /// Stamps are rounded to microseconds and packets do not wander.
    const TOLERANCE_US: u32 = 30;
    if product_byte != 0x21 {
        return Model::from_product_byte(product_byte);
    }
    [(Model::Vlp16, false), (Model::Vlp16, true), (Model::Hdl32E, false), (Model::Hdl32E, true)]
        .into_iter()
        .find(|(model, dual)| model.packet_us(*dual).abs_diff(packet_period_us) <= TOLERANCE_US)
        .map(|(model, _)| model)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_has_its_byte_and_its_name() {
        let known = [
            (0x21, Model::Hdl32E, "HDL-32E"),
            (0x22, Model::Vlp16, "VLP-16"),
            (0x24, Model::HiRes, "Puck Hi-Res"),
            (0x28, Model::Vlp32C, "VLP-32C"),
        ];
        for (byte, model, name) in known {
            assert_eq!((Model::from_product_byte(byte), model.name()), (Some(model), name));
        }
        assert_eq!(Model::from_product_byte(0x23), None);
    }

    /// The early VLP-16 calls itself an HDL-32E, its packets come less than half as often.
    #[test]
    fn packet_period_identifies_an_early_model() {
        for (period_us, model) in [
            (1_327, Some(Model::Vlp16)),
            (663, Some(Model::Vlp16)),
            (553, Some(Model::Hdl32E)),
            (276, Some(Model::Hdl32E)),
            (1_327 + 31, None),
            (1_327 - 31, None),
            (2_654, None),
        ] {
            assert_eq!(detect_model(0x21, period_us), model, "{period_us}");
        }
        assert_eq!(detect_model(0x28, 1_327), Some(Model::Vlp32C), "any other byte is believed");
        assert_eq!(detect_model(0x99, 1_327), None);
    }

    /// Even channels of an HDL-32E rise from the bottom in steps of 4/3°, odd ones from -9.33°.
    #[test]
    fn hdl_32e_lasers_rise_in_two_rows() {
        for (row, angles) in (0_u8..).zip(Model::Hdl32E.angles().chunks(2)) {
            for (angle, from_deg) in angles.iter().zip([-92.0 / 3.0, -28.0 / 3.0]) {
                let expected_deg = from_deg + f32::from(row) * 4.0 / 3.0;
                assert!((angle.elevation_deg - expected_deg).abs() < 0.01, "{row}: {angle:?}");
            }
        }
    }

    /// The lasers of a VLP-32C from the bottom, and where their columns lie: 4.2° to the left or right of
    /// the head's direction, the others 1.4°, even channels to one side and odd ones to the other.
    #[test]
    fn vlp_32c_lasers_lie_in_four_columns() {
        let angles = Model::Vlp32C.angles();
        let mut elevations_mdeg = angles.map(|angle| libm::roundf(angle.elevation_deg * 1_000.0) as i32);
        elevations_mdeg.sort_unstable();
        let from_below = [
            -25_000, -15_639, -11_310, -8_843, -7_254, -6_148, -5_333, -4_667, -4_000, -3_667, -3_333,
            -3_000, -2_667, -2_333, -2_000, -1_667, -1_333, -1_000, -667, -333, 0, 333, 667, 1_000, 1_333,
            1_667, 2_333, 3_333, 4_667, 7_000, 10_333, 15_000,
        ];
        assert_eq!(elevations_mdeg, from_below);
        for (channel, angle) in angles.iter().enumerate() {
            let expected_cdeg = match channel {
                6 | 12 | 14 | 20 | 28 => 420,
                1 | 9 | 17 | 19 | 27 => -420,
                even if even.is_multiple_of(2) => 140,
                _ => -140,
            };
            assert_eq!(angle.azimuth_cdeg, expected_cdeg, "{channel}");
        }
    }
}
