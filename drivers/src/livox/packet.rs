//! A datagram of points as a checked view: after [`PointPacket::new_checked`] no accessor can fail.

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use floorguard_types::number::nearest_f32;
use floorguard_types::units::radians;

/// Positions and values; book, Livox: Points.
mod field {
    pub const HEAD_BYTES: usize = 36;
    pub const VERSION: u8 = 0;
    pub const LENGTH: usize = 1;
    pub const INTERVAL: usize = 3;
    pub const POINTS: usize = 5;
    pub const KIND: usize = 10;
    pub const CHECKSUM: usize = 24;
    pub const TIME: usize = 28;
}

/// Points of a datagram at most.
pub const POINTS_MAX: u16 = 96;
/// The interval counts in so many nanoseconds.
const INTERVAL_NS: u64 = 100;

/// CRC-32 of Ethernet and zlib.
static CHECKSUM: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// Why a datagram is none of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PacketError {
    /// Shorter than its head, or not as long as its points ask for.
    Length {
        /// Bytes received.
        found: usize,
        /// Bytes of its head and points.
        needed: usize,
    },
    /// Another version of the protocol than 0.
    Version(u8),
    /// Data of another kind than points: 0 are those of its inertial sensor.
    Kind(u8),
    /// None, or more than [`POINTS_MAX`].
    Points(u16),
    /// The checksum is another: damaged on the way.
    Checksum {
        /// What stands in the datagram.
        found: u32,
        /// What its bytes come to.
        computed: u32,
    },
}

impl core::fmt::Display for PacketError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Length { found, needed } => {
                write!(f, "lidar datagram of {found} bytes; its head and points have {needed}")
            }
            Self::Version(found) => write!(f, "lidar datagram of version {found}; version 0 is understood"),
            Self::Kind(0) => write!(
                f,
                "inertial data of the lidar come to this port; let the lidar send them to another one (56401)"
            ),
            Self::Kind(found) => {
                write!(f, "lidar datagram with data of kind {found}; kinds 1 to 3 are understood")
            }
            Self::Points(found) => write!(f, "lidar datagram of {found} points; the limit is {POINTS_MAX}"),
            Self::Checksum { found, computed } => {
                write!(f, "checksum {found:08x}, the bytes come to {computed:08x}: damaged on the way")
            }
        }
    }
}

impl core::error::Error for PacketError {}

/// How points are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// 14 bytes: three coordinates in millimetres.
    Fine,
    /// 8 bytes: three coordinates in steps of 10 mm.
    Coarse,
    /// 10 bytes: range, zenith angle and azimuth.
    Spherical,
}

impl Kind {
    const fn of(code: u8) -> Option<Self> {
        match code {
            1 => Some(Self::Fine),
            2 => Some(Self::Coarse),
            3 => Some(Self::Spherical),
            _ => None,
        }
    }

    const fn bytes(self) -> usize {
        match self {
            Self::Fine => 14,
            Self::Coarse => 8,
            Self::Spherical => 10,
        }
    }

    fn point(self, bytes: &[u8]) -> Point {
        match self {
            Self::Fine => Point {
                at_mm: [i32_at(bytes, 0), i32_at(bytes, 4), i32_at(bytes, 8)].map(nearest_f32),
                reflectivity: byte_at(bytes, 12),
                tag: byte_at(bytes, 13),
            },
            Self::Coarse => Point {
                at_mm: [i16_at(bytes, 0), i16_at(bytes, 2), i16_at(bytes, 4)]
                    .map(|step| f32::from(step) * 10.0),
                reflectivity: byte_at(bytes, 6),
                tag: byte_at(bytes, 7),
            },
            Self::Spherical => {
                let range_mm = nearest_f32(u32_at(bytes, 0));
                let angle = |at| radians(f32::from(u16_at(bytes, at)) * 0.01);
                let ((sin_z, cos_z), (sin_a, cos_a)) = (libm::sincosf(angle(4)), libm::sincosf(angle(6)));
                Point {
                    at_mm: [range_mm * sin_z * cos_a, range_mm * sin_z * sin_a, range_mm * cos_z],
                    reflectivity: byte_at(bytes, 8),
                    tag: byte_at(bytes, 9),
                }
            }
        }
    }
}

/// Where a beam met something.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Forward, left and up in the sensor's frame, millimetres; all 0 where nothing came back.
    pub at_mm: [f32; 3],
    /// 0…255.
    pub reflectivity: u8,
    /// What the sensor thinks of it: bits for dust, rain, and what lies between two objects.
    pub tag: u8,
}

/// A checked datagram.
///
/// # Invariants
/// 1 to [`POINTS_MAX`] points of one kind; a checksum that is right, or none.
#[derive(Clone, Copy, Debug)]
pub struct PointPacket<'a> {
    bytes: &'a [u8],
    kind: Kind,
}

impl<'a> PointPacket<'a> {
    /// Checks a payload.
    ///
    /// # Errors
    /// [`PacketError`].
    pub fn new_checked(bytes: &'a [u8]) -> Result<Self, PacketError> {
        if bytes.len() < field::HEAD_BYTES {
            return Err(PacketError::Length { found: bytes.len(), needed: field::HEAD_BYTES });
        }
        let version = byte_at(bytes, 0);
        if version != field::VERSION {
            return Err(PacketError::Version(version));
        }
        let code = byte_at(bytes, field::KIND);
        let kind = Kind::of(code).ok_or(PacketError::Kind(code))?;
        let points = u16_at(bytes, field::POINTS);
        if !(1..=POINTS_MAX).contains(&points) {
            return Err(PacketError::Points(points));
        }
        let needed = usize::from(points).saturating_mul(kind.bytes()).saturating_add(field::HEAD_BYTES);
        if bytes.len() != needed || usize::from(u16_at(bytes, field::LENGTH)) != needed {
            return Err(PacketError::Length { found: bytes.len(), needed });
        }
        let found = u32_at(bytes, field::CHECKSUM);
        let computed = CHECKSUM.checksum(bytes.get(field::TIME..).unwrap_or_default());
        // 0: none was written. UDP has one of its own.
        if found != 0 && found != computed {
            return Err(PacketError::Checksum { found, computed });
        }
        Ok(Self { bytes, kind })
    }

    /// The sensor's clock at the first point, nanoseconds: since it was switched on, or of PTP or GPS.
    #[must_use]
    pub fn time_ns(&self) -> u64 {
        let bytes = self.bytes.get(field::TIME..).and_then(<[u8]>::first_chunk::<8>);
        bytes.map_or(0, |bytes| u64::from_le_bytes(*bytes))
    }

    /// From the first to the last point, nanoseconds: below 6.6 ms.
    #[must_use]
    pub fn duration_ns(&self) -> u64 {
        u64::from(u16_at(self.bytes, field::INTERVAL)).saturating_mul(INTERVAL_NS)
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> u16 {
        u16_at(self.bytes, field::POINTS)
    }

    /// Never: there is a point at least.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// The points, in the order of their time.
    pub fn points(&self) -> impl Iterator<Item = Point> + use<'a> {
        let kind = self.kind;
        let bytes = self.bytes.get(field::HEAD_BYTES..).unwrap_or_default();
        bytes.chunks_exact(kind.bytes()).map(move |bytes| kind.point(bytes))
    }
}

/// Beyond the end, here and below: 0.
fn byte_at(bytes: &[u8], at: usize) -> u8 {
    bytes.get(at).copied().unwrap_or(0)
}

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    let found = bytes.get(at..).and_then(<[u8]>::first_chunk::<2>);
    found.map_or(0, |bytes| u16::from_le_bytes(*bytes))
}

fn i16_at(bytes: &[u8], at: usize) -> i16 {
    let found = bytes.get(at..).and_then(<[u8]>::first_chunk::<2>);
    found.map_or(0, |bytes| i16::from_le_bytes(*bytes))
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let found = bytes.get(at..).and_then(<[u8]>::first_chunk::<4>);
    found.map_or(0, |bytes| u32::from_le_bytes(*bytes))
}

fn i32_at(bytes: &[u8], at: usize) -> i32 {
    let found = bytes.get(at..).and_then(<[u8]>::first_chunk::<4>);
    found.map_or(0, |bytes| i32::from_le_bytes(*bytes))
}
