//! Assembles revolutions: cut where the azimuth passes the cut angle, never by counting packets.

use floorguard_core::sensing::{LidarColumn, LidarPacket, Sweep, SweepColumn};
use floorguard_core::time::Stamp;

/// Where revolutions are cut, and what the builder remembers between packets.
#[derive(Clone, Copy, Debug)]
pub struct SweepBuilder {
    cut_cdeg: u16,
    /// Azimuth of the newest column, counted from the cut.
    last_cdeg: Option<u16>,
    /// Newest rotation from column to column, hundredths of a degree.
    step_cdeg: u16,
    /// Duration from column to column, microseconds.
    step_us: u32,
    /// The head turns so slowly that firings share columns.
    slow_head: bool,
}

/// A head this slow (mean rotation from firing to firing) fires more often than a sweep has columns: at 300 rpm 3,617
/// times a revolution, 10 cdeg apart, against 20 cdeg at 600 rpm.
const SLOW_HEAD_CDEG: u32 = 18;
/// Firings of a slow head closer together than this share a column, so that 1,800 columns are enough at any speed.
const MERGE_CDEG: u32 = 20;
/// Columns that a gap may hold: one revolution.
const GAP_COLUMNS_MAX: u16 = 1_824;

impl SweepBuilder {
    /// A builder that cuts where the azimuth passes `cut_cdeg` (0…35,999). Behind the robot is a good place.
    #[must_use]
    pub const fn new(cut_cdeg: u16) -> Self {
        Self { cut_cdeg: cut_cdeg % 36_000, last_cdeg: None, step_cdeg: 20, step_us: 55, slow_head: false }
    }

    /// Adds a packet before which `lost_packets` are missing. `complete` is called with each revolution that ends
    /// within it (normally none or one); it may swap the content away. The missed sector is entered as columns about
    /// which nothing is known.
    pub fn add<const RINGS: usize>(
        &mut self,
        packet: &LidarPacket,
        lost_packets: u16,
        building: &mut Sweep<RINGS>,
        mut complete: impl FnMut(&mut Sweep<RINGS>),
    ) {
        let columns_per_packet = packet.columns.len() as u16;
        self.learn_steps(packet);
        let missing = lost_packets.saturating_mul(columns_per_packet).min(GAP_COLUMNS_MAX);
        if self.last_cdeg.is_some() {
            self.enter_gap(missing, packet.stamp, building, &mut complete);
        }
        building.lost_packets = building.lost_packets.saturating_add(lost_packets);
        for column in &packet.columns {
            let stamp = packet.stamp.plus_micros(u64::from(column.offset_us));
            self.enter(column.azimuth_cdeg, stamp, building, &mut complete);
            if !(self.slow_head && merge(building, column)) {
                push(building, stamp, packet.range_unit_mm, |slot| fill(slot, column));
            }
        }
        building.packets = building.packets.saturating_add(1);
    }

    fn learn_steps(&mut self, packet: &LidarPacket) {
        self.slow_head = mean_step_cdeg(packet) < SLOW_HEAD_CDEG;
        let mut columns = packet.columns.iter();
        if let (Some(first), Some(second)) = (columns.next(), columns.next()) {
            let turned = (u32::from(second.azimuth_cdeg) + 36_000 - u32::from(first.azimuth_cdeg)) % 36_000;
            self.step_cdeg = u16::try_from(turned).unwrap_or(20).clamp(1, 200);
            self.step_us = second.offset_us.saturating_sub(first.offset_us).max(1);
        }
    }

    fn enter_gap<const RINGS: usize>(
        &mut self,
        missing: u16,
        end: Stamp,
        building: &mut Sweep<RINGS>,
        complete: &mut impl FnMut(&mut Sweep<RINGS>),
    ) {
        for index in 0..missing.min(GAP_COLUMNS_MAX) {
            let last = self.last_cdeg.unwrap_or(0);
            let from_cut = (u32::from(last) + u32::from(self.step_cdeg)) % 36_000;
            let azimuth_cdeg = ((from_cut + u32::from(self.cut_cdeg)) % 36_000) as u16;
            let before_end = u64::from(missing.saturating_sub(index)) * u64::from(self.step_us);
            let stamp = end.minus_micros(before_end);
            self.enter(azimuth_cdeg, stamp, building, complete);
            if self.slow_head && index % 2 == 1 {
                continue;
            }
            let unit = building.range_unit_mm;
            push(building, stamp, unit, |slot| {
                *slot = SweepColumn { azimuth_cdeg, ..SweepColumn::UNKNOWN };
            });
        }
    }

    /// Completes the revolution if `azimuth_cdeg` lies behind the cut.
    fn enter<const RINGS: usize>(
        &mut self,
        azimuth_cdeg: u16,
        stamp: Stamp,
        building: &mut Sweep<RINGS>,
        complete: &mut impl FnMut(&mut Sweep<RINGS>),
    ) {
        let from_cut = ((u32::from(azimuth_cdeg) + 36_000 - u32::from(self.cut_cdeg)) % 36_000) as u16;
        let passed = self.last_cdeg.is_some_and(|last| last > from_cut && last - from_cut > 18_000);
        self.last_cdeg = Some(from_cut);
        if passed && building.column_count > 0 {
            complete(building);
            clear(building);
        }
        if building.column_count == 0 {
            building.stamp = stamp;
        }
    }
}

/// Mean rotation from column to column of a packet; that of a normal head where the packet cannot tell.
fn mean_step_cdeg(packet: &LidarPacket) -> u32 {
    let steps = packet.columns.len().saturating_sub(1) as u32;
    match (packet.columns.first(), packet.columns.last()) {
        (Some(first), Some(last)) => (u32::from(last.azimuth_cdeg) + 36_000 - u32::from(first.azimuth_cdeg))
            .wrapping_rem(36_000)
            .checked_div(steps)
            .unwrap_or(20),
        _ => 20,
    }
}

/// Forgets the content without touching the columns.
fn clear<const RINGS: usize>(sweep: &mut Sweep<RINGS>) {
    sweep.column_count = 0;
    sweep.packets = 0;
    sweep.lost_packets = 0;
    sweep.dropped_columns = 0;
}

fn push<const RINGS: usize>(
    sweep: &mut Sweep<RINGS>,
    stamp: Stamp,
    range_unit_mm: u8,
    write: impl FnOnce(&mut SweepColumn<RINGS>),
) {
    let start = sweep.stamp;
    let Some(slot) = sweep.columns.get_mut(sweep.column_count) else {
        sweep.dropped_columns = sweep.dropped_columns.saturating_add(1);
        return;
    };
    write(slot);
    slot.offset_us = u32::try_from(stamp.as_micros().saturating_sub(start.as_micros())).unwrap_or(u32::MAX);
    sweep.column_count += 1;
    sweep.end_stamp = stamp;
    sweep.range_unit_mm = range_unit_mm;
}

/// Enters a firing into the newest column if it is that close to it; of two returns the nearer one stays.
fn merge<const RINGS: usize>(sweep: &mut Sweep<RINGS>, column: &LidarColumn) -> bool {
    let Some(slot) = sweep.column_count.checked_sub(1).and_then(|newest| sweep.columns.get_mut(newest))
    else {
        return false;
    };
    let turned = (u32::from(column.azimuth_cdeg) + 36_000 - u32::from(slot.azimuth_cdeg)) % 36_000;
    if !slot.measured || turned >= MERGE_CDEG {
        return false;
    }
    let held = slot.range_raw.iter_mut().zip(slot.reflectivity.iter_mut());
    for ((range, brightness), (raw, reflectivity)) in
        held.zip(column.range_raw.iter().zip(&column.reflectivity))
    {
        if *raw != 0 && (*range == 0 || *raw < *range) {
            (*range, *brightness) = (*raw, *reflectivity);
        }
    }
    true
}

fn fill<const RINGS: usize>(slot: &mut SweepColumn<RINGS>, column: &LidarColumn) {
    slot.azimuth_cdeg = column.azimuth_cdeg;
    slot.measured = true;
    for (to, from) in slot.range_raw.iter_mut().zip(&column.range_raw) {
        *to = *from;
    }
    for (to, from) in slot.reflectivity.iter_mut().zip(&column.reflectivity) {
        *to = *from;
    }
}
