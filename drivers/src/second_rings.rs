//! Rings in which people are looked for a second time: they wait until the guard has judged the others.

use floorguard_types::capacities::{PACKET_COLUMNS_MAX, SWEEP_RINGS};
use floorguard_types::profile::{Profile, Size};
use floorguard_types::sensing::{LidarColumnOf, LidarPacketOf};

/// What the rings above the sixteenth saw in the newest packet.
#[derive(Clone, Debug)]
pub(crate) struct SecondRings<P: Profile> {
    columns: heapless::Vec<LidarColumnOf<P>, PACKET_COLUMNS_MAX>,
}

impl<P: Profile> SecondRings<P> {
    pub(crate) const EMPTY: Self = Self { columns: heapless::Vec::new() };

    /// A packet has a place for them.
    pub(crate) const FIT: bool = P::Rings::N >= 2 * SWEEP_RINGS;

    /// There are none in the newest packet.
    pub(crate) fn forget(&mut self) {
        self.columns.clear();
    }

    /// Takes them out of a packet, which keeps the others. Costs its columns.
    pub(crate) fn take_from(&mut self, packet: &mut LidarPacketOf<P>) {
        self.columns.clear();
        for column in &mut packet.columns {
            // As many as in a packet.
            let _ = self.columns.push(*column);
            column.range_raw.as_mut().iter_mut().skip(SWEEP_RINGS).for_each(|raw| *raw = 0);
            column.reflectivity.as_mut().iter_mut().skip(SWEEP_RINGS).for_each(|seen| *seen = 0);
        }
        packet.rings = packet.rings.min(16);
    }

    /// Puts them back into the packet out of which they were taken.
    pub(crate) fn put_into(&self, packet: &mut LidarPacketOf<P>) {
        if self.columns.is_empty() {
            return;
        }
        for (to, from) in packet.columns.iter_mut().zip(&self.columns) {
            put_behind(to.range_raw.as_mut(), from.range_raw.as_ref());
            put_behind(to.reflectivity.as_mut(), from.reflectivity.as_ref());
        }
        packet.rings = 32;
    }
}

fn put_behind<T: Copy>(to: &mut [T], from: &[T]) {
    for (to, from) in to.iter_mut().zip(from).skip(SWEEP_RINGS) {
        *to = *from;
    }
}
