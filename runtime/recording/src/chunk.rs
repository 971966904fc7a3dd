//! Chunks: records packed together. Ours are not packed tight; those of other people's recorders may be.

use std::io::Read as _;

use crc::{CRC_32_ISO_HDLC, Crc, Table};

use super::records::Fields;

/// A chunk must not unfold to more: a damaged length must not fill the memory.
const CHUNK_BYTES_MAX: u64 = 1 << 30;

/// Checksum of the records of a chunk (MCAP specification, version 0, Chunk: `uncompressed_crc`).
const CHECKSUM: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);

/// A chunk that cannot be unfolded.
#[derive(Debug, thiserror::Error)]
pub(super) enum ChunkError {
    /// The record is shorter than a chunk's head.
    #[error("a chunk is too short")]
    Short,
    /// Packed in a way that we do not know.
    #[error("a chunk is packed with {0:?}; known are none, lz4 and zstd")]
    Compression(String),
    /// Its records are not those that were written.
    #[error(
        "a chunk is damaged: its checksum is {found:08x}, written was {written:08x}; it holds {from_s:.3} s to {to_s:.3} s"
    )]
    Checksum {
        /// In its head.
        written: u32,
        /// Of what is there.
        found: u32,
        /// When its first message was recorded, as its head says, seconds of the recording's clock.
        from_s: f64,
        /// The same of its last message.
        to_s: f64,
    },
    /// It does not unfold.
    #[error("a chunk packed with {compression} does not unfold: {cause}")]
    Damaged {
        /// How it is packed.
        compression: String,
        /// What the library says.
        cause: String,
    },
}

/// The records in as much of an unpacked chunk as is there, the last of them perhaps cut. Nothing of a packed one.
pub(super) fn salvage(content: &[u8]) -> Option<&[u8]> {
    let mut fields = Fields(content);
    fields.bytes(8 + 8 + 8 + 4)?;
    if !fields.text()?.is_empty() {
        return None;
    }
    fields.u64()?;
    Some(fields.0)
}

/// The records of a chunk, from the content of its record.
pub(super) fn unpack(mut fields: Fields<'_>) -> Result<Vec<u8>, ChunkError> {
    // Times of the first and the last message, nanoseconds.
    let (from_ns, to_ns) = fields.u64().zip(fields.u64()).ok_or(ChunkError::Short)?;
    let size = fields.u64().ok_or(ChunkError::Short)?;
    // Zero where the recorder computes none.
    let written = fields.u32().ok_or(ChunkError::Short)?;
    let compression = fields.text().ok_or(ChunkError::Short)?;
    let length = fields.u64().ok_or(ChunkError::Short)?;
    let packed = fields.bytes(length).ok_or(ChunkError::Short)?;
    let damaged = |cause: String| ChunkError::Damaged { compression: compression.clone(), cause };
    if size > CHUNK_BYTES_MAX {
        return Err(damaged(format!("it claims to hold {size} bytes")));
    }
    let mut records = Vec::new();
    let unfolded = match compression.as_str() {
        "" => {
            records.extend_from_slice(packed);
            Ok(packed.len())
        }
        "zstd" => ruzstd::decoding::StreamingDecoder::new(packed)
            .map_err(|error| damaged(error.to_string()))?
            .take(CHUNK_BYTES_MAX)
            .read_to_end(&mut records),
        "lz4" => lz4_flex::frame::FrameDecoder::new(packed).take(CHUNK_BYTES_MAX).read_to_end(&mut records),
        _ => return Err(ChunkError::Compression(compression)),
    };
    unfolded.map_err(|error| damaged(error.to_string()))?;
    let found = CHECKSUM.checksum(&records);
    if written != 0 && found != written {
        let seconds = |ns: u64| ns as f64 * 1.0e-9;
        return Err(ChunkError::Checksum { written, found, from_s: seconds(from_ns), to_s: seconds(to_ns) });
    }
    Ok(records)
}
