//! One lidar datagram, decoded: a few columns of the range image, each with its own azimuth and stamp.
//!
//! This is what the guard sees first (every 1.33 ms) and what the sweep is assembled from.

use heapless::Vec;

use crate::capacities::PACKET_COLUMNS_MAX;
use crate::profile::{Entry, Keep, Native, Profile, Table, TableOf};
use crate::time::Stamp;

/// Calibrated reflectivity per ring, where the profile keeps it.
pub type Reflectivity<P, S> = <<P as Profile>::Reflectivity as Keep>::Table<u8, S>;

/// All lasers of one firing sequence. Rings are ordered by elevation, 0 lowest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LidarColumnOf<P: Profile> {
    /// Azimuth at the middle of the sequence, hundredths of a degree, 0…35,999, clockwise seen from above as on the
    /// wire; 0 is the sensor's forward (robot axes: x forward).
    pub azimuth_cdeg: u16,
    /// When the first laser of the sequence fired, microseconds after [`LidarPacket::stamp`].
    pub offset_us: u32,
    /// Range per ring in [`LidarPacket::range_unit_mm`]; 0 = no return, which is *unknown*, never free.
    pub range_raw: TableOf<u16, P::Rings>,
    /// Calibrated reflectivity per ring.
    pub reflectivity: Reflectivity<P, P::Rings>,
}

/// A column in the memory of the target.
pub type LidarColumn = LidarColumnOf<Native>;

impl<P: Profile> LidarColumnOf<P> {
    /// A column without a return.
    pub const SILENT: Self =
        Self { azimuth_cdeg: 0, offset_us: 0, range_raw: Entry::BLANK, reflectivity: Entry::BLANK };
}

/// A decoded datagram.
///
/// ```
/// use floorguard_types::sensing::{LidarColumn, LidarPacket, silent_cdeg};
///
/// let mut packet = LidarPacket { rings: 16, ..LidarPacket::EMPTY };
/// for azimuth_cdeg in [35_980, 0, 20] {
///     packet.columns.push(LidarColumn { azimuth_cdeg, ..LidarColumn::SILENT }).unwrap();
/// }
/// // Nothing came back from 0.6°: unknown, not free.
/// assert_eq!(silent_cdeg(&packet), 60);
/// packet.columns[1].range_raw[7] = 1_000;
/// assert_eq!(silent_cdeg(&packet), 0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LidarPacketOf<P: Profile> {
    /// When the first laser fired, on the robot's clock.
    pub stamp: Stamp,
    /// Millimetres per count of `range_raw`: 2, or 4 for a VLP-32C.
    pub range_unit_mm: u8,
    /// Rings in use: 16 or 32. Entries above are zero.
    pub rings: u8,
    /// The firing sequences, in time order.
    pub columns: Vec<LidarColumnOf<P>, PACKET_COLUMNS_MAX>,
}

/// A packet in the memory of the target.
pub type LidarPacket = LidarPacketOf<Native>;

impl<P: Profile> LidarPacketOf<P> {
    /// No columns. A place to decode into.
    pub const EMPTY: Self = Self { stamp: Stamp::ZERO, range_unit_mm: 2, rings: 0, columns: Vec::new() };

    /// Becomes equal to another one without a copy on the way.
    pub fn copy_from(&mut self, other: &Self) {
        (self.stamp, self.range_unit_mm, self.rings) = (other.stamp, other.range_unit_mm, other.rings);
        // The same capacity: it always fits.
        let _ = self.columns.resize(other.columns.len(), LidarColumnOf::SILENT);
        for (to, from) in self.columns.iter_mut().zip(&other.columns) {
            *to = *from;
        }
    }
}

/// Azimuth that a packet covers without a single return, hundredths of a degree; 0 when it has returns.
#[must_use]
pub fn silent_cdeg<P: Profile>(packet: &LidarPacketOf<P>) -> u32 {
    let has_return = packet.columns.iter().any(|column| column.range_raw.iter().any(|raw| *raw != 0));
    match (packet.columns.first(), packet.columns.last()) {
        (Some(first), Some(last)) if !has_return => {
            let span = u32::from(last.azimuth_cdeg)
                .saturating_add(36_000)
                .saturating_sub(u32::from(first.azimuth_cdeg));
            // One column more than the difference of the first and the last.
            (span % 36_000).saturating_add(20)
        }
        _ => 0,
    }
}
