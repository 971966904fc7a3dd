//! The nearest other nodes of every node: the only partners that an exchange tries.

use super::distances::Distances;

/// Partners of a node. Eight lose nothing measurable against sixteen on the benchmark grids and halve the time.
pub(super) const NEIGHBOURS: usize = 8;

/// Marks an empty place in a list.
const NO_NODE: u16 = u16::MAX;

/// Lists of nearest nodes, nearest first.
#[derive(Clone, Debug)]
pub(super) struct Neighbours<const N: usize> {
    lists: [[u16; NEIGHBOURS]; N],
}

impl<const N: usize> Neighbours<N> {
    pub const fn new() -> Self {
        Self { lists: [[NO_NODE; NEIGHBOURS]; N] }
    }

    /// Fills the lists for the nodes 0..count by insertion into a sorted list: count² distances.
    pub fn fill(&mut self, count: usize, distances: &impl Distances) {
        for (list, node) in self.lists.iter_mut().take(count).zip(0_u16..) {
            let mut nearest = [(i32::MAX, NO_NODE); NEIGHBOURS];
            for (other, _) in (0_u16..).zip(0..count.min(N)) {
                let distance = distances.between(node, other);
                if other == node || nearest.last().is_some_and(|last| distance >= last.0) {
                    continue;
                }
                insert(&mut nearest, (distance, other));
            }
            for (place, (_, other)) in list.iter_mut().zip(nearest) {
                *place = other;
            }
        }
        // The node that closes an open path is near to nobody; an earlier, larger tour may have left a list there.
        if let Some(list) = self.lists.get_mut(count) {
            *list = [NO_NODE; NEIGHBOURS];
        }
    }

    /// The nearest nodes of a node, nearest first.
    #[inline]
    pub fn of(&self, node: u16) -> [u16; NEIGHBOURS] {
        self.lists.get(usize::from(node)).copied().unwrap_or([NO_NODE; NEIGHBOURS])
    }

    /// The place in the list is taken.
    #[inline]
    pub const fn is_node(node: u16) -> bool {
        node != NO_NODE
    }
}

/// Puts an entry into its place; the last one falls off.
fn insert(sorted: &mut [(i32, u16); NEIGHBOURS], entry: (i32, u16)) {
    let mut moving = entry;
    for place in sorted {
        if moving.0 < place.0 {
            core::mem::swap(place, &mut moving);
        }
    }
}
