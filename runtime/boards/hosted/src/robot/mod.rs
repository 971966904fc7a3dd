//! The robot on this computer: both rings on threads of their own, on the carriers that `robot.toml` names.

mod links;
mod rings;
mod stop_files;
mod tap;

pub use links::{Links, Missing, ScannerLink};
pub(crate) use rings::StopsAtEnd;
pub use rings::{HostedShared, run_rings};
pub use stop_files::{black_box_log, write_stop_file};
pub use tap::{Tap, TapRow, TapRows, Tapped, tap};
