//! Who records and shows a run: a tape for the emulated board, a recording, the operator's panel.

mod onlooker;
mod tape;
mod witnesses;

pub use onlooker::{Notes, with_onlooker};
pub use tape::{Tape, encode_route};
pub use witnesses::{FileRecorder, IN_REAL_TIME, RecordedRun, Witnesses};
