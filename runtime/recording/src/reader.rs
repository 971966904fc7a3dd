//! Reads a recording, ours or somebody else's, whole or cut, with or without chunks.

use std::collections::BTreeMap;
use std::io::Read;
use std::sync::Arc;

use floorguard_types::time::Stamp;

use super::chunk::{ChunkError, salvage, unpack};
use super::records::{
    Fields, MAGIC, RECORD_HEAD_BYTES, RecordView, Step, first_record, first_record_head, opcode,
};

/// A single record must not be longer: a damaged length must not fill the memory.
const RECORD_BYTES_MAX: u64 = 1 << 30;
/// How much is read from the source at once.
const PORTION_BYTES: usize = 1 << 18;

/// One message of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded {
    /// Topic.
    pub topic: Arc<str>,
    /// Type of the message.
    pub schema: Arc<str>,
    /// How it is serialised: `cdr` for ROS 2.
    pub encoding: Arc<str>,
    /// When it was recorded.
    pub at: Stamp,
    /// When it was made: for raw bytes their arrival.
    pub published: Stamp,
    /// Serialised content.
    pub data: Vec<u8>,
}

/// A recording could not be read to its end. Everything before the bad place has been delivered.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file ends within a record, or without its end mark.
    #[error("the recording is cut: {messages} complete messages before the cut")]
    Cut {
        /// Messages delivered.
        messages: u64,
    },
    /// The bytes are no MCAP.
    #[error("not a readable MCAP recording after {messages} messages: {cause}")]
    Broken {
        /// Messages delivered.
        messages: u64,
        /// What is wrong.
        cause: String,
    },
    /// The file system refuses.
    #[error("cannot read the recording: {0}")]
    Io(#[from] std::io::Error),
}

#[derive(Clone)]
struct Topic {
    name: Arc<str>,
    schema: Arc<str>,
    encoding: Arc<str>,
}

/// A recording being read.
pub struct Recording<R: Read> {
    source: R,
    /// Bytes of the file that were read and not yet used, from `used` on.
    buffer: Vec<u8>,
    used: usize,
    /// Bytes of the file before the buffer.
    dropped: u64,
    begun: bool,
    /// Content of the chunk that is being read, and how far.
    chunk: (Vec<u8>, usize),
    schemas: BTreeMap<u16, Arc<str>>,
    channels: BTreeMap<u16, Topic>,
    metadata: BTreeMap<String, BTreeMap<String, String>>,
    messages: u64,
    /// The file ends within the chunk that is being read.
    cut: bool,
    finished: bool,
}

impl<R: Read> Recording<R> {
    /// Starts reading.
    pub fn new(source: R) -> Self {
        Self {
            source,
            buffer: Vec::new(),
            used: 0,
            dropped: 0,
            begun: false,
            chunk: (Vec::new(), 0),
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            metadata: BTreeMap::new(),
            messages: 0,
            cut: false,
            finished: false,
        }
    }

    /// Named texts that were met so far.
    pub fn metadata(&self, name: &str) -> Option<&BTreeMap<String, String>> {
        self.metadata.get(name)
    }

    /// Topics that were met so far, with their types.
    pub fn topics(&self) -> Vec<(Arc<str>, Arc<str>)> {
        self.channels.values().map(|topic| (topic.name.clone(), topic.schema.clone())).collect()
    }

    /// Byte of the file behind the record that was taken last.
    fn file_position(&self) -> u64 {
        self.dropped + self.used as u64
    }

    fn broken(&self, cause: impl Into<String>) -> ReadError {
        ReadError::Broken { messages: self.messages, cause: cause.into() }
    }

    /// Makes sure that so many unused bytes are in the buffer. False at the end of the source.
    fn fill(&mut self, wanted: usize) -> Result<bool, ReadError> {
        while self.buffer.len() - self.used < wanted {
            self.dropped += self.used as u64;
            self.buffer.drain(..self.used);
            self.used = 0;
            let before = self.buffer.len();
            let portion = wanted.saturating_sub(before).max(PORTION_BYTES);
            let read = self.source.by_ref().take(portion as u64).read_to_end(&mut self.buffer)?;
            if read == 0 {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn begin(&mut self) -> Result<(), ReadError> {
        self.begun = true;
        let whole = self.fill(MAGIC.len())?;
        let found = self.buffer.get(..MAGIC.len().min(self.buffer.len())).unwrap_or_default();
        if !MAGIC.starts_with(found) {
            return Err(self.broken("it does not begin as an MCAP file does"));
        }
        if !whole {
            return Err(ReadError::Cut { messages: 0 });
        }
        self.used = MAGIC.len();
        Ok(())
    }

    fn step(&mut self) -> Result<Option<Recorded>, ReadError> {
        if !self.begun {
            self.begin()?;
        }
        while !self.finished {
            if self.chunk.1 < self.chunk.0.len() {
                if let Some(message) = self.step_in_chunk()? {
                    return Ok(Some(message));
                }
                continue;
            }
            let needed = match first_record(self.buffer.get(self.used..).unwrap_or_default()) {
                Step::Needs(bytes) if bytes > RECORD_BYTES_MAX => {
                    return Err(self.broken(format!("a record claims to be {bytes} bytes long")));
                }
                Step::Needs(bytes) => bytes as usize,
                Step::Whole(_, length) => length,
            };
            // The head of a record tells how much there is to come: two rounds at most.
            if !self.fill(needed)? {
                let rest = self.buffer.get(self.used..).unwrap_or_default();
                let records = first_record_head(rest).filter(|_| !self.cut).and_then(|(opcode, content)| {
                    if opcode == opcode::CHUNK { salvage(content).map(<[u8]>::to_vec) } else { None }
                });
                self.cut = true;
                match records {
                    Some(records) if !records.is_empty() => self.chunk = (records, 0),
                    _ => return Err(ReadError::Cut { messages: self.messages }),
                }
                continue;
            }
            if let Some(message) = self.step_in_buffer()? {
                return Ok(Some(message));
            }
        }
        Ok(None)
    }

    fn step_in_buffer(&mut self) -> Result<Option<Recorded>, ReadError> {
        // Moved out for the time, so that the record can borrow it while the topics change.
        let buffer = std::mem::take(&mut self.buffer);
        let step = first_record(buffer.get(self.used..).unwrap_or_default());
        let taken = match step {
            Step::Whole(record, length) => {
                self.used += length;
                self.take(record)
            }
            Step::Needs(_) => Ok(None),
        };
        self.buffer = buffer;
        taken
    }

    fn step_in_chunk(&mut self) -> Result<Option<Recorded>, ReadError> {
        let (bytes, at) = std::mem::take(&mut self.chunk);
        match first_record(bytes.get(at..).unwrap_or_default()) {
            Step::Whole(RecordView { opcode: opcode::CHUNK, .. }, _) => {
                Err(self.broken("a chunk in a chunk"))
            }
            Step::Whole(record, length) => {
                let taken = self.take(record);
                self.chunk = (bytes, at + length.max(RECORD_HEAD_BYTES));
                taken
            }
            Step::Needs(_) if self.cut => Err(ReadError::Cut { messages: self.messages }),
            Step::Needs(_) => Err(self.broken("a chunk ends within a record")),
        }
    }

    fn take(&mut self, record: RecordView<'_>) -> Result<Option<Recorded>, ReadError> {
        let messages = self.messages;
        let cause = "a record is too short for what it should hold";
        let short = || ReadError::Broken { messages, cause: cause.to_owned() };
        let mut fields = Fields(record.content);
        match record.opcode {
            opcode::SCHEMA => {
                let (id, name) = fields.u16().zip(fields.text()).ok_or_else(short)?;
                self.schemas.insert(id, name.into());
            }
            opcode::CHANNEL => {
                let (id, schema) = fields.u16().zip(fields.u16()).ok_or_else(short)?;
                let (name, encoding) = fields.text().zip(fields.text()).ok_or_else(short)?;
                let schema = self.schemas.get(&schema).cloned().unwrap_or_else(|| "".into());
                self.channels.insert(id, Topic { name: name.into(), schema, encoding: encoding.into() });
            }
            opcode::MESSAGE => return message(fields).ok_or_else(short).map(|message| self.accept(message)),
            opcode::METADATA => {
                let (name, map) = fields.text().zip(fields.map()).ok_or_else(short)?;
                self.metadata.insert(name, map);
            }
            opcode::CHUNK => {
                let records = unpack(fields).map_err(|error| match error {
                    ChunkError::Short => short(),
                    other => self
                        .broken(format!("{other}, in the record that ends at byte {}", self.file_position())),
                })?;
                self.chunk = (records, 0);
            }
            opcode::DATA_END => self.finished = true,
            _ => {}
        }
        Ok(None)
    }

    fn accept(&mut self, message: MessageView<'_>) -> Option<Recorded> {
        let topic = self.channels.get(&message.channel)?.clone();
        self.messages += 1;
        Some(Recorded {
            topic: topic.name,
            schema: topic.schema,
            encoding: topic.encoding,
            at: Stamp::from_micros(message.logged_ns / 1_000),
            published: Stamp::from_micros(message.published_ns / 1_000),
            data: message.data.to_vec(),
        })
    }
}

struct MessageView<'a> {
    channel: u16,
    logged_ns: u64,
    published_ns: u64,
    data: &'a [u8],
}

fn message(mut fields: Fields<'_>) -> Option<MessageView<'_>> {
    let channel = fields.u16()?;
    let _sequence = fields.u32()?;
    Some(MessageView { channel, logged_ns: fields.u64()?, published_ns: fields.u64()?, data: fields.0 })
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
