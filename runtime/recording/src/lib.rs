//! Recordings of a run: MCAP files with ROS 2 messages, which other people's tools open without a plugin.
//!
//! The raw bytes of every sensor are in them too, so a recording can be replayed through the same tasks.

pub mod capture;
pub mod carmen;
pub mod cdr;
mod chunk;
pub mod decode;
pub mod describe;
mod detection_messages;
pub mod detections;
mod lidar_view;
mod listener;
mod map_clouds;
mod message_count;
mod messages;
pub mod mission;
pub mod navigation;
pub mod order;
pub mod picture_messages;
mod raw;
mod reader;
mod recorder;
mod records;
pub mod replay;
mod run;
mod scan_map;
mod scan_turns;
mod schemas;
mod times;
pub mod topics;
pub mod truth;

pub use lidar_view::{LidarView, points as sweep_points};
pub use listener::{LiveMessage, MessageListener};
pub use map_clouds::{NamedCloud, map_clouds};
pub use message_count::count_messages;
pub use messages::{Diagnostic, GridImage, Marker, MarkerShape, PointRow, Severity, octets_of};
pub use messages::{
    diagnostics as diagnostics_message, flat_frame as tf_message, occupancy_grid as grid_message,
};
pub use raw::RawStream;
pub use reader::{ReadError, Recorded, Recording};
pub use recorder::{Compression, RecordError, Recorder};
pub use run::{END_METADATA, LEARNED, RUN_METADATA, RunInfo, RunRecorder};
pub use schemas::{OCTETS, Schema, TF_MESSAGE};
pub use times::Times;
pub use topics::MotionRow;
