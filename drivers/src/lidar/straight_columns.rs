//! Columns of a lidar whose lasers look beside their column, put straight: each cell of a column is then measured at the
//! column's own azimuth.
//!
//! The lasers of a VLP-32C look up to 4.2° to either side, 15 cm at 2 m (book, Velodyne: Laser angles). A cell is taken from
//! the firing in which its laser looked where the column looks, so a column is ready when the head has turned 4.2°
//! farther: 1.2 ms at 600 turns a minute. A laser of which there is no such firing has no return there: unknown.

use floorguard_types::number::{nearest_f32, saturating_i16};
use floorguard_types::profile::{Entry, Profile, Table, TableOf};
use floorguard_types::sensing::{LidarColumnOf, LidarPacketOf};
use floorguard_types::time::Stamp;

use crate::velodyne::Model;

/// Firings that are kept: 8.4° at 300 turns a minute, and two packets.
const KEPT: usize = 128;
const TURN_CDEG: i32 = 36_000;
/// A longer pause between two packets leaves a gap in the columns, microseconds: a packet lasts 664.
const PAUSE_US: u64 = 1_500;

/// Firings from which straight columns are made.
#[derive(Clone, Debug)]
pub struct StraightColumns<P: Profile> {
    /// By how much each ring looks beside its column, hundredths of a degree.
    beside_cdeg: TableOf<i16, P::Rings>,
    /// The greatest of them, to either side.
    widest_cdeg: i32,
    kept: heapless::Vec<(Stamp, LidarColumnOf<P>), KEPT>,
    /// How many of the kept ones have become columns.
    done: usize,
}

impl<P: Profile> StraightColumns<P> {
    /// For a lidar of that model.
    #[must_use]
    pub fn new(model: Model) -> Self {
        let mut beside_cdeg = <TableOf<i16, P::Rings>>::BLANK;
        let mut widest_cdeg = 0;
        for (to, angle) in beside_cdeg.iter_mut().zip(model.ring_angles().iter().take(model.lasers())) {
            *to = angle.azimuth_cdeg;
            widest_cdeg = widest_cdeg.max(i32::from(angle.azimuth_cdeg).abs());
        }
        Self { beside_cdeg, widest_cdeg, kept: heapless::Vec::new(), done: 0 }
    }

    /// Takes the firings of a packet in and leaves in it the columns that are ready, often as many. Costs their cells.
    pub fn put_straight(&mut self, packet: &mut LidarPacketOf<P>, lost_before: u16) {
        let newest = self.kept.last().map(|(stamp, _)| *stamp);
        if lost_before > 0 || newest.is_some_and(|newest| is_apart(newest, packet.stamp)) {
            self.kept.clear();
            self.done = 0;
        }
        self.make_space(packet.columns.len());
        for column in &packet.columns {
            let stamp = packet.stamp.plus_micros(u64::from(column.offset_us));
            // Space was made.
            let _ = self.kept.push((stamp, *column));
        }
        packet.columns.clear();
        self.hand_out(packet);
    }

    /// Forgets the oldest firings, so that so many more fit.
    fn make_space(&mut self, more: usize) {
        let surplus = self.kept.len().saturating_add(more).saturating_sub(KEPT);
        if surplus > 0 {
            let count = self.kept.len().saturating_sub(surplus);
            let oldest = surplus.min(self.kept.len());
            self.kept.rotate_left(oldest);
            self.kept.truncate(count);
            self.done = self.done.saturating_sub(surplus);
        }
    }

    /// The columns that the newest firing has made ready.
    fn hand_out(&mut self, packet: &mut LidarPacketOf<P>) {
        let (Some((_, oldest)), Some((_, newest))) = (self.kept.first(), self.kept.last()) else { return };
        let steps = self.kept.len().saturating_sub(1).max(1);
        let turned_cdeg = turned(oldest.azimuth_cdeg, newest.azimuth_cdeg).rem_euclid(TURN_CDEG);
        let per_step = nearest_f32(turned_cdeg.max(1)) / nearest_f32(steps);
        let newest_cdeg = newest.azimuth_cdeg;
        for index in self.done..self.kept.len() {
            let Some((stamp, at)) = self.kept.get(index) else { break };
            if turned(at.azimuth_cdeg, newest_cdeg) < self.widest_cdeg || packet.columns.is_full() {
                break;
            }
            if packet.columns.is_empty() {
                packet.stamp = *stamp;
            }
            let offset_us = u32::try_from(packet.stamp.past_us(*stamp)).unwrap_or(u32::MAX);
            let column = LidarColumnOf { offset_us, ..self.column(index, at.azimuth_cdeg, per_step) };
            // It is not full.
            let _ = packet.columns.push(column);
            self.done = index.saturating_add(1);
        }
    }

    /// What all lasers saw at an azimuth, near the firing of that place.
    fn column(&self, index: usize, azimuth_cdeg: u16, per_step: f32) -> LidarColumnOf<P> {
        let mut column: LidarColumnOf<P> = LidarColumnOf { azimuth_cdeg, ..LidarColumnOf::SILENT };
        for (ring, beside_cdeg) in self.beside_cdeg.iter().enumerate() {
            let steps = libm::roundf(-f32::from(*beside_cdeg) / per_step);
            let Some(firing) = moved(index, steps).and_then(|place| self.kept.get(place)) else { continue };
            let (_, firing) = firing;
            let off_cdeg = turned(azimuth_cdeg, firing.azimuth_cdeg).saturating_add(i32::from(*beside_cdeg));
            // Beyond a step from where the column looks the turn was not even.
            if nearest_f32(off_cdeg.abs()) > per_step + 1.0 {
                continue;
            }
            copy_entry(column.range_raw.as_mut(), firing.range_raw.as_ref(), ring);
            copy_entry(column.reflectivity.as_mut(), firing.reflectivity.as_ref(), ring);
        }
        column
    }
}

/// A pause lies between two firings, or they are not in their order.
fn is_apart(before: Stamp, next: Stamp) -> bool {
    before > next || before.past_us(next) > PAUSE_US
}

fn copy_entry<T: Copy>(to: &mut [T], from: &[T], place: usize) {
    if let (Some(to), Some(from)) = (to.get_mut(place), from.get(place)) {
        *to = *from;
    }
}

/// A place so many steps on; `None` before the first.
fn moved(index: usize, steps: f32) -> Option<usize> {
    index.checked_add_signed(isize::from(saturating_i16(steps)))
}

/// From one azimuth to another the short way, hundredths of a degree.
fn turned(from_cdeg: u16, to_cdeg: u16) -> i32 {
    let turn = (i32::from(to_cdeg) - i32::from(from_cdeg)).rem_euclid(TURN_CDEG);
    if turn > TURN_CDEG / 2 { turn - TURN_CDEG } else { turn }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::profile::Host;
    use floorguard_types::sensing::LidarPacketOf;

    extern crate std;
    use std::vec::Vec;

    /// A post 2° wide about this bearing.
    const POST_CDEG: i32 = 9_000;
    const HALF_CDEG: i32 = 100;

    /// Packets of twelve firings 20 cdeg apart: a laser sees the post when it looks there.
    fn packets(firings: u64) -> Vec<LidarPacketOf<Host>> {
        let angles = Model::Vlp32C.ring_angles();
        let column = |number: u64| {
            let azimuth_cdeg = ((number * 20) % 36_000) as u16;
            let mut column: LidarColumnOf<Host> = LidarColumnOf { azimuth_cdeg, ..LidarColumnOf::SILENT };
            for (ring, angle) in angles.iter().enumerate() {
                let bearing_cdeg = i32::from(azimuth_cdeg) + i32::from(angle.azimuth_cdeg);
                if (bearing_cdeg - POST_CDEG).abs() <= HALF_CDEG {
                    column.range_raw[ring] = 1_000;
                }
            }
            column
        };
        let packet = |first: u64| {
            let mut packet: LidarPacketOf<Host> = LidarPacketOf::EMPTY;
            packet.stamp = Stamp::from_micros(1_000_000 + first * 55);
            for number in first..first + 12 {
                let offset_us = ((number - first) * 55) as u32;
                packet.columns.push(LidarColumnOf { offset_us, ..column(number) }).expect("twelve fit");
            }
            packet
        };
        (0..firings / 12).map(|number| packet(number * 12)).collect()
    }

    /// Every laser of a column sees the post, or none: at the column's own azimuth.
    #[test]
    fn post_stands_in_same_columns_of_all_lasers() {
        let mut straight = StraightColumns::<Host>::new(Model::Vlp32C);
        let (mut columns, mut latest) = (0, 0);
        for mut packet in packets(1_200) {
            let newest_us = packet.stamp.as_micros() + 11 * 55;
            straight.put_straight(&mut packet, 0);
            for column in &packet.columns {
                let at_us = packet.stamp.as_micros() + u64::from(column.offset_us);
                assert!(at_us > latest && newest_us - at_us < 2_500, "in order, and soon");
                latest = at_us;
                columns += 1;
                let off_cdeg = (i32::from(column.azimuth_cdeg) - POST_CDEG).abs();
                let seen = column.range_raw.iter().filter(|raw| **raw != 0).count();
                if off_cdeg < HALF_CDEG - 20 {
                    assert_eq!(seen, 32, "at {}", column.azimuth_cdeg);
                } else if off_cdeg > HALF_CDEG + 20 {
                    assert_eq!(seen, 0, "at {}", column.azimuth_cdeg);
                }
            }
        }
        assert!(columns > 1_150, "{columns} of 1,200 firings have become columns");
    }

    /// Nothing is taken across a gap: what a laser has not seen stays unknown.
    #[test]
    fn lost_packets_leave_cells_unknown() {
        let mut straight = StraightColumns::<Host>::new(Model::Vlp32C);
        let mut seen = 0;
        for (number, mut packet) in packets(1_200).into_iter().enumerate() {
            // The post is at the 450th firing, in the 38th packet; those before it are lost.
            if (30..37).contains(&number) {
                continue;
            }
            straight.put_straight(&mut packet, if number == 37 { 7 } else { 0 });
            let is_near =
                |column: &&LidarColumnOf<Host>| (i32::from(column.azimuth_cdeg) - POST_CDEG).abs() < 80;
            seen += packet
                .columns
                .iter()
                .filter(is_near)
                .map(|column| column.range_raw.iter().filter(|raw| **raw != 0).count())
                .sum::<usize>();
        }
        assert!((1..7 * 32).contains(&seen), "{seen} cells");
    }
}
