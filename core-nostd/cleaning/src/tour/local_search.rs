//! Exchanges that shorten a tour: 2-opt and Or-opt with neighbour lists and a queue of nodes to examine.
//!
//! First gain wins. A node leaves the queue when none of its exchanges helps, and comes back when an edge of it
//! changes (book, Cleaning: Tour; "don't look bits" of Bentley 1992).

use super::cycle::Cycle;
use super::distances::Distances;
use super::neighbours::Neighbours;

/// Upper bound of evaluations in one call.
pub(super) const EVALUATIONS_MAX: u32 = 4_096;
/// Longest stretch that Or-opt moves.
const SEGMENT_MAX: usize = 3;

/// Direction along the tour.
#[derive(Clone, Copy, PartialEq, Eq)]
enum TourDirection {
    Forward,
    Backward,
}

/// The tour with what the search needs.
#[derive(Clone, Debug)]
pub(super) struct LocalSearch<const N: usize> {
    pub cycle: Cycle<N>,
    pub neighbours: Neighbours<N>,
    waiting: [bool; N],
    queue: [u16; N],
    first: usize,
    queued: usize,
}

impl<const N: usize> LocalSearch<N> {
    pub const fn new() -> Self {
        Self {
            cycle: Cycle::new(),
            neighbours: Neighbours::new(),
            waiting: [false; N],
            queue: [0; N],
            first: 0,
            queued: 0,
        }
    }

    /// Puts a node on the queue, once.
    #[inline]
    pub fn wake(&mut self, node: u16) {
        let Some(waiting) = self.waiting.get_mut(usize::from(node)) else { return };
        if *waiting {
            return;
        }
        *waiting = true;
        let place = self.first.wrapping_add(self.queued) % N.max(1);
        if let Some(entry) = self.queue.get_mut(place) {
            *entry = node;
            // Every node is on the queue at most once, so it cannot overflow.
            self.queued = self.queued.saturating_add(1);
        }
    }

    fn take(&mut self) -> Option<u16> {
        if self.queued == 0 {
            return None;
        }
        let node = self.queue.get(self.first).copied()?;
        self.first = self.first.wrapping_add(1) % N.max(1);
        self.queued = self.queued.saturating_sub(1);
        if let Some(waiting) = self.waiting.get_mut(usize::from(node)) {
            *waiting = false;
        }
        Some(node)
    }

    /// Some node waits to be examined.
    pub const fn is_waiting(&self) -> bool {
        self.queued > 0
    }

    /// Empties the queue without looking.
    pub fn forget(&mut self) {
        self.waiting = [false; N];
        self.queued = 0;
    }

    /// Examines the nodes of the queue, at most `evaluations` times. Returns the sum of all gains, ≥ 0.
    pub fn run(&mut self, distances: &impl Distances, evaluations: u32) -> i32 {
        let mut gained = 0_i32;
        for _ in 0..evaluations.min(EVALUATIONS_MAX) {
            if self.cycle.is_log_full() {
                break;
            }
            let Some(node) = self.take() else { break };
            let gain = self.improve(node, distances);
            if gain > 0 {
                gained = gained.saturating_add(gain);
                self.wake(node);
            }
        }
        gained
    }

    fn step(&self, node: u16, direction: TourDirection) -> u16 {
        match direction {
            TourDirection::Forward => self.cycle.next(node),
            TourDirection::Backward => self.cycle.previous(node),
        }
    }

    /// The first exchange at a node that gains; 0 if none does.
    fn improve(&mut self, node: u16, distances: &impl Distances) -> i32 {
        for direction in [TourDirection::Forward, TourDirection::Backward] {
            let gain = self.two_opt(node, direction, distances);
            if gain > 0 {
                return gain;
            }
        }
        for direction in [TourDirection::Forward, TourDirection::Backward] {
            let gain = self.or_opt(node, direction, distances);
            if gain > 0 {
                return gain;
            }
        }
        0
    }

    /// Replaces (a, b) and (c, d) by (a, c) and (b, d), where b and d follow a and c in direction `direction`.
    fn two_opt(&mut self, a: u16, direction: TourDirection, distances: &impl Distances) -> i32 {
        let b = self.step(a, direction);
        let removed = distances.between(a, b);
        for c in self.neighbours.of(a) {
            if !Neighbours::<N>::is_node(c) {
                break;
            }
            let first_gain = removed.wrapping_sub(distances.between(a, c));
            if first_gain <= 0 {
                break;
            }
            let d = self.step(c, direction);
            let gain = first_gain.wrapping_add(distances.between(c, d)).wrapping_sub(distances.between(b, d));
            if gain > 0 && c != b && d != a {
                match direction {
                    TourDirection::Forward => self.cycle.reverse(b, c),
                    TourDirection::Backward => self.cycle.reverse(a, d),
                }
                for node in [a, b, c, d] {
                    self.wake(node);
                }
                return gain;
            }
        }
        0
    }

    /// Moves the stretch that starts at `a` and runs against `direction` to a place beside a neighbour of `a`, either way
    /// round.
    fn or_opt(&mut self, a: u16, direction: TourDirection, distances: &impl Distances) -> i32 {
        let back = if direction == TourDirection::Forward {
            TourDirection::Backward
        } else {
            TourDirection::Forward
        };
        let before = self.step(a, direction);
        let mut last = a;
        for _ in 0..SEGMENT_MAX {
            let after = self.step(last, back);
            if after == before {
                return 0;
            }
            let removal = distances
                .between(before, a)
                .wrapping_add(distances.between(last, after))
                .wrapping_sub(distances.between(before, after));
            let ends = SegmentEnds { a, last, before, after, direction };
            let gain = self.insert_segment(ends, removal, distances);
            if gain > 0 {
                return gain;
            }
            last = after;
        }
        0
    }

    fn insert_segment(&mut self, ends: SegmentEnds, removal: i32, distances: &impl Distances) -> i32 {
        let SegmentEnds { a, last, direction, .. } = ends;
        for c in self.neighbours.of(a) {
            if !Neighbours::<N>::is_node(c) {
                break;
            }
            let first_gain = removal.wrapping_sub(distances.between(a, c));
            if first_gain <= 0 {
                break;
            }
            let inside = match direction {
                TourDirection::Forward => self.cycle.is_between(last, c, a),
                TourDirection::Backward => self.cycle.is_between(a, c, last),
            };
            if inside {
                continue;
            }
            for side in [TourDirection::Forward, TourDirection::Backward] {
                let d = self.step(c, side);
                if d == a || d == last {
                    continue;
                }
                let gain =
                    first_gain.wrapping_add(distances.between(c, d)).wrapping_sub(distances.between(last, d));
                if gain > 0 {
                    self.move_segment(ends, (c, d, side));
                    return gain;
                }
            }
        }
        0
    }

    /// Puts the stretch between `c` and `d` so that `a` is beside `c`. Made of two or three turns.
    fn move_segment(&mut self, ends: SegmentEnds, (c, d, side): (u16, u16, TourDirection)) {
        let SegmentEnds { a, last, before, after, direction } = ends;
        // In the direction of the tour: `low` … `high` is the stretch, from `left` to `right` the gap it goes to.
        let (low, high) = if direction == TourDirection::Forward { (last, a) } else { (a, last) };
        let (left, right) = if side == TourDirection::Forward { (c, d) } else { (d, c) };
        let (outer_low, outer_high) =
            if direction == TourDirection::Forward { (after, before) } else { (before, after) };
        if self.is_ahead(high, left) {
            // outer_low [low … high] [outer_high … left] right
            self.exchange(outer_low, Stretch { from: low, to: high }, Stretch { from: outer_high, to: left });
        } else {
            // left [right … outer_low] [low … high] outer_high
            self.exchange(left, Stretch { from: right, to: outer_low }, Stretch { from: low, to: high });
        }
        // The end of the stretch that belongs beside `left`, and the other one.
        let (near, far) = if left == c { (a, last) } else { (last, a) };
        if self.cycle.next(left) != near && self.cycle.previous(left) != near {
            self.reverse_stretch(left, far, near);
        }
        for node in [a, last, before, after, c, d] {
            self.wake(node);
        }
    }

    /// Going on from `high`, `node` is nearer ahead than behind.
    fn is_ahead(&self, high: u16, node: u16) -> bool {
        let count = self.cycle.order().len();
        let (from, to) = (self.cycle.position(high), self.cycle.position(node));
        let ahead =
            if to >= from { to.wrapping_sub(from) } else { to.wrapping_add(count).wrapping_sub(from) };
        ahead.wrapping_mul(2) <= count
    }

    /// Turns around the stretch from `near`, which is beside `outer`, to `far`. A turn may be made on the other side
    /// of the tour, which mirrors it; so the direction is looked up every time.
    fn reverse_stretch(&mut self, outer: u16, near: u16, far: u16) {
        if self.cycle.next(outer) == near {
            self.cycle.reverse(near, far);
        } else {
            self.cycle.reverse(far, near);
        }
    }

    /// Lets two adjacent stretches after `outer` change places: one turn of both, one of each.
    pub fn exchange(&mut self, outer: u16, first: Stretch, second: Stretch) {
        self.reverse_stretch(outer, first.from, second.to);
        self.reverse_stretch(outer, second.to, second.from);
        self.reverse_stretch(second.to, first.to, first.from);
    }
}

/// Nodes in a row of the tour, in its direction.
#[derive(Clone, Copy)]
pub struct Stretch {
    /// The first.
    pub from: u16,
    /// The last.
    pub to: u16,
}

/// A stretch of the tour and its surroundings; `before` is beside `a`, `after` beside `last`.
#[derive(Clone, Copy)]
struct SegmentEnds {
    a: u16,
    last: u16,
    before: u16,
    after: u16,
    direction: TourDirection,
}
