//! A table: an array whose length a profile chooses.

use core::fmt::Debug;
use core::slice::{Iter, IterMut};

use crate::geometry::{Point2, Point3};

/// What a table can hold: it has a value to begin with, known at compile time, because tables lie in statics.
pub trait Entry: Copy + Debug + PartialEq {
    /// Nothing yet. All its bytes are zero where that is possible: such a table takes no space in a program.
    const BLANK: Self;
}

macro_rules! blank {
    ($($entry:ty = $blank:expr),*) => { $(impl Entry for $entry { const BLANK: Self = $blank; })* };
}

blank!(
    bool = false,
    u8 = 0,
    u16 = 0,
    u32 = 0,
    f32 = 0.0,
    Point2 = Point2::new(0.0, 0.0),
    Point3 = Point3::new(0.0, 0.0, 0.0)
);

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
