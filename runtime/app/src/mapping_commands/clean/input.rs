//! A recording of a lidar, whatever its kind, that can be read again and again.

use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_host::packing::{beginning, must_be_a_file};
use floorguard_mapping_host::clean::{CleanConfig, RawSweep};

use super::capture::LidarCapture;
use super::clouds::CloudBag;
use crate::recordings::MCAP_MAGIC;

enum Source {
    Capture(LidarCapture),
    Clouds(CloudBag),
}

/// A recording and its times.
pub struct SweepFile {
    source: Source,
    /// Time of the first return, seconds.
    pub first_s: f64,
    /// Time of the last return, seconds.
    pub last_s: f64,
    /// Sweeps in it.
    pub sweeps: u64,
}

impl SweepFile {
    /// Reads the file once.
    ///
    /// # Errors
    /// It cannot be read, or holds no lidar.
    pub fn open(path: &Path) -> anyhow::Result<Self> {
        let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
        must_be_a_file(path).map_err(|error| bad(&error))?;
        let start = beginning(path, MCAP_MAGIC.len() as u64).map_err(|error| bad(&error))?;
        let source = if start.starts_with(MCAP_MAGIC) {
            Source::Clouds(CloudBag::open(path)?)
        } else {
            Source::Capture(LidarCapture::open(path)?)
        };
        let mut file = Self { source, first_s: f64::INFINITY, last_s: f64::NEG_INFINITY, sweeps: 0 };
        let (mut first_s, mut last_s, mut sweeps) = (file.first_s, file.last_s, 0);
        file.for_each(&mut |sweep| {
            first_s = sweep.start_s.min(first_s);
            last_s = last_s.max(sweep.start_s + sweep.duration_s());
            sweeps += 1;
            Ok(())
        })?;
        if sweeps == 0 {
            return Err(bad(&"no return in it: the lidar was blind").into());
        }
        (file.first_s, file.last_s, file.sweeps) = (first_s, last_s, sweeps);
        Ok(file)
    }

    /// Calls `each` for every sweep.
    ///
    /// # Errors
    /// The file is cut off or damaged, or `each` refuses.
    pub fn for_each(&self, each: &mut dyn FnMut(&RawSweep) -> anyhow::Result<()>) -> anyhow::Result<()> {
        match &self.source {
            Source::Capture(capture) => capture.for_each(each),
            Source::Clouds(bag) => bag.for_each(each),
        }
    }

    /// Values for its lidar.
    pub fn config(&self) -> CleanConfig {
        match &self.source {
            Source::Capture(capture) => capture.config(),
            Source::Clouds(bag) => bag.config(),
        }
    }

    /// The model of the lidar, or the topic of its clouds.
    pub fn name(&self) -> &str {
        match &self.source {
            Source::Capture(capture) => capture.model_name(),
            Source::Clouds(bag) => bag.topic(),
        }
    }
}
