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

use super::listener::{LiveMessage, MessageListener};
use super::messages;
use super::raw::RawStream;
use super::scan_turns::ScanTurns;
use super::schemas::{self, Schema};
use super::times::Times;

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

/// A recording in the making: a file, listeners, or both.
pub struct Recorder<W: Write + Seek> {
    file: Option<ChannelFile<W>>,
    listeners: Vec<Box<dyn MessageListener>>,
    /// Of the safety scanner.
    pub(crate) turns: ScanTurns,
}

/// The file of a recording.
struct ChannelFile<W: Write + Seek> {
    writer: mcap::Writer<NoSeek<W>>,
    /// When the first message of the chunk was recorded.
    chunk_began: Option<Stamp>,
    channels: BTreeMap<&'static str, (u16, u32)>,
}

/// How the chunks of a recording are packed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// Not at all: the messages of a chunk that was cut can still be read.
    #[default]
    None,
    /// LZ4 frames: fast. Needs the feature `compression`.
    Lz4,
    /// Zstandard: small. Needs the feature `compression`.
    Zstd,
}

impl Compression {
    /// As MCAP's library calls it.
    #[cfg(feature = "compression")]
    fn of_library(self) -> Result<Option<mcap::Compression>, RecordError> {
        Ok(match self {
            Self::None => None,
            Self::Lz4 => Some(mcap::Compression::Lz4),
            Self::Zstd => Some(mcap::Compression::Zstd),
        })
    }

    /// As MCAP's library calls it.
    #[cfg(not(feature = "compression"))]
    fn of_library(self) -> Result<Option<mcap::Compression>, RecordError> {
        match self {
            Self::None => Ok(None),
            Self::Lz4 | Self::Zstd => Err(RecordError(
                "this program was built without compression; build it with `--features compression`"
                    .to_owned(),
            )),
        }
    }
}

impl<W: Write + Seek> Recorder<W> {
    /// Starts a recording, not packed.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn new(sink: W) -> Result<Self, RecordError> {
        Self::packed(sink, Compression::None)
    }

    /// Starts a recording with packed chunks.
    ///
    /// # Errors
    /// When the file cannot be written, or the program was built without compression.
    pub fn packed(sink: W, compression: Compression) -> Result<Self, RecordError> {
        let options = mcap::WriteOptions::new()
            .profile("ros2")
            .library("floorguard")
            .use_chunks(true)
            .chunk_size(Some(CHUNK_BYTES))
            .disable_seeking(true)
            .compression(compression.of_library()?);
        let writer = options.create(NoSeek::new(sink))?;
        let file = ChannelFile { writer, chunk_began: None, channels: BTreeMap::new() };
        Ok(Self { file: Some(file), listeners: Vec::new(), turns: ScanTurns::default() })
    }

    /// No file: what is written reaches listeners only.
    #[must_use]
    pub fn without_file() -> Self {
        Self { file: None, listeners: Vec::new(), turns: ScanTurns::default() }
    }

    /// Every message from now on reaches this listener, too.
    pub fn listen(&mut self, listener: Box<dyn MessageListener>) {
        self.listeners.push(listener);
    }

    /// The file is given up as it is; listeners go on.
    pub(super) fn abandon_file(&mut self) {
        self.file = None;
    }

    /// Writes named texts about the recording.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn metadata(&mut self, name: &str, texts: BTreeMap<String, String>) -> Result<(), RecordError> {
        let Some(file) = &mut self.file else { return Ok(()) };
        Ok(file.writer.write_metadata(&Metadata { name: name.to_owned(), metadata: texts })?)
    }

    /// Writes one ROS 2 message.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn message(
        &mut self,
        topic: &'static str,
        schema: &'static Schema,
        times: impl Into<Times>,
        data: &[u8],
    ) -> Result<(), RecordError> {
        let times = times.into();
        let message = LiveMessage { topic, schema, times, data };
        self.listeners.iter_mut().for_each(|listener| listener.message(&message));
        self.file.as_mut().map_or(Ok(()), |file| file.message(&message))
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
        self.file.as_mut().map_or(Ok(()), |file| Ok(file.writer.flush()?))
    }

    /// Writes the index and closes the recording; gives the file back, if there is one.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn close(self) -> Result<Option<W>, RecordError> {
        let Some(mut file) = self.file else { return Ok(None) };
        file.writer.finish()?;
        Ok(Some(file.writer.into_inner().into_inner()))
    }

    /// The same of a recording that has a file.
    ///
    /// # Errors
    /// When the file cannot be written, or there is none.
    pub fn finish(self) -> Result<W, RecordError> {
        self.close()?.ok_or_else(|| RecordError("it has no file".to_owned()))
    }
}

impl<W: Write + Seek> ChannelFile<W> {
    fn message(&mut self, message: &LiveMessage<'_>) -> Result<(), RecordError> {
        let LiveMessage { topic, schema, times, data } = *message;
        if !self.channels.contains_key(topic) {
            let id =
                self.writer.add_schema(schema.name, schemas::ENCODING, schema.definition().as_bytes())?;
            let channel = self.writer.add_channel(id, topic, messages::ENCODING, &BTreeMap::new())?;
            self.channels.insert(topic, (channel, 0));
        }
        let began = *self.chunk_began.get_or_insert(times.logged);
        if times.logged.as_micros() >= began.as_micros().saturating_add(CHUNK_US) {
            self.writer.flush()?;
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
}
