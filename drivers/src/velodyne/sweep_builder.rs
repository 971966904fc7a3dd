//! Assembles revolutions: cut where the azimuth passes the cut angle, never by counting packets.
//!
//! A sector that was not measured is found by the azimuth that the head turned meanwhile, whatever the reason (packets
//! lost, refused, or a sensor that is configured to skip a sector), and entered as columns about which nothing is
//! known, so that neighbours in the image are neighbours in space.
//!
//! Limit: a sweep of 16 rings takes the lowest 16 of a lidar of 32; use `Sweep<32>` for those.

use floorguard_types::number::{truncating_u16, truncating_u32};
use floorguard_types::profile::{Profile, Table};
use floorguard_types::sensing::{LidarColumnOf, LidarPacketOf, SweepColumnOf, SweepOf};
use floorguard_types::time::Stamp;

/// Where revolutions are cut, and what the builder remembers between packets.
///
/// ```
/// use floorguard_drivers::velodyne::SweepBuilder;
/// use floorguard_types::sensing::{LidarColumn, LidarPacket, Sweep};
/// use floorguard_types::time::Stamp;
///
/// // 24 columns of 0.2° in each packet: 75 packets a revolution.
/// let packet = |number: u16| {
///     let mut packet = LidarPacket { rings: 16, ..LidarPacket::EMPTY };
///     packet.stamp = Stamp::from_micros(u64::from(number) * 1_327);
///     for column in 0..24 {
///         let azimuth_cdeg = ((u32::from(number) * 480 + column * 20) % 36_000) as u16;
///         packet.columns.push(LidarColumn { azimuth_cdeg, ..LidarColumn::SILENT }).unwrap();
///     }
///     packet
/// };
/// let mut builder = SweepBuilder::new(0);
/// let mut sweep = Sweep::<16>::EMPTY;
/// let mut columns = Vec::new();
/// for number in 0..151 {
///     builder.add(&packet(number), 0, &mut sweep, |whole| columns.push(whole.column_count));
/// }
/// assert_eq!(columns.last(), Some(&1_800));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SweepBuilder {
    cut_cdeg: u16,
    /// Azimuth of the newest column, counted from the cut.
    last_cdeg: Option<u16>,
    /// Mean rotation from column to column in the newest packet, hundredths of a degree, ≥ 1.
    step_cdeg: u32,
    /// When the newest column was measured.
    last_stamp: Stamp,
    /// How firings share columns.
    sharing: Sharing,
    /// Rotation within the newest packet, hundredths of a degree, and in how many steps.
    speed: (u32, u32),
}

/// How firings share columns: a head that turns slowly fires more often than a sweep has columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sharing {
    /// Every firing has its own.
    None,
    /// Those that fall into the same 20 cdeg of the turn, while the rest would not fit: at 590 rpm one of a hundred.
    SamePlace,
    /// Those within 20 cdeg of the first of the column: at 300 rpm, 10 cdeg apart, every second one.
    Near,
}

impl Sharing {
    /// Of a packet whose columns turn by `turned_cdeg` in `steps` steps. A sweep has room for 1,824 firings, 19.74 cdeg
    /// apart (595 rpm), and the head's speed wavers; at 600 rpm they are 19.91 cdeg apart.
    const fn of(turned_cdeg: u32, steps: u32) -> Self {
        // At most 24 steps of 200 cdeg.
        let turned = turned_cdeg.saturating_mul(100);
        if turned < steps.saturating_mul(1_750) {
            Self::Near
        } else if turned < steps.saturating_mul(1_979) {
            Self::SamePlace
        } else {
            Self::None
        }
    }
}

/// Firings of a slow head closer together than this share a column, so that 1,800 columns are enough at any speed.
const MERGE_CDEG: u32 = 20;
/// Share of the speed that the whole hundredths of a degree of one packet leave in doubt: one part in this many.
const SPEED_DOUBT: u32 = 192;
/// Columns that a gap may hold: two revolutions of a head at 600 rpm.
const GAP_COLUMNS_MAX: u32 = 3_648;
/// The head jitters; a step back by less than this is no turn of almost 360 degrees.
const JITTER_CDEG: u32 = 500;
const TURN_CDEG: u32 = 36_000;
/// A step from column to column is no longer than this, hundredths of a degree: 1,200 rpm and two sequences left out.
const STEP_MAX_CDEG: u32 = 200;

impl SweepBuilder {
    /// A builder that cuts where the azimuth passes `cut_cdeg` (0…35,999). Behind the robot is a good place.
    #[must_use]
    pub const fn new(cut_cdeg: u16) -> Self {
        Self {
            cut_cdeg: cut_cdeg % 36_000,
            last_cdeg: None,
            step_cdeg: 20,
            last_stamp: Stamp::ZERO,
            sharing: Sharing::None,
            speed: (0, 0),
        }
    }

    /// Adds a packet before which `lost_packets` are missing. `complete` is called with each revolution that ends
    /// within it (normally none or one); it may swap the content away. The missed sector is entered as columns about
    /// which nothing is known.
    pub fn add<P: Profile, const RINGS: usize>(
        &mut self,
        packet: &LidarPacketOf<P>,
        lost_packets: u16,
        building: &mut SweepOf<P, RINGS>,
        mut complete: impl FnMut(&mut SweepOf<P, RINGS>),
    ) {
        let (turned_cdeg, steps) = steps_of(packet);
        self.step_cdeg = mean_step_cdeg(turned_cdeg, steps).clamp(1, 200);
        self.sharing = Sharing::of(turned_cdeg, steps);
        self.speed = (turned_cdeg, steps);
        let missing = u32::from(lost_packets).saturating_mul(truncating_u32(packet.columns.len()));
        if let Some(first) = packet.columns.first() {
            self.enter_gap((missing, first.azimuth_cdeg), packet.stamp, building, &mut complete);
        }
        building.lost_packets = building.lost_packets.saturating_add(lost_packets);
        for column in &packet.columns {
            let stamp = packet.stamp.plus_micros(u64::from(column.offset_us));
            // A block was left out, or a sector is closed.
            if self.is_gap(column.azimuth_cdeg) {
                self.enter_gap((0, column.azimuth_cdeg), stamp, building, &mut complete);
            }
            self.enter(column.azimuth_cdeg, stamp, building, &mut complete);
            self.last_stamp = stamp;
            if !(self.shares(building, column) && merge(building, column)) {
                push(building, stamp, packet.range_unit_mm, |slot| fill(slot, column));
            }
        }
        building.packets = building.packets.saturating_add(1);
    }

    /// The newest column takes this firing, too.
    fn shares<P: Profile, const RINGS: usize>(
        &self,
        building: &SweepOf<P, RINGS>,
        column: &LidarColumnOf<P>,
    ) -> bool {
        if self.sharing == Sharing::None {
            return false;
        }
        let newest = building.column_count.checked_sub(1).and_then(|newest| building.columns.get(newest));
        let Some(newest) = newest.filter(|newest| newest.measured) else { return false };
        let place =
            |cdeg: u16| (u32::from(cdeg) + TURN_CDEG - u32::from(self.cut_cdeg)) % TURN_CDEG / MERGE_CDEG;
        let turned_cdeg =
            (u32::from(column.azimuth_cdeg) + TURN_CDEG - u32::from(newest.azimuth_cdeg)) % TURN_CDEG;
        match self.sharing {
            Sharing::None => false,
            Sharing::SamePlace => {
                self.is_short(building, column) && place(column.azimuth_cdeg) == place(newest.azimuth_cdeg)
            }
            Sharing::Near => turned_cdeg < MERGE_CDEG,
        }
    }

    /// At this speed the rest of the turn does not fit into the rest of the columns, with two to spare.
    fn is_short<P: Profile, const RINGS: usize>(
        &self,
        building: &SweepOf<P, RINGS>,
        column: &LidarColumnOf<P>,
    ) -> bool {
        let from_cut = (u32::from(column.azimuth_cdeg) + TURN_CDEG - u32::from(self.cut_cdeg)) % TURN_CDEG;
        let left =
            truncating_u32(building.columns.len().saturating_sub(building.column_count).saturating_sub(2));
        let (turned_cdeg, steps) = self.speed;
        let needed = TURN_CDEG.saturating_sub(from_cut).saturating_mul(steps);
        // The speed within one packet is known to half a per cent.
        left.saturating_mul(turned_cdeg) < needed - needed / SPEED_DOUBT
    }

    /// More than half a column is missing between the newest one and the next.
    fn is_gap(&self, next_cdeg: u16) -> bool {
        let Some(last) = self.last_cdeg else { return false };
        let newest_cdeg = u32::from(self.cut_cdeg) + u32::from(last);
        // At most two turns and a bit: subtractions cost the board less than a division for each column.
        let from_newest = u32::from(next_cdeg) + 2 * TURN_CDEG - newest_cdeg;
        let within_two = if from_newest >= 2 * TURN_CDEG { from_newest - 2 * TURN_CDEG } else { from_newest };
        let turned_cdeg = if within_two >= TURN_CDEG { within_two - TURN_CDEG } else { within_two };
        let spacing_cdeg = self.step_cdeg.max(MERGE_CDEG);
        turned_cdeg > spacing_cdeg + spacing_cdeg / 2
    }

    /// Enters unknown columns between the newest column and the next, evenly in azimuth and time; `missing` columns are
    /// known to be missing.
    fn enter_gap<P: Profile, const RINGS: usize>(
        &mut self,
        (missing, next_cdeg): (u32, u16),
        next: Stamp,
        building: &mut SweepOf<P, RINGS>,
        complete: &mut impl FnMut(&mut SweepOf<P, RINGS>),
    ) {
        let Some(last) = self.last_cdeg else { return };
        let last_cdeg = (u32::from(last) + u32::from(self.cut_cdeg)) % TURN_CDEG;
        let turned_cdeg = self.turned_cdeg(last_cdeg, u32::from(next_cdeg), missing);
        // Steps of a packet alternate by rounding; a gap is more than half a column too many.
        let spacing_cdeg = if self.sharing == Sharing::None { self.step_cdeg } else { MERGE_CDEG };
        let columns = (turned_cdeg.saturating_add(spacing_cdeg / 2) / spacing_cdeg.max(1)).saturating_sub(1);
        let (from, until) = (self.last_stamp.as_micros(), next.as_micros());
        let between_us = until.saturating_sub(from);
        for index in 1..=columns.min(GAP_COLUMNS_MAX) {
            let share = |whole: u64| whole.saturating_mul(u64::from(index)) / (u64::from(columns) + 1);
            let turned = share(u64::from(turned_cdeg)) % u64::from(TURN_CDEG);
            let azimuth_cdeg = truncating_u16((u64::from(last_cdeg) + turned) % u64::from(TURN_CDEG));
            let stamp = Stamp::from_micros(from).plus_micros(share(between_us));
            self.enter(azimuth_cdeg, stamp, building, complete);
            let unit = building.range_unit_mm;
            push(building, stamp, unit, |slot| {
                *slot = SweepColumnOf { azimuth_cdeg, ..SweepColumnOf::UNKNOWN };
            });
        }
    }

    /// How far the head turned from the newest column to the next packet: the azimuths tell it up to whole turns, the
    /// missing columns tell whether there was one. At most two turns, the longest history in use.
    fn turned_cdeg(&self, last_cdeg: u32, first_cdeg: u32, missing: u32) -> u32 {
        let within_turn = (first_cdeg + TURN_CDEG).saturating_sub(last_cdeg) % TURN_CDEG;
        let expected = missing.saturating_add(1).saturating_mul(self.step_cdeg);
        if within_turn > TURN_CDEG - JITTER_CDEG && expected < TURN_CDEG / 2 {
            return 0;
        }
        if expected > within_turn.saturating_add(TURN_CDEG / 2) {
            within_turn + TURN_CDEG
        } else {
            within_turn
        }
    }

    /// Completes the revolution if `azimuth_cdeg` lies behind the cut.
    fn enter<P: Profile, const RINGS: usize>(
        &mut self,
        azimuth_cdeg: u16,
        stamp: Stamp,
        building: &mut SweepOf<P, RINGS>,
        complete: &mut impl FnMut(&mut SweepOf<P, RINGS>),
    ) {
        let from_cut = truncating_u16((u32::from(azimuth_cdeg) + 36_000 - u32::from(self.cut_cdeg)) % 36_000);
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

/// Rotation from column to column of a packet, without what it leaves out: the sum, hundredths of a degree, and of how
/// many steps.
fn steps_of<P: Profile>(packet: &LidarPacketOf<P>) -> (u32, u32) {
    let mut sum = (0_u32, 0_u32);
    let next = packet.columns.iter().skip(1);
    for (column, next) in packet.columns.iter().zip(next) {
        let turned_cdeg =
            (u32::from(next.azimuth_cdeg) + TURN_CDEG - u32::from(column.azimuth_cdeg)) % TURN_CDEG;
        if turned_cdeg <= STEP_MAX_CDEG {
            sum = (sum.0.saturating_add(turned_cdeg), sum.1.saturating_add(1));
        }
    }
    sum
}

/// Mean rotation from column to column, rounded; that of a normal head where the packet cannot tell. Cut off instead,
/// 19.9 would become 19 and a gap of 24 columns would be filled with 25.
fn mean_step_cdeg(turned_cdeg: u32, steps: u32) -> u32 {
    turned_cdeg.saturating_add(steps / 2).checked_div(steps).unwrap_or(20)
}

/// Forgets the content without touching the columns.
fn clear<P: Profile, const RINGS: usize>(sweep: &mut SweepOf<P, RINGS>) {
    sweep.column_count = 0;
    sweep.packets = 0;
    sweep.lost_packets = 0;
    sweep.dropped_columns = 0;
}

fn push<P: Profile, const RINGS: usize>(
    sweep: &mut SweepOf<P, RINGS>,
    stamp: Stamp,
    range_unit_mm: u8,
    write: impl FnOnce(&mut SweepColumnOf<P, RINGS>),
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

/// Enters a firing into the newest column; of two returns the nearer one stays. False if there is none.
fn merge<P: Profile, const RINGS: usize>(sweep: &mut SweepOf<P, RINGS>, column: &LidarColumnOf<P>) -> bool {
    let Some(slot) = sweep.column_count.checked_sub(1).and_then(|newest| sweep.columns.get_mut(newest))
    else {
        return false;
    };
    for (ring, (range, raw)) in slot.range_raw.iter_mut().zip(column.range_raw.iter()).enumerate() {
        if *raw != 0 && (*range == 0 || *raw < *range) {
            *range = *raw;
            if let (Some(to), Some(from)) = (slot.reflectivity.get_mut(ring), column.reflectivity.get(ring)) {
                *to = *from;
            }
        }
    }
    true
}

fn fill<P: Profile, const RINGS: usize>(slot: &mut SweepColumnOf<P, RINGS>, column: &LidarColumnOf<P>) {
    slot.azimuth_cdeg = column.azimuth_cdeg;
    slot.measured = true;
    for (to, from) in slot.range_raw.iter_mut().zip(column.range_raw.iter()) {
        *to = *from;
    }
    for (to, from) in slot.reflectivity.iter_mut().zip(column.reflectivity.iter()) {
        *to = *from;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::sensing::{LidarColumn, LidarPacket, Sweep};

    /// Columns of a packet that turn evenly from one azimuth to another.
    fn packet_of(columns: usize, from_cdeg: u16, turned_cdeg: u16) -> LidarPacket {
        let mut packet = LidarPacket::EMPTY;
        packet.columns.resize(columns, LidarColumn::SILENT).expect("room");
        let last = (columns as u32 - 1).max(1);
        for (number, column) in packet.columns.iter_mut().enumerate() {
            column.azimuth_cdeg = from_cdeg + (u32::from(turned_cdeg) * number as u32 / last) as u16;
        }
        packet
    }

    #[test]
    fn the_mean_step_is_rounded() {
        let mean = |turned_cdeg| {
            let (turned_cdeg, steps) = steps_of(&packet_of(24, 100, turned_cdeg));
            mean_step_cdeg(turned_cdeg, steps)
        };
        assert_eq!((mean(457), mean(448)), (20, 19), "19.87 and 19.48");
    }

    #[test]
    fn how_far_the_head_turned() {
        let builder = SweepBuilder::new(0);
        assert_eq!(builder.turned_cdeg(100, 120, 0), 20);
        assert_eq!(builder.turned_cdeg(100, 90, 0), 0, "jitter");
        assert_eq!(builder.turned_cdeg(600, 100, 0), 35_500, "as far back as no jitter is");
        assert_eq!(builder.turned_cdeg(100, 90, 899), 35_990, "half a turn is missing");
        assert_eq!(builder.turned_cdeg(100, 120, 900), 20, "half a turn too much is none");
        assert_eq!(builder.turned_cdeg(100, 120, 901), 36_020);
    }

    #[test]
    fn jittering_head_does_not_end_a_turn() {
        let mut building = Sweep::<16>::EMPTY;
        let mut builder = SweepBuilder::new(0);
        let mut ended = 0;
        for azimuth_cdeg in [20_000, 19_990, 35_990, 10, 0, 35_990] {
            builder.enter(azimuth_cdeg, Stamp::ZERO, &mut building, &mut |_| ended += 1);
            building.column_count = 1;
        }
        assert_eq!(ended, 1);
        let mut builder = SweepBuilder::new(0);
        for azimuth_cdeg in [18_000, 0] {
            builder.enter(azimuth_cdeg, Stamp::ZERO, &mut building, &mut |_| ended += 1);
        }
        assert_eq!(ended, 1, "exactly half a turn is no sign of one");
    }

    #[test]
    fn more_than_half_a_column_is_a_gap() {
        for (turned_cdeg, columns) in [(29, 0), (30, 1), (39, 1), (49, 1), (50, 2)] {
            let mut building = Sweep::<16>::EMPTY;
            let mut builder = SweepBuilder::new(0);
            builder.last_cdeg = Some(0);
            builder.enter_gap((0, turned_cdeg), Stamp::ZERO, &mut building, &mut |_| ());
            assert_eq!(building.column_count, columns, "{turned_cdeg}");
        }
    }
}
