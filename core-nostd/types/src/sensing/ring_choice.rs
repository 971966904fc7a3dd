//! The rings of a large lidar in which people are looked for: as many as a sweep has, and as many again for a second look.

use super::lidar_packet::LidarPacketOf;
use crate::capacities::SWEEP_RINGS;
use crate::profile::{Profile, Table};

/// Rings of a lidar that has more of them than a sweep, lowest first.
///
/// ```
/// use floorguard_types::sensing::{LidarColumn, LidarPacket, RingChoice};
///
/// let every_second = RingChoice::new([1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31]).unwrap();
/// let mut packet = LidarPacket { rings: 32, ..LidarPacket::EMPTY };
/// let mut column = LidarColumn::SILENT;
/// column.range_raw[5] = 1_000;
/// packet.columns.push(column).unwrap();
/// every_second.keep_in(&mut packet);
/// assert_eq!((packet.rings, packet.columns[0].range_raw[2]), (16, 1_000));
/// assert_eq!(packet.columns[0].range_raw[5], 0);
/// // A ring is taken once.
/// assert!(RingChoice::new([0; 16]).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RingChoice {
    rings: [u8; SWEEP_RINGS],
}

impl RingChoice {
    /// These rings; `None` unless each is higher than the one before.
    #[must_use]
    pub fn new(rings: [u8; SWEEP_RINGS]) -> Option<Self> {
        let is_rising = rings.iter().zip(rings.iter().skip(1)).all(|(below, above)| below < above);
        is_rising.then_some(Self { rings })
    }

    /// The rings, lowest first.
    #[must_use]
    pub const fn rings(&self) -> &[u8; SWEEP_RINGS] {
        &self.rings
    }

    /// Leaves these rings in a packet, as its lowest, and takes the others out. Costs its columns.
    pub fn keep_in<P: Profile>(&self, packet: &mut LidarPacketOf<P>) {
        for column in &mut packet.columns {
            keep(&self.rings, column.range_raw.as_mut());
            keep(&self.rings, column.reflectivity.as_mut());
        }
        packet.rings = packet.rings.min(16);
    }

    /// Puts these rings in front, those of a second look behind them, and takes the others out. Rings may be in both. Costs
    /// the columns of the packet. Whatever has no place for twice as many rings keeps the first ones alone.
    pub fn put_before<P: Profile>(&self, second: &Self, packet: &mut LidarPacketOf<P>) {
        for column in &mut packet.columns {
            arrange([&self.rings, &second.rings], column.range_raw.as_mut());
            arrange([&self.rings, &second.rings], column.reflectivity.as_mut());
        }
        packet.rings = 32;
    }
}

/// Entries of both choices, one behind the other.
fn arrange<T: Copy + Default>(choices: [&[u8; SWEEP_RINGS]; 2], entries: &mut [T]) {
    let mut before = [T::default(); 2 * SWEEP_RINGS];
    for (to, from) in before.iter_mut().zip(entries.iter()) {
        *to = *from;
    }
    let rings = choices.into_iter().flatten();
    for (entry, ring) in entries.iter_mut().zip(rings) {
        *entry = before.get(usize::from(*ring)).copied().unwrap_or_default();
    }
}

/// Moves the chosen entries to the front and clears the rest. Each moves down or stays, so none is overwritten before it
/// was moved.
fn keep<T: Copy + Default>(rings: &[u8; SWEEP_RINGS], entries: &mut [T]) {
    for (to, ring) in rings.iter().enumerate() {
        let from = entries.get(usize::from(*ring)).copied().unwrap_or_default();
        if let Some(entry) = entries.get_mut(to) {
            *entry = from;
        }
    }
    for entry in entries.iter_mut().skip(rings.len()) {
        *entry = T::default();
    }
}
