//! Recordings of a run: MCAP files with ROS 2 messages, which other people's tools open without a plugin.
//!
//! The raw bytes of every sensor are in them too, so a recording can be replayed through the same tasks.

mod cdr;
mod messages;
mod reader;
mod recorder;
mod schemas;
mod topics;

pub use messages::{Diagnostic, GridImage, Marker, MarkerShape, PointRow, Severity};
pub use reader::{ReadError, Recorded, Recording};
pub use recorder::{RawStream, RecordError, Recorder};
pub use topics::MotionRow;
