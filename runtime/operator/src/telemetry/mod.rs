//! Who records and shows a run: a tape for the emulated board, a recording, the operator's panel.

mod recorded_run;
mod run_link;
mod run_sinks;
mod tape;
mod telemetry_thread;

pub use recorded_run::{FileRecorder, IN_REAL_TIME, RECORDED_AT, RecordedRun};
pub use run_link::{LinkMoment, RunLink};
pub use run_sinks::RunSinks;
pub use tape::{Tape, encode_route};
pub use telemetry_thread::{TelemetrySender, with_telemetry};
