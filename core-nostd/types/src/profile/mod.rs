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
//!
//! A profile of one's own: a board with a scanner of 1,081 beams and room for eight people.
//!
//! ```
//! use floorguard_types::profile::{Board, Of, Profile};
//! use floorguard_types::sensing::{BeamReturn, ScanOf};
//!
//! #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
//! struct Trolley;
//!
//! impl Profile for Trolley {
//!     type Beams = Of<1_081>;
//!     type Tracks = Of<8>;
//!     type Detections = Of<16>;
//!     type Pairs = Of<64>;
//!     // The rest as on the board.
//!     type Rings = <Board as Profile>::Rings;
//!     type Reflectivity = <Board as Profile>::Reflectivity;
//!     type Clusters = <Board as Profile>::Clusters;
//!     type Labels = <Board as Profile>::Labels;
//!     type MotionObjects = <Board as Profile>::MotionObjects;
//!     type MotionTracked = <Board as Profile>::MotionTracked;
//!     type MotionVoxels = <Board as Profile>::MotionVoxels;
//!     type MotionCells = <Board as Profile>::MotionCells;
//!     type MotionReferences = <Board as Profile>::MotionReferences;
//!     type FloorColumns = <Board as Profile>::FloorColumns;
//!     type FloorSamples = <Board as Profile>::FloorSamples;
//!     type FloorObjects = <Board as Profile>::FloorObjects;
//!     type FloorParts = <Board as Profile>::FloorParts;
//!     type RearScanners = <Board as Profile>::RearScanners;
//!     const FLOOR_LATTICE_COLUMNS: u16 = Board::FLOOR_LATTICE_COLUMNS;
//! }
//!
//! let mut scan = ScanOf::<Trolley>::EMPTY;
//! scan.beams.extend((0..1_081).map(|_| BeamReturn::Free(10_000)));
//! assert!(scan.beams.push(BeamReturn::Unknown).is_err());
//! ```

mod board_and_host;
mod keep;
mod list;
mod sizes;
mod table;

pub use board_and_host::{Board, Host, Native, Profile};
pub use keep::{Keep, Kept, LeftOut};
pub use list::List;
pub use sizes::{ListOf, Of, Size, TableOf};
pub use table::{Entry, Table};
