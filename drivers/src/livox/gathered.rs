//! Points of one turn, gathered by direction, and given out as a lidar would that turns: column by column, clockwise.
//!
//! A column shows what came back from its direction since it was given out before, so at most a turn ago. Of several returns in a
//! cell the nearest is kept: for a stop the near one counts.

use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::number::{count_u64, short_usize, truncating_u16, truncating_u32, truncating_usize};
use floorguard_types::profile::Profile;
use floorguard_types::sensing::{LidarColumnOf, LidarPacketOf};

use super::packet::Point;
use super::rings::{Rings, column_of};

/// Columns of a turn: 0.9° each, so that at 200,000 points a second most cells have a return.
pub const COLUMNS_A_TURN: usize = 400;
/// The time of a turn, microseconds.
pub const TURN_US: u64 = 100_000;
/// From column to column, nanoseconds.
const COLUMN_NS: u64 = 250_000;
/// From column to column, hundredths of a degree.
const COLUMN_CDEG: u16 = 90;
const _: () = assert!(COLUMN_NS * count_u64(COLUMNS_A_TURN) == TURN_US * 1_000);
const _: () = assert!(short_usize(COLUMN_CDEG) * COLUMNS_A_TURN == 36_000);
/// Columns of a packet at most.
const PACKET_COLUMNS: u64 = 24;

/// What came back from one direction.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    /// 0: nothing.
    range_raw: u16,
    reflectivity: u8,
}

/// The columns of a turn.
#[derive(Clone, Debug)]
pub(super) struct Gathered {
    columns: [[Cell; SWEEP_RINGS]; COLUMNS_A_TURN],
    /// Since the sensor's time 0: the one that is given out next.
    next: u64,
    /// From here on a column has been gathered for a whole turn.
    complete_from: u64,
}

impl Gathered {
    pub const fn new() -> Self {
        Self {
            columns: [[Cell { range_raw: 0, reflectivity: 0 }; SWEEP_RINGS]; COLUMNS_A_TURN],
            next: 0,
            complete_from: 0,
        }
    }

    /// Begins with a sensor's time, nanoseconds: nothing is known.
    pub fn begin(&mut self, time_ns: u64) {
        for column in &mut self.columns {
            *column = [Cell::default(); SWEEP_RINGS];
        }
        self.next = time_ns / COLUMN_NS;
        self.complete_from = self.next.saturating_add(count_u64(COLUMNS_A_TURN));
    }

    /// Takes in a point.
    pub fn take(&mut self, point: &Point, rings: &Rings) {
        let Some(placed) = rings.place(point) else { return };
        let column = self.columns.get_mut(column_of(placed.azimuth_cdeg, COLUMNS_A_TURN));
        let Some(cell) = column.and_then(|column| column.get_mut(placed.ring)) else { return };
        if cell.range_raw == 0 || placed.range_raw < cell.range_raw {
            *cell = Cell { range_raw: placed.range_raw, reflectivity: point.reflectivity };
        }
    }

    /// A whole turn has been gathered.
    pub const fn is_complete(&self) -> bool {
        self.next >= self.complete_from
    }

    /// Gives out the columns that are due by a time of the sensor, nanoseconds, the oldest first, and forgets what they hold. Gives
    /// the time of the first one. Where more are due than a packet holds, the oldest are left out: they stay unknown for a turn.
    pub fn give<P: Profile>(&mut self, until_ns: u64, out: &mut LidarPacketOf<P>) -> u64 {
        out.columns.clear();
        let end = until_ns / COLUMN_NS;
        let turn = count_u64(COLUMNS_A_TURN);
        let from = end.saturating_sub(PACKET_COLUMNS).max(self.next);
        let late = self.next.max(from.saturating_sub(turn));
        for step in 0..COLUMNS_A_TURN {
            let number = late.saturating_add(count_u64(step));
            if number >= from {
                break;
            }
            self.empty(number);
        }
        for step in 0..PACKET_COLUMNS {
            let number = from.saturating_add(step);
            if number >= end {
                break;
            }
            let cells = self.empty(number);
            let place = truncating_u16(number.checked_rem(turn).unwrap_or(0));
            let offset_us = number.saturating_sub(from).saturating_mul(COLUMN_NS) / 1_000;
            let mut column = LidarColumnOf::<P> {
                azimuth_cdeg: place.saturating_mul(COLUMN_CDEG).saturating_add(COLUMN_CDEG / 2),
                offset_us: truncating_u32(offset_us),
                ..LidarColumnOf::SILENT
            };
            for (range_raw, cell) in column.range_raw.as_mut().iter_mut().zip(&cells) {
                *range_raw = cell.range_raw;
            }
            for (reflectivity, cell) in column.reflectivity.as_mut().iter_mut().zip(&cells) {
                *reflectivity = cell.reflectivity;
            }
            // At most 24 columns, the capacity.
            let _full = out.columns.push(column);
        }
        self.next = end.max(self.next);
        from.saturating_mul(COLUMN_NS)
    }

    /// What a column holds, which is forgotten.
    fn empty(&mut self, number: u64) -> [Cell; SWEEP_RINGS] {
        let place = truncating_usize(number.checked_rem(count_u64(COLUMNS_A_TURN)).unwrap_or(0));
        self.columns.get_mut(place).map(core::mem::take).unwrap_or_default()
    }
}
