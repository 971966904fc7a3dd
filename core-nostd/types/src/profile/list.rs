//! A list: entries up to a capacity that a profile chooses.

use core::fmt::Debug;
use core::ops::{Deref, DerefMut};

/// A list of at most so many entries as the profile allows. The methods are those of [`heapless::Vec`].
pub trait List<T>:
    Clone + Debug + PartialEq + Default + Deref<Target = [T]> + DerefMut + Extend<T> + FromIterator<T>
{
    /// Without entries.
    const EMPTY: Self;

    /// Adds an entry at the end. Constant time.
    ///
    /// # Errors
    /// The list is full; the entry comes back.
    fn push(&mut self, entry: T) -> Result<(), T>;

    /// Inserts an entry before the one at a place. Linear.
    ///
    /// # Errors
    /// The list is full; the entry comes back.
    fn insert(&mut self, index: usize, entry: T) -> Result<(), T>;

    /// Gives it this length; new entries have this value.
    ///
    /// # Errors
    /// The length is more than fits; then nothing is changed.
    fn resize(&mut self, length: usize, entry: T) -> Result<(), heapless::CapacityError>;

    /// Takes the last entry off.
    fn pop(&mut self) -> Option<T>;

    /// Leaves out all entries.
    fn clear(&mut self);

    /// Keeps the entries, in their order, of which `keep` is true. Linear.
    fn retain(&mut self, keep: impl FnMut(&T) -> bool);

    /// The same; `keep` may change those that stay.
    fn retain_mut(&mut self, keep: impl FnMut(&mut T) -> bool);

    /// Nothing more fits.
    fn is_full(&self) -> bool;
}

impl<T: Clone + Debug + PartialEq, const N: usize> List<T> for heapless::Vec<T, N> {
    const EMPTY: Self = Self::new();

    #[inline]
    fn push(&mut self, entry: T) -> Result<(), T> {
        self.as_mut_view().push(entry)
    }

    #[inline]
    fn insert(&mut self, index: usize, entry: T) -> Result<(), T> {
        // The library's own panics beyond the end.
        let place = index.min(self.len());
        self.as_mut_view().insert(place, entry)
    }

    #[inline]
    fn resize(&mut self, length: usize, entry: T) -> Result<(), heapless::CapacityError> {
        self.as_mut_view().resize(length, entry)
    }

    #[inline]
    fn pop(&mut self) -> Option<T> {
        self.as_mut_view().pop()
    }

    #[inline]
    fn clear(&mut self) {
        self.as_mut_view().clear();
    }

    #[inline]
    fn retain(&mut self, keep: impl FnMut(&T) -> bool) {
        self.as_mut_view().retain(keep);
    }

    #[inline]
    fn retain_mut(&mut self, keep: impl FnMut(&mut T) -> bool) {
        self.as_mut_view().retain_mut(keep);
    }

    #[inline]
    fn is_full(&self) -> bool {
        self.as_view().is_full()
    }
}
