//! Beams of one column look to different sides: their returns wait here until the column at which they look is complete.

use floorguard_types::profile::{Profile, Table};
use floorguard_types::sensing::LidarColumnOf;

use super::beams::SPREAD_MAX;

/// A place for a column at which some beams have looked already.
#[derive(Clone, Copy, Debug)]
struct Slot<P: Profile> {
    /// Which column, counted since the first packet.
    column: u64,
    /// A measured column looked there, with or without a return.
    is_measured: bool,
    returns: LidarColumnOf<P>,
}

/// The columns that are not complete yet.
#[derive(Clone, Debug)]
pub(super) struct Staggered<P: Profile> {
    slots: [Slot<P>; SPREAD_MAX],
}

impl<P: Profile> Staggered<P> {
    pub(super) const EMPTY: Self = Self {
        slots: [Slot { column: u64::MAX, is_measured: false, returns: LidarColumnOf::SILENT }; SPREAD_MAX],
    };

    /// The place of a column; what an older one left there is gone.
    fn slot(&mut self, column: u64) -> Option<&mut Slot<P>> {
        let place = column.checked_rem(SPREAD_MAX_U64).and_then(|place| usize::try_from(place).ok());
        let slot = self.slots.get_mut(place?)?;
        if slot.column != column {
            *slot = Slot { column, is_measured: false, returns: LidarColumnOf::SILENT };
        }
        Some(slot)
    }

    /// A measured beam looked there, with its return in raw counts or without one.
    pub(super) fn enter(&mut self, column: u64, ring: usize, seen: Option<(u16, u8)>) {
        let Some(slot) = self.slot(column) else { return };
        slot.is_measured = true;
        let Some((raw, reflectivity)) = seen else { return };
        if let Some(range) = slot.returns.range_raw.get_mut(ring) {
            *range = raw;
        }
        if let Some(brightness) = slot.returns.reflectivity.get_mut(ring) {
            *brightness = reflectivity;
        }
    }

    /// What was seen there; `None` where nothing was measured.
    pub(super) fn take(&mut self, column: u64) -> Option<LidarColumnOf<P>> {
        let slot = self.slot(column)?;
        core::mem::take(&mut slot.is_measured).then_some(slot.returns)
    }
}

const SPREAD_MAX_U64: u64 = 64;
const _: () = assert!(SPREAD_MAX == 64);
