//! Turns the moving positions of tracks into visits and time, cell by cell.
//!
//! A visit is a track that enters a cell and has not been counted there within the last minute, so that somebody who
//! stands on the border of two cells does not walk through both for ever (book, Environment: Visits). A track that has
//! never moved a metre is not a person who walks: what it would count is held back until it has, or is forgotten.

use crate::GridGeometry;
use floorguard_types::geometry::Point2;
use floorguard_types::number::truncating_u32;

use super::line::{Step, walk};
use super::wall_time::WallTime;

/// A cell counts a track again after this long, µs.
const AGAIN_US: i64 = 60_000_000;
/// A track counts from this displacement on, metres.
const MOVED_M: f32 = 1.0;
/// Longer jumps are not steps: no cells in between, metres.
const JUMP_M: f32 = 3.0;
/// Longer gaps are not watched: no time is credited, µs.
const GAP_US: i64 = 2_000_000;

/// Where a tracked person is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PersonAt {
    /// The track.
    pub id: u64,
    /// Position in the map frame.
    pub position_in_map: Point2,
}

/// A segment of a person's path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Footprint {
    /// The cell.
    pub cell: usize,
    /// When.
    pub at: WallTime,
    /// The track enters the cell for the first time within a minute.
    pub is_visit: bool,
    /// Time spent there, µs.
    pub dwell_us: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Visitor<const RECENT: usize> {
    id: u64,
    first: Point2,
    last: Point2,
    last_at: WallTime,
    has_moved: bool,
    /// Where it was counted last, a ring; before it has moved: what waits to be counted.
    recent: [Option<Footprint>; RECENT],
    next: usize,
}

/// The tracks that are followed at the moment: `TRACKS` of them with `RECENT` cells each.
#[derive(Clone, Debug, PartialEq)]
pub struct Visitors<const TRACKS: usize, const RECENT: usize> {
    visitors: [Option<Visitor<RECENT>>; TRACKS],
    dropped: u32,
}

impl<const TRACKS: usize, const RECENT: usize> Default for Visitors<TRACKS, RECENT> {
    fn default() -> Self {
        Self { visitors: [const { None }; TRACKS], dropped: 0 }
    }
}

impl<const TRACKS: usize, const RECENT: usize> Visitors<TRACKS, RECENT> {
    /// Tracks beyond the capacity.
    #[must_use]
    pub const fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Takes the newest position of a track and emits what it adds to the raster. A position that is not finite, or a
    /// moment before the track's last one, adds nothing.
    pub fn follow(
        &mut self,
        geometry: &GridGeometry,
        (person, at): (PersonAt, WallTime),
        mut emit: impl FnMut(Footprint),
    ) {
        let here = person.position_in_map;
        if !(here.x_m.is_finite() && here.y_m.is_finite()) {
            return;
        }
        let known = self.visitors.iter().position(|v| v.is_some_and(|v| v.id == person.id));
        let Some(slot) = known.or_else(|| self.free_slot(at)) else {
            self.dropped = self.dropped.saturating_add(1);
            return;
        };
        let Some(slot) = self.visitors.get_mut(slot) else { return };
        let fresh = || Visitor {
            id: person.id,
            first: here,
            last: here,
            last_at: at,
            has_moved: false,
            recent: [None; RECENT],
            next: 0,
        };
        let is_new = known.is_none();
        slot.get_or_insert_with(fresh).step((geometry, is_new), (here, at), &mut emit);
    }

    /// A free place, or that of a track that has not been seen for longest, if that is more than a minute ago.
    fn free_slot(&mut self, now: WallTime) -> Option<usize> {
        if let Some(free) = self.visitors.iter().position(Option::is_none) {
            return Some(free);
        }
        let (index, slot) =
            self.visitors.iter_mut().enumerate().min_by_key(|(_, slot)| slot.map(|v| v.last_at))?;
        let is_gone = slot.is_some_and(|v| now.micros_since(v.last_at) > AGAIN_US);
        if is_gone {
            *slot = None;
        }
        is_gone.then_some(index)
    }
}

impl<const RECENT: usize> Visitor<RECENT> {
    fn step(
        &mut self,
        (geometry, is_new): (&GridGeometry, bool),
        (here, at): (Point2, WallTime),
        emit: &mut impl FnMut(Footprint),
    ) {
        let gap_us = at.micros_since(self.last_at);
        if gap_us < 0 {
            return;
        }
        let is_step = self.last.distance(here) <= JUMP_M && gap_us <= GAP_US;
        let from = if is_step { self.last } else { here };
        let dwell_us = if is_step { u32::try_from(gap_us).unwrap_or_default() } else { 0 };
        let mut passed = 0_u32;
        walk(geometry, Step { from, to: here }, |_| passed = passed.saturating_add(1));
        // The first cell is the one it was in already; the time is shared out so that nothing of it is lost.
        let mut index = 0_u32;
        walk(geometry, Step { from, to: here }, |cell| {
            let until = |i: u32| u64::from(dwell_us) * u64::from(i) / u64::from(passed.max(1));
            let share = until(index.saturating_add(1)).saturating_sub(until(index));
            let enters = index > 0 || is_new || !is_step;
            self.count((cell, at), enters, truncating_u32(share), emit);
            index = index.saturating_add(1);
        });
        (self.last, self.last_at) = (here, at);
        if !self.has_moved && self.first.distance(here) >= MOVED_M {
            self.has_moved = true;
            // Oldest first: the ring continues at `next`.
            let (newer, older) = self.recent.split_at(self.next.min(RECENT));
            older.iter().chain(newer).flatten().for_each(|held| emit(*held));
        }
    }

    fn count(
        &mut self,
        (cell, at): (usize, WallTime),
        enters: bool,
        dwell_us: u32,
        emit: &mut impl FnMut(Footprint),
    ) {
        let is_recent = |held: &Footprint| held.cell == cell && at.micros_since(held.at) < AGAIN_US;
        let known = self.recent.iter_mut().flatten().find(|held| is_recent(held));
        let is_visit = enters && known.is_none();
        let footprint = Footprint { cell, at, is_visit, dwell_us };
        match known {
            Some(held) if !self.has_moved => held.dwell_us = held.dwell_us.saturating_add(dwell_us),
            Some(_) => emit(footprint),
            None => {
                if self.has_moved {
                    emit(footprint);
                }
                // Also a cell that is not entered but was pushed out of the ring is remembered again.
                if let Some(place) = self.recent.get_mut(self.next) {
                    *place = Some(footprint);
                }
                self.next = self.next.saturating_add(1).checked_rem(RECENT).unwrap_or_default();
            }
        }
    }
}

#[cfg(test)]
#[path = "visitors_tests.rs"]
mod tests;
