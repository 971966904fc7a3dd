//! A size as a type: lists and tables of it.

use core::fmt::Debug;

use super::list::List;
use super::table::{Entry, Table};

/// A number of entries, as a type. [`Of`] is every one.
pub trait Size: Copy + Debug + Default + PartialEq + Eq + 'static {
    /// The number.
    const N: usize;
    /// An array of so many entries.
    type Table<T: Entry>: Table<T>;
    /// A list of at most so many entries.
    type List<T: Clone + Debug + PartialEq>: List<T>;
}

/// So many entries.
///
/// ```
/// use floorguard_types::profile::{List, ListOf, Of, Size};
///
/// let mut list: ListOf<u8, Of<2>> = List::EMPTY;
/// assert_eq!((list.push(1), list.push(2), list.push(3)), (Ok(()), Ok(()), Err(3)));
/// assert_eq!(<Of<2>>::N, 2);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Of<const N: usize>;

impl<const N: usize> Size for Of<N> {
    const N: usize = N;
    type Table<T: Entry> = [T; N];
    type List<T: Clone + Debug + PartialEq> = heapless::Vec<T, N>;
}

/// An array of a size.
pub type TableOf<T, S> = <S as Size>::Table<T>;
/// A list of a size.
pub type ListOf<T, S> = <S as Size>::List<T>;
