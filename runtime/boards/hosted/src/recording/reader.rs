//! Reads a recording, ours or somebody else's, whole or cut.

use std::collections::BTreeMap;
use std::io::Read;

use floorguard_core::time::Stamp;
use mcap::parse_record;
use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// One message of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded {
    /// Topic.
    pub topic: String,
    /// Type of the message; empty for raw bytes.
    pub schema: String,
    /// When it was recorded.
    pub at: Stamp,
    /// Serialised content.
    pub data: Vec<u8>,
}

/// A recording could not be read to its end. Everything before the bad place has been delivered.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file ends within a record.
    #[error("the recording is cut: {messages} complete messages before the cut")]
    Cut {
        /// Messages delivered.
        messages: u64,
    },
    /// The bytes are no MCAP.
    #[error("not a readable recording after {messages} messages: {cause}")]
    Broken {
        /// Messages delivered.
        messages: u64,
        /// What the reader says.
        cause: mcap::McapError,
    },
    /// The file system refuses.
    #[error("cannot read the recording: {0}")]
    Io(#[from] std::io::Error),
}

/// A recording being read.
pub struct Recording<R: Read> {
    source: R,
    reader: LinearReader,
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, (String, String)>,
    messages: u64,
    finished: bool,
}

impl<R: Read> Recording<R> {
    /// Starts reading.
    pub fn new(source: R) -> Self {
        // A cut file has no closing magic; it is reported as a cut, not refused.
        let options =
            LinearReaderOptions::default().with_skip_end_magic(true).with_record_length_limit(1 << 30);
        Self {
            source,
            reader: LinearReader::new_with_options(options),
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            messages: 0,
            finished: false,
        }
    }

    fn step(&mut self) -> Result<Option<Recorded>, ReadError> {
        while !self.finished {
            match self.reader.next_event() {
                None => self.finished = true,
                Some(Err(mcap::McapError::UnexpectedEof | mcap::McapError::UnexpectedEoc)) => {
                    self.finished = true;
                    return Err(ReadError::Cut { messages: self.messages });
                }
                Some(Err(cause)) => {
                    self.finished = true;
                    return Err(ReadError::Broken { messages: self.messages, cause });
                }
                Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                    let room = self.reader.insert(wanted);
                    let count = self.source.read(room)?;
                    self.reader.notify_read(count);
                }
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    let record = parse_record(opcode, data)
                        .map_err(|cause| ReadError::Broken { messages: self.messages, cause })?
                        .into_owned();
                    if let Some(recorded) = self.accept(record) {
                        return Ok(Some(recorded));
                    }
                }
            }
        }
        Ok(None)
    }

    fn accept(&mut self, record: Record<'static>) -> Option<Recorded> {
        match record {
            Record::Schema { header, .. } => {
                self.schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
                self.channels.insert(channel.id, (channel.topic, schema));
            }
            Record::Message { header, data } => {
                let (topic, schema) = self.channels.get(&header.channel_id)?.clone();
                self.messages += 1;
                let at = Stamp::from_micros(header.log_time / 1_000);
                return Some(Recorded { topic, schema, at, data: data.into_owned() });
            }
            _ => {}
        }
        None
    }
}

impl<R: Read> Iterator for Recording<R> {
    type Item = Result<Recorded, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        let step = self.step();
        if step.is_err() {
            self.finished = true;
        }
        step.transpose()
    }
}
