//! Finished clouds as a recording: Foxglove and Rerun show them without a plugin.

use std::io::Cursor;

use floorguard_types::time::Stamp;

use super::messages::{PointRow, point_cloud};
use super::recorder::{RecordError, Recorder};
use super::schemas;

/// A cloud of a map.
#[derive(Clone, Copy, Debug)]
pub struct NamedCloud<'a> {
    /// Its topic.
    pub topic: &'static str,
    /// Its points in the map.
    pub points: &'a [PointRow],
}

/// A recording with one `sensor_msgs/PointCloud2` for each cloud, in the frame `map`, at a time.
///
/// # Errors
/// A cloud is too large for a message.
pub fn map_clouds(clouds: &[NamedCloud<'_>], at: Stamp) -> Result<Vec<u8>, RecordError> {
    let mut recorder = Recorder::new(Cursor::new(Vec::new()))?;
    for cloud in clouds {
        recorder.message(cloud.topic, &schemas::POINT_CLOUD, at, &point_cloud(at, "map", cloud.points))?;
    }
    Ok(recorder.finish()?.into_inner())
}
