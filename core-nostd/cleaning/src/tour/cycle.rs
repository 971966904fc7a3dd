//! A closed tour as an array, with the one change that all exchanges are made of: turning a stretch around.
//!
//! Every turn is written to a log while one is kept, so that an experiment that did not help is taken back exactly.

use floorguard_types::number::truncating_u16;

/// Turns that one experiment may need; more than that and it is taken back.
const LOG_MAX: usize = 1_024;

/// A closed tour over the nodes 0..n. Invariant: `order` is a permutation of 0..n and `position` its inverse.
#[derive(Clone, Debug)]
pub(super) struct Cycle<const N: usize> {
    order: [u16; N],
    position: [u16; N],
    count: usize,
    log: [(u16, u16); LOG_MAX],
    logged: usize,
}

impl<const N: usize> Cycle<N> {
    pub const fn new() -> Self {
        Self { order: [0; N], position: [0; N], count: 0, log: [(0, 0); LOG_MAX], logged: 0 }
    }

    /// Takes a permutation of 0..n, n ≤ N.
    pub fn set(&mut self, nodes: impl Iterator<Item = u16>) {
        self.count = 0;
        self.logged = 0;
        for (place, node) in self.order.iter_mut().zip(nodes) {
            *place = node;
            self.count = self.count.saturating_add(1);
        }
        for (node, index) in self.order.iter().take(self.count).zip(0_u16..) {
            if let Some(position) = self.position.get_mut(usize::from(*node)) {
                *position = index;
            }
        }
    }

    pub fn order(&self) -> &[u16] {
        self.order.get(..self.count).unwrap_or(&[])
    }

    #[inline]
    pub fn position(&self, node: u16) -> usize {
        self.position.get(usize::from(node)).copied().map_or(0, usize::from)
    }

    /// The node at a position; positions run on past the end.
    #[inline]
    pub fn at(&self, position: usize) -> u16 {
        let wrapped = if position >= self.count { position.wrapping_sub(self.count) } else { position };
        self.order.get(wrapped).copied().unwrap_or(0)
    }

    #[inline]
    pub fn next(&self, node: u16) -> u16 {
        self.at(self.position(node).saturating_add(1))
    }

    #[inline]
    pub fn previous(&self, node: u16) -> u16 {
        let position = self.position(node);
        self.at(if position == 0 { self.count.saturating_sub(1) } else { position.saturating_sub(1) })
    }

    /// `b` lies on the path from `a` to `c`, in the direction of the tour.
    #[inline]
    pub fn is_between(&self, a: u16, b: u16, c: u16) -> bool {
        let (a, b, c) = (self.position(a), self.position(b), self.position(c));
        if a <= c { a <= b && b <= c } else { b >= a || b <= c }
    }

    /// Starts to keep a log.
    pub fn begin(&mut self) {
        self.logged = 0;
    }

    /// The log is full: the experiment must be taken back.
    pub const fn is_log_full(&self) -> bool {
        self.logged.saturating_add(8) > LOG_MAX
    }

    /// Takes back everything since [`Self::begin`].
    pub fn undo(&mut self) {
        for index in (0..self.logged.min(LOG_MAX)).rev() {
            if let Some(&(from, to)) = self.log.get(index) {
                self.turn(usize::from(from), usize::from(to));
            }
        }
        self.logged = 0;
    }

    /// Turns the stretch from node `first` to node `last`, in the direction of the tour, around.
    #[inline]
    pub fn reverse(&mut self, first: u16, last: u16) {
        let (from, to) = (self.position(first), self.position(last));
        if let Some(entry) = self.log.get_mut(self.logged) {
            *entry = (truncating_u16(from), truncating_u16(to));
            self.logged = self.logged.saturating_add(1);
        }
        self.turn(from, to);
    }

    /// Turns around positions `from` to `to` (cyclic), or the rest, whichever is shorter: for a closed tour that is
    /// the same.
    fn turn(&mut self, from: usize, to: usize) {
        let count = self.count;
        let inner = if to >= from {
            to.wrapping_sub(from).wrapping_add(1)
        } else {
            to.wrapping_add(count).wrapping_sub(from).wrapping_add(1)
        };
        let (mut low, mut high, swaps) = if inner.wrapping_mul(2) <= count {
            (from, to, inner / 2)
        } else {
            let low = if to.wrapping_add(1) >= count { 0 } else { to.wrapping_add(1) };
            let high = if from == 0 { count.wrapping_sub(1) } else { from.wrapping_sub(1) };
            (low, high, count.wrapping_sub(inner) / 2)
        };
        for _ in 0..swaps.min(N) {
            self.swap(low, high);
            low = if low.wrapping_add(1) >= count { 0 } else { low.wrapping_add(1) };
            high = if high == 0 { count.wrapping_sub(1) } else { high.wrapping_sub(1) };
        }
    }

    #[inline]
    fn swap(&mut self, low: usize, high: usize) {
        let (Some(&a), Some(&b)) = (self.order.get(low), self.order.get(high)) else { return };
        debug_assert!(
            self.position(a) == low && self.position(b) == high,
            "position is the inverse of order"
        );
        if let Some(place) = self.order.get_mut(low) {
            *place = b;
        }
        if let Some(place) = self.order.get_mut(high) {
            *place = a;
        }
        if let Some(position) = self.position.get_mut(usize::from(b)) {
            *position = truncating_u16(low);
        }
        if let Some(position) = self.position.get_mut(usize::from(a)) {
            *position = truncating_u16(high);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::random::Pcg32;

    #[test]
    fn turns_keep_the_permutation_and_are_reversible() {
        let mut random = Pcg32::new(1, 1);
        let mut cycle = Cycle::<32>::new();
        cycle.set(0..30);
        for _ in 0..200 {
            let before: std::vec::Vec<u16> = cycle.order().to_vec();
            cycle.begin();
            for _ in 0..20 {
                let (a, b) = (random.below(30) as u16, random.below(30) as u16);
                let (outer_before, outer_after) = (cycle.previous(a), cycle.next(b));
                cycle.reverse(a, b);
                if outer_before != b && outer_after != a && a != b {
                    let joined = (cycle.next(outer_before) == b && cycle.previous(outer_after) == a)
                        || (cycle.previous(outer_before) == b && cycle.next(outer_after) == a);
                    assert!(joined, "the ends of the stretch changed places");
                }
                let mut sorted: std::vec::Vec<u16> = cycle.order().to_vec();
                sorted.sort_unstable();
                assert!(sorted.iter().copied().eq(0..30));
                assert!((0..30).all(|node| cycle.at(cycle.position(node)) == node));
            }
            cycle.undo();
            assert_eq!(cycle.order(), before.as_slice());
        }
    }
}
