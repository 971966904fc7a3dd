//! What a profile keeps or does without.

use core::fmt::Debug;

use super::sizes::Size;
use super::table::{Entry, Table};

/// Whether something is kept: [`Kept`] or [`LeftOut`].
pub trait Keep: Copy + Debug + Default + PartialEq + Eq + 'static {
    /// A table of a size, or an empty one.
    type Table<T: Entry, S: Size>: Table<T>;
}

/// It is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kept;

/// It is not: it takes neither memory nor time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeftOut;

impl Keep for Kept {
    type Table<T: Entry, S: Size> = S::Table<T>;
}

impl Keep for LeftOut {
    type Table<T: Entry, S: Size> = [T; 0];
}
