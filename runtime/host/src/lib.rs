//! What every program of the robot's Linux computer stands on: executor, clocks, carriers, lines for people and machines,
//! packed files, and the outcomes that become exit codes.

#[macro_use]
pub mod console;

pub mod carriers;
pub mod executor;
pub mod outcome;
pub mod packing;
pub mod words;

// Its implementation for programs with threads is linked by the crates that name it.
use critical_section as _;

#[doc(hidden)]
pub use anstream;
