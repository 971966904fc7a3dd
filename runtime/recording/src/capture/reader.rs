//! Streams a capture: everything before a bad place is delivered, then the error.

use std::fs::File;
use std::io::{self, BufRead as _, BufReader, Read};
use std::path::Path;
use std::sync::{Arc, OnceLock};

use pcap_parser::traits::PcapReaderIterator;
use pcap_parser::{Block, Linktype, PcapBlockOwned, PcapError, create_reader};

use super::datagram::{self, Content, Datagram};
use floorguard_host::packing;

/// A capture that cannot be read to its end.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// The file cannot be opened.
    #[error("{path}: cannot be opened: {cause}")]
    Open {
        /// The file.
        path: String,
        /// What the system says.
        cause: std::io::Error,
    },
    /// There is nothing in it.
    #[error("{path} is empty")]
    Empty {
        /// The file.
        path: String,
    },
    /// The bytes are no capture.
    #[error(
        "{path} is no .pcap or .pcapng capture (nor one packed with gzip, bzip2 or zstd); recordings and bags are .mcap, laser logs .clf or .log"
    )]
    NotACapture {
        /// The file.
        path: String,
    },
    /// The file ends within a packet; everything before has been delivered.
    #[error("{path} is cut off after {packets} packets; copy it again")]
    Truncated {
        /// The file.
        path: String,
        /// Packets before the cut.
        packets: u64,
    },
    /// The bytes make no sense any more.
    #[error("{path} is damaged after {packets} packets: {cause}")]
    Damaged {
        /// The file.
        path: String,
        /// Packets before the damage.
        packets: u64,
        /// What the parser says.
        cause: String,
    },
    /// The capture was made on a kind of link that carries no IP packets we know.
    #[error("{path} was captured on link type {linktype}; known are Ethernet, raw IP and Linux cooked")]
    LinkType {
        /// The file.
        path: String,
        /// Number of the link type.
        linktype: i32,
    },
}

/// What was not a datagram.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CaptureNotes {
    /// Frames in the file so far.
    pub packets: u64,
    /// IP fragments, which are not put together.
    pub fragments: u64,
    /// Frames of other protocols.
    pub other: u64,
}

/// A capture being read.
pub struct Capture {
    path: String,
    reader: Box<dyn PcapReaderIterator + Send>,
    /// Why the file could not be read on, which the parser does not tell.
    failure: Arc<OnceLock<String>>,
    links: Vec<(Linktype, u64)>,
    nanoseconds: bool,
    notes: CaptureNotes,
    finished: bool,
}

/// Largest frame that the reader accepts, bytes.
const BUFFER_BYTES: usize = 1 << 20;

impl Capture {
    /// Opens a file.
    ///
    /// # Errors
    /// When it cannot be opened or is no capture.
    pub fn open(path: &Path) -> Result<Self, CaptureError> {
        let shown = path.display().to_string();
        let unusable = |cause| CaptureError::Open { path: shown.clone(), cause };
        packing::must_be_a_file(path).map_err(unusable)?;
        Self::read(&shown, File::open(path).map_err(unusable)?)
    }

    /// Reads from any source; `name` is for the messages.
    ///
    /// # Errors
    /// When the bytes are no capture.
    pub fn read(name: &str, source: impl Read + Send + 'static) -> Result<Self, CaptureError> {
        let refused = || CaptureError::NotACapture { path: name.to_owned() };
        let mut source = BufReader::new(source);
        if source.fill_buf().is_ok_and(<[u8]>::is_empty) {
            return Err(CaptureError::Empty { path: name.to_owned() });
        }
        let plain = packing::unpacked(source).map_err(|cause| match cause.kind() {
            io::ErrorKind::Unsupported => CaptureError::Open { path: name.to_owned(), cause },
            _ => refused(),
        })?;
        let failure = Arc::new(OnceLock::new());
        let plain = Remembering { source: plain, failure: failure.clone() };
        let reader = create_reader(BUFFER_BYTES, plain).map_err(|_| refused())?;
        Ok(Self {
            path: name.to_owned(),
            reader,
            failure,
            links: Vec::new(),
            nanoseconds: false,
            notes: CaptureNotes::default(),
            finished: false,
        })
    }

    /// What was not a datagram so far.
    #[must_use]
    pub const fn notes(&self) -> CaptureNotes {
        self.notes
    }

    fn step(&mut self) -> Result<Option<Datagram>, CaptureError> {
        while !self.finished {
            let (consumed, found) = match self.reader.next() {
                Ok((consumed, block)) => {
                    let found = take(&block, &mut self.links, &mut self.nanoseconds, &mut self.notes);
                    (consumed, found)
                }
                Err(PcapError::Eof) => {
                    self.finished = true;
                    return Ok(None);
                }
                Err(PcapError::Incomplete(_)) => {
                    let before = self.reader.position();
                    let grown = self.reader.refill();
                    if grown.is_err() || (self.reader.reader_exhausted() && before == self.reader.position())
                    {
                        return Err(self.truncated());
                    }
                    continue;
                }
                Err(PcapError::UnexpectedEof) => return Err(self.truncated()),
                Err(cause) => {
                    let packets = self.notes.packets;
                    return Err(CaptureError::Damaged {
                        path: self.path.clone(),
                        packets,
                        cause: cause.to_string(),
                    });
                }
            };
            self.reader.consume(consumed);
            match found {
                Found::Datagram(datagram) => return Ok(Some(datagram)),
                Found::Link(linktype) if !datagram::is_known(linktype) => {
                    return Err(CaptureError::LinkType { path: self.path.clone(), linktype: linktype.0 });
                }
                Found::Link(_) | Found::Nothing => {}
            }
        }
        Ok(None)
    }

    fn truncated(&self) -> CaptureError {
        let (path, packets) = (self.path.clone(), self.notes.packets);
        match self.failure.get().cloned() {
            Some(cause) => CaptureError::Damaged { path, packets, cause },
            None => CaptureError::Truncated { path, packets },
        }
    }
}

/// Keeps the message of the first failure; an early end is none.
struct Remembering {
    source: Box<dyn Read + Send>,
    failure: Arc<OnceLock<String>>,
}

impl Read for Remembering {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.source.read(buffer).inspect_err(|error| {
            if error.kind() != io::ErrorKind::UnexpectedEof {
                let _ = self.failure.set(error.to_string());
            }
        })
    }
}

impl Iterator for Capture {
    type Item = Result<Datagram, CaptureError>;

    fn next(&mut self) -> Option<Self::Item> {
        let step = self.step();
        if step.is_err() {
            self.finished = true;
        }
        step.transpose()
    }
}

enum Found {
    Datagram(Datagram),
    Link(Linktype),
    Nothing,
}

fn take(
    block: &PcapBlockOwned<'_>,
    links: &mut Vec<(Linktype, u64)>,
    nanoseconds: &mut bool,
    notes: &mut CaptureNotes,
) -> Found {
    match block {
        PcapBlockOwned::LegacyHeader(header) => {
            *nanoseconds = header.is_nanosecond_precision();
            links.push((header.network, 1_000_000));
            Found::Link(header.network)
        }
        PcapBlockOwned::Legacy(packet) => {
            let fraction = u64::from(packet.ts_usec);
            let micros = if *nanoseconds { fraction / 1_000 } else { fraction };
            let captured_us = u64::from(packet.ts_sec) * 1_000_000 + micros;
            let linktype = links.first().map_or(Linktype::ETHERNET, |(linktype, _)| *linktype);
            frame(linktype, captured_us, packet.data, notes)
        }
        PcapBlockOwned::NG(Block::InterfaceDescription(interface)) => {
            links.push((interface.linktype, interface.ts_resolution().unwrap_or(1_000_000)));
            Found::Link(interface.linktype)
        }
        PcapBlockOwned::NG(Block::EnhancedPacket(packet)) => {
            let (linktype, ticks_per_second) =
                links.get(packet.if_id as usize).copied().unwrap_or((Linktype::ETHERNET, 1_000_000));
            let ticks = u128::from(packet.ts_high) << 32 | u128::from(packet.ts_low);
            let captured_us = (ticks * 1_000_000 / u128::from(ticks_per_second.max(1))) as u64;
            frame(linktype, captured_us, packet.data, notes)
        }
        PcapBlockOwned::NG(_) => Found::Nothing,
    }
}

fn frame(linktype: Linktype, captured_us: u64, data: &[u8], notes: &mut CaptureNotes) -> Found {
    notes.packets += 1;
    match datagram::content(linktype, data) {
        Content::Udp { source, destination_port, payload } => {
            Found::Datagram(Datagram { captured_us, source, destination_port, payload: payload.to_vec() })
        }
        Content::Fragment => {
            notes.fragments += 1;
            Found::Nothing
        }
        Content::Other => {
            notes.other += 1;
            Found::Nothing
        }
    }
}
