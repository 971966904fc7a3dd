//! Writes a recording so that a cut at any byte keeps every complete message before it.
//!
//! Messages stand in chunks of a quarter of a second: viewers seek by them, and one of them (Rerun) sees nothing else. A
//! chunk is not packed, so that the messages of a cut one can still be read, and it goes into the file as a whole, so
//! that a computer that loses its power has lost a quarter of a second. The index at the end is written by
//! [`Recorder::finish`]; without it everything can still be read.

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use floorguard_types::time::Stamp;
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;

use super::messages;
use super::raw::RawStream;
use super::schemas::{self, Schema};

/// A chunk holds messages of this much recorded time, and not many more bytes than this.
const CHUNK_US: u64 = 250_000;
const CHUNK_BYTES: u64 = 1 << 20;

/// A recording could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write the recording: {0}")]
pub struct RecordError(String);

impl From<mcap::McapError> for RecordError {
    fn from(error: mcap::McapError) -> Self {
        // What the system says is all that helps: a full disk, a folder that is gone.
        Self(match error {
            mcap::McapError::Io(cause) => cause.to_string(),
            other => other.to_string(),
        })
    }
}

/// A recording in the making.
pub struct Recorder<W: Write + Seek> {
    writer: mcap::Writer<NoSeek<W>>,
    /// When the first message of the chunk was recorded.
    chunk_began: Option<Stamp>,
    channels: BTreeMap<&'static str, (u16, u32)>,
}

/// When something was recorded, and when it was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Times {
    /// Recorded: the order of the file.
    pub logged: Stamp,
    /// Made, or for raw bytes: arrived.
    pub published: Stamp,
}

impl From<Stamp> for Times {
    fn from(stamp: Stamp) -> Self {
        Self { logged: stamp, published: stamp }
    }
}

impl<W: Write + Seek> Recorder<W> {
    /// Starts a recording.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn new(sink: W) -> Result<Self, RecordError> {
        let options = mcap::WriteOptions::new()
            .profile("ros2")
            .library("floorguard")
            .use_chunks(true)
            .chunk_size(Some(CHUNK_BYTES))
            .disable_seeking(true)
            .compression(None);
        let writer = options.create(NoSeek::new(sink))?;
        Ok(Self { writer, chunk_began: None, channels: BTreeMap::new() })
    }

    /// Writes named texts about the recording.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn metadata(&mut self, name: &str, texts: BTreeMap<String, String>) -> Result<(), RecordError> {
        Ok(self.writer.write_metadata(&Metadata { name: name.to_owned(), metadata: texts })?)
    }

    /// Writes one ROS 2 message.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn message(
        &mut self,
        topic: &'static str,
        schema: &Schema,
        times: impl Into<Times>,
        data: &[u8],
    ) -> Result<(), RecordError> {
        if !self.channels.contains_key(topic) {
            let id = self.writer.add_schema(schema.name, "ros2msg", schema.definition().as_bytes())?;
            let channel = self.writer.add_channel(id, topic, "cdr", &BTreeMap::new())?;
            self.channels.insert(topic, (channel, 0));
        }
        let times = times.into();
        let began = *self.chunk_began.get_or_insert(times.logged);
        if times.logged.as_micros() >= began.as_micros().saturating_add(CHUNK_US) {
            self.flush()?;
            self.chunk_began = Some(times.logged);
        }
        let Some((channel_id, sequence)) = self.channels.get_mut(topic) else { return Ok(()) };
        let header = MessageHeader {
            channel_id: *channel_id,
            sequence: *sequence,
            log_time: times.logged.as_micros().saturating_mul(1_000),
            publish_time: times.published.as_micros().saturating_mul(1_000),
        };
        *sequence = sequence.wrapping_add(1);
        Ok(self.writer.write_to_known_channel(&header, data)?)
    }

    /// Writes raw bytes of a stream: recorded when the tasks got them, published when they arrived.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn raw(
        &mut self,
        stream: RawStream,
        times: impl Into<Times>,
        data: &[u8],
    ) -> Result<(), RecordError> {
        self.message(stream.topic(), &schemas::OCTETS, times, &messages::octets(data))
    }

    /// Pushes everything written so far towards the disk.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        Ok(self.writer.flush()?)
    }

    /// Writes the index and closes the recording.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(mut self) -> Result<W, RecordError> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}
