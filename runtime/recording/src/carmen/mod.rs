//! CARMEN logs: the text format of most published 2-D laser recordings.

mod line;
mod log;

pub use line::{CarmenLine, LaserLine, LineError, parse_line};
pub use log::{CarmenError, CarmenLog};
