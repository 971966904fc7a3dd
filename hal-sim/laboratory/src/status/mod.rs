//! The status report of a mission for the operator: what was dirty before, what is clean after, and what is not
//! promised. One page without anything outside it, for a tablet.

mod account;
mod base64;
mod page;
mod raster;
mod spots;

pub use account::{MissionStatus, ZoneStatus};
pub use page::write_status;
pub use spots::Spot;
