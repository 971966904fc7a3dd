//! Records of an MCAP file as they stand in it: an opcode, a length, content. Nothing is copied here.
//!
//! Source: MCAP specification, version 0. All numbers little-endian.

/// First and last bytes of a file.
pub const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";
/// In front of the content of a record: opcode and length.
pub const RECORD_HEAD_BYTES: usize = 9;

/// Opcodes that a reader of messages needs.
pub mod opcode {
    /// Name and definition of a message type.
    pub const SCHEMA: u8 = 0x03;
    /// A topic.
    pub const CHANNEL: u8 = 0x04;
    /// A message.
    pub const MESSAGE: u8 = 0x05;
    /// Records packed together.
    pub const CHUNK: u8 = 0x06;
    /// Named pairs of texts.
    pub const METADATA: u8 = 0x0C;
    /// The index begins.
    pub const DATA_END: u8 = 0x0F;
}

/// A record in the bytes of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordView<'a> {
    /// What it is.
    pub opcode: u8,
    /// Its content.
    pub content: &'a [u8],
}

/// What stands at the beginning of some bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step<'a> {
    /// A whole record, and how many bytes it takes with its head.
    Whole(RecordView<'a>, usize),
    /// The bytes end within a record of so many bytes.
    Needs(u64),
}

/// Parses the first record of `bytes`.
#[must_use]
pub fn first_record(bytes: &[u8]) -> Step<'_> {
    let Some((&[opcode, ref length @ ..], rest)) = bytes.split_first_chunk::<RECORD_HEAD_BYTES>() else {
        return Step::Needs(RECORD_HEAD_BYTES as u64);
    };
    let length = u64::from_le_bytes(*length);
    match usize::try_from(length).ok().and_then(|length| rest.get(..length)) {
        Some(content) => Step::Whole(RecordView { opcode, content }, RECORD_HEAD_BYTES + content.len()),
        None => Step::Needs(length.saturating_add(RECORD_HEAD_BYTES as u64)),
    }
}

/// Opcode and content of the first record, as much of it as is there.
#[must_use]
pub fn first_record_head(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let (head, content) = bytes.split_first_chunk::<RECORD_HEAD_BYTES>()?;
    Some((head[0], content))
}

/// Takes numbers, texts and byte strings off the front of a record's content.
#[derive(Clone, Copy, Debug)]
pub struct Fields<'a>(pub &'a [u8]);

impl<'a> Fields<'a> {
    fn chunk<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (chunk, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*chunk)
    }

    /// 16 bits.
    pub fn u16(&mut self) -> Option<u16> {
        self.chunk().map(u16::from_le_bytes)
    }

    /// 32 bits.
    pub fn u32(&mut self) -> Option<u32> {
        self.chunk().map(u32::from_le_bytes)
    }

    /// 64 bits.
    pub fn u64(&mut self) -> Option<u64> {
        self.chunk().map(u64::from_le_bytes)
    }

    /// So many bytes.
    pub fn bytes(&mut self, count: u64) -> Option<&'a [u8]> {
        let (bytes, rest) = self.0.split_at_checked(usize::try_from(count).ok()?)?;
        self.0 = rest;
        Some(bytes)
    }

    /// Text with its length; bytes that are no text are replaced.
    pub fn text(&mut self) -> Option<String> {
        let length = self.u32()?;
        self.bytes(length.into()).map(|bytes| String::from_utf8_lossy(bytes).into_owned())
    }

    /// Named texts, in the order of their names.
    pub fn map(&mut self) -> Option<std::collections::BTreeMap<String, String>> {
        let length = self.u32()?;
        let mut inner = Fields(self.bytes(length.into())?);
        let mut map = std::collections::BTreeMap::new();
        while !inner.0.is_empty() {
            map.insert(inner.text()?, inner.text()?);
        }
        Some(map)
    }
}
