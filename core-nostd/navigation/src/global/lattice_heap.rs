//! A binary heap of fixed size: the most urgent entry first, ties by age.

/// An entry of the open list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct HeapEntry {
    /// Smaller is sooner.
    pub(super) urgency: u32,
    /// Number of the node.
    pub(super) node: u32,
}

/// Levels of a heap with 2³² entries.
const LEVELS: usize = 32;

/// Adds an entry; `None`: full.
pub(super) fn push(heap: &mut [HeapEntry], count: usize, entry: HeapEntry) -> Option<usize> {
    *heap.get_mut(count)? = entry;
    let mut at = count;
    for _ in 0..LEVELS {
        let Some(parent) = at.checked_sub(1).map(|before| before / 2) else { break };
        let above = heap.get(parent).copied()?;
        if above <= entry {
            break;
        }
        *heap.get_mut(at)? = above;
        *heap.get_mut(parent)? = entry;
        at = parent;
    }
    Some(count.saturating_add(1))
}

/// Takes the most urgent entry of `count`; afterwards there is one less.
pub(super) fn pop(heap: &mut [HeapEntry], count: usize) -> Option<HeapEntry> {
    let last = count.checked_sub(1)?;
    let first = heap.first().copied()?;
    let moved = heap.get(last).copied()?;
    let mut at = 0_usize;
    for _ in 0..LEVELS {
        let left = at.saturating_mul(2).saturating_add(1);
        let right = left.saturating_add(1);
        let child = match (heap.get(left).filter(|_| left < last), heap.get(right).filter(|_| right < last)) {
            (Some(a), Some(b)) if b < a => right,
            (Some(_), _) => left,
            _ => break,
        };
        let below = heap.get(child).copied()?;
        if below >= moved {
            break;
        }
        *heap.get_mut(at)? = below;
        at = child;
    }
    *heap.get_mut(at)? = moved;
    Some(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    #[test]
    fn entries_come_out_in_order() {
        let mut random = floorguard_types::random::Pcg32::new(2, 2);
        let mut heap = vec![HeapEntry::default(); 500];
        let mut count = 0;
        let mut kept: Vec<HeapEntry> = Vec::new();
        for node in 0..5_000_u32 {
            if random.bernoulli(0.55) {
                let entry = HeapEntry { urgency: random.below(100), node };
                if let Some(more) = push(&mut heap, count, entry) {
                    count = more;
                    kept.push(entry);
                } else {
                    assert_eq!(count, 500);
                }
            } else if let Some(first) = pop(&mut heap, count) {
                count -= 1;
                kept.sort();
                assert_eq!(first, kept.remove(0));
            }
        }
        assert_eq!(kept.len(), count);
    }
}
