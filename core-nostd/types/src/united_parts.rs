//! Parts that grow from neighbour to neighbour and become one where they meet, in fixed memory.
//!
//! A picture or a map is read piece by piece, be it a pixel, a cell or a run of cells: a piece joins the parts of its
//! neighbours, which are one from then on, or begins a part. Which parts are one is remembered by parents: the earlier
//! part takes the later one in.

use core::fmt::Debug;

use crate::profile::{List, ListOf, Size};

/// What a part consists of.
pub trait Absorb: Copy + Debug + PartialEq {
    /// Takes the pieces of another part in.
    fn absorb(&mut self, other: &Self);
}

/// The part list is full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CapacityExceeded;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Part<T> {
    parent: u16,
    content: T,
}

/// Up to as many parts as the size says, at most 65,536.
///
/// ```
/// use floorguard_types::profile::Of;
/// use floorguard_types::united_parts::{Absorb, CapacityExceeded, UnitedParts};
///
/// /// Pixels of a part.
/// #[derive(Clone, Copy, Debug, PartialEq)]
/// struct Pixels(u32);
/// impl Absorb for Pixels {
///     fn absorb(&mut self, other: &Self) {
///         self.0 += other.0;
///     }
/// }
///
/// let mut parts = UnitedParts::<Pixels, Of<2>>::default();
/// let left = parts.join([].into_iter(), &Pixels(1)).unwrap();
/// let right = parts.join([].into_iter(), &Pixels(1)).unwrap();
/// assert_eq!(parts.join([].into_iter(), &Pixels(1)), Err(CapacityExceeded));
/// // A pixel between both unites them.
/// parts.join([left, right].into_iter(), &Pixels(1)).unwrap();
/// assert!(parts.finished().eq(&[Pixels(3)]));
/// ```
#[derive(Clone, Debug)]
pub struct UnitedParts<T: Absorb, S: Size> {
    parts: ListOf<Part<T>, S>,
}

impl<T: Absorb, S: Size> Default for UnitedParts<T, S> {
    fn default() -> Self {
        Self { parts: List::EMPTY }
    }
}

impl<T: Absorb, S: Size> UnitedParts<T, S> {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.parts.clear();
    }

    /// Adds a piece to the parts of its neighbours, united, or to a new one. Gives the part's number.
    ///
    /// # Errors
    /// It touches nothing, and the part list is full.
    #[inline]
    pub fn join(&mut self, neighbours: impl Iterator<Item = u16>, own: &T) -> Result<u16, CapacityExceeded> {
        let mut joined: Option<u16> = None;
        for neighbour in neighbours {
            let root = self.root(neighbour);
            joined = Some(joined.map_or(root, |other| self.unite(other, root)));
        }
        if let Some(root) = joined {
            if let Some(part) = self.parts.get_mut(usize::from(root)) {
                part.content.absorb(own);
            }
            return Ok(root);
        }
        let index = u16::try_from(self.parts.len()).map_err(|_| CapacityExceeded)?;
        self.parts.push(Part { parent: index, content: *own }).map_err(|_| CapacityExceeded)?;
        Ok(index)
    }

    /// The finished parts, in the order in which they began.
    pub fn finished(&self) -> impl Iterator<Item = &T> {
        self.numbered().map(|(_, content)| content)
    }

    /// The same with their numbers.
    pub fn numbered(&self) -> impl Iterator<Item = (u16, &T)> {
        let own = |(index, part): &(u16, &Part<T>)| part.parent == *index;
        (0..=u16::MAX).zip(self.parts.iter()).filter(own).map(|(index, part)| (index, &part.content))
    }

    /// The part that a part was united with in the end. Parents have smaller numbers, so the walk ends.
    pub fn root(&mut self, part: u16) -> u16 {
        let mut index = part;
        for _ in 0..S::N {
            let parent = self.parts.get(usize::from(index)).map_or(index, |part| part.parent);
            debug_assert!(parent <= index, "a part was united with a later one");
            if parent == index {
                break;
            }
            index = parent;
        }
        // The next walk from here is one step.
        if let Some(part) = self.parts.get_mut(usize::from(part)) {
            part.parent = index;
        }
        index
    }

    fn unite(&mut self, a: u16, b: u16) -> u16 {
        if a == b {
            return a;
        }
        let (kept, given) = (a.min(b), a.max(b));
        let other = self.parts.get_mut(usize::from(given)).map(|part| {
            part.parent = kept;
            part.content
        });
        if let (Some(part), Some(other)) = (self.parts.get_mut(usize::from(kept)), other) {
            part.content.absorb(&other);
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::Of;

    impl Absorb for u32 {
        fn absorb(&mut self, other: &Self) {
            *self += other;
        }
    }

    #[test]
    fn touching_parts_merge_along_chains() {
        let mut parts = UnitedParts::<u32, Of<4>>::default();
        let begun = [1, 10, 100].map(|own| parts.join(core::iter::empty(), &own));
        assert_eq!(begun, [Ok(0), Ok(1), Ok(2)]);
        assert_eq!(parts.join([2, 1].into_iter(), &1_000), Ok(1));
        assert_eq!(parts.numbered().collect::<std::vec::Vec<_>>(), [(0, &1), (1, &1_110)]);
        assert_eq!([0, 1, 2].map(|part| parts.root(part)), [0, 1, 1]);
        assert_eq!(parts.join([2, 0].into_iter(), &10_000), Ok(0));
        assert_eq!(parts.join([1].into_iter(), &100_000), Ok(0));
        assert_eq!(parts.finished().copied().collect::<std::vec::Vec<_>>(), [111_111]);
    }

    #[test]
    fn overflow_is_reported() {
        let mut parts = UnitedParts::<u32, Of<1>>::default();
        assert_eq!(parts.join(core::iter::empty(), &1), Ok(0));
        assert_eq!(parts.join(core::iter::empty(), &1), Err(CapacityExceeded));
        assert_eq!(parts.join([0].into_iter(), &1), Ok(0), "what exists still grows");
        parts.clear();
        assert_eq!(parts.finished().count(), 0);
    }
}
