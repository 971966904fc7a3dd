//! Inputs that cost the most: searched on the emulated Cortex-M7, kept, and measured again with every firmware run.
//!
//! What is searched is what a room could look like to both scanners; every count is exact, so that the search climbs on
//! the very number that is claimed. A search proves no bound: it says how bad a stubborn adversary made it.

mod emulator;
mod record;
mod scene;
mod search;
mod tape;

pub use emulator::Emulator;
pub use record::{Kept, compare, load, store};
pub use scene::Scene;
pub use search::{STAGES, search};
