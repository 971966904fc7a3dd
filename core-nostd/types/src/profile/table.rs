//! A table: an array whose length a profile chooses.

use core::fmt::Debug;
use core::slice::{Iter, IterMut};

use crate::geometry::{Point2, Point3};

/// What a table can hold: it has a value to begin with, known at compile time, because tables lie in statics.
pub trait Entry: Copy + Debug + PartialEq {
    /// Nothing yet. All its bytes are zero where that is possible: such a table takes no space in a program.
    const BLANK: Self;
}

impl Entry for bool {
    const BLANK: Self = false;
}

impl Entry for u8 {
    const BLANK: Self = 0;
}

impl Entry for u16 {
    const BLANK: Self = 0;
}

impl Entry for i16 {
    const BLANK: Self = 0;
}

impl Entry for u32 {
    const BLANK: Self = 0;
}

impl Entry for f32 {
    const BLANK: Self = 0.0;
}

impl Entry for Point2 {
    const BLANK: Self = Self::new(0.0, 0.0);
}

impl Entry for Point3 {
    const BLANK: Self = Self::new(0.0, 0.0, 0.0);
}

impl<T: Copy + Debug + PartialEq> Entry for Option<T> {
    const BLANK: Self = None;
}

impl<T: Entry, const N: usize> Entry for [T; N] {
    const BLANK: Self = [T::BLANK; N];
}

/// An array of a length that only the profile knows. Its methods are those of the slice.
pub trait Table<T: Entry>: Entry + AsRef<[T]> + AsMut<[T]> {
    /// The entry at a place; `None` beyond the end.
    fn get(&self, index: usize) -> Option<&T> {
        self.as_ref().get(index)
    }

    /// The same, to be changed.
    fn get_mut(&mut self, index: usize) -> Option<&mut T> {
        self.as_mut().get_mut(index)
    }

    /// All entries, in order.
    fn iter(&self) -> Iter<'_, T> {
        self.as_ref().iter()
    }

    /// The same, to be changed.
    fn iter_mut(&mut self) -> IterMut<'_, T> {
        self.as_mut().iter_mut()
    }

    /// Gives every entry this value.
    fn fill(&mut self, value: T) {
        self.as_mut().fill(value);
    }
}

impl<T: Entry, const N: usize> Table<T> for [T; N] {}
