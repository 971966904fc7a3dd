//! The operator's panel: a page in any browser that shows the robot live, with buttons for pause, resume and reset.
//!
//! It runs on a thread of its own and looks at the newest picture only: slow or many browsers lose pictures, they never
//! hold anybody up. A command goes into a short queue that the robot's side empties when it likes. Nothing here can
//! release a stop: reset is a request that the guard judges, as from a button on the machine.

mod access;
mod brief;
mod camera_picture;
mod connections;
mod day_keeper;
mod frame;
mod headline;
mod held_history;
mod hub;
mod layers;
mod others;
mod page;
#[cfg(test)]
mod page_tests;
mod pdf_of_day;
pub(crate) mod pieces;
mod plain;
mod records;
mod schedule_clock;
mod server;
mod server_orders;
mod server_records;
mod server_upkeep;
mod supplies;
mod view;
#[cfg(test)]
mod words_tests;

pub use access::{Access, AccessError, Role, Tokens};
pub use held_history::{HeldEvent, HeldHistory, HeldKind};
pub use hub::{Order, Panel, PanelOrder};
pub use page::page;
pub use plain::remedy;
pub use records::Records;
pub use view::PanelView;
