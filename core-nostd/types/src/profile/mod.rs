//! How much memory a program has for what: its profile.
//!
//! A profile names a [`Size`] for each list and table of the core. It is a type, so the compiler makes one copy of the code
//! for it, and arrays stay arrays: nothing is asked at run time. Two are here, [`Board`] and [`Host`]; a robot with another
//! memory writes its own. Both may be in one program, and no feature changes either.
//!
//! ```
//! use floorguard_types::profile::{Board, Host};
//! use floorguard_types::sensing::ScanOf;
//!
//! assert!(size_of::<ScanOf<Board>>() < 2_300);
//! assert!(size_of::<ScanOf<Host>>() > 11_000);
//! ```

mod keep;
mod list;
mod sizes;
mod table;
mod two;

pub use keep::{Keep, Kept, LeftOut};
pub use list::List;
pub use sizes::{ListOf, Of, Size, TableOf};
pub use table::{Entry, Table};
pub use two::{Board, Host, Native, Profile};
