//! Compressed files, recognised by their first bytes: gzip, bzip2 and zstd are unpacked on the way, others named.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// How a file begins that is packed in a way that we do not unpack, and what does.
const OTHERS: [(&[u8], &str); 3] = [
    (b"\xfd7zXZ\0", "it is packed with xz; unpack it first with unxz"),
    (b"PK\x03\x04", "it is a zip archive; unpack it first with unzip"),
    (b"7z\xbc\xaf\x27\x1c", "it is a 7z archive; unpack it first with 7z x"),
];

/// No measurement packs tighter than this: what unfolds to more is made to fill the memory or the time of who opens it.
const RATIO_MAX: u64 = 250;
/// Up to here that harms nobody, bytes.
const HARMLESS_BYTES: u64 = 1 << 28;
/// Largest text that is read as a whole, bytes.
const TEXT_BYTES_MAX: u64 = 1 << 30;
/// How a frame of zstd begins, and the last three bytes of how one begins that only carries notes.
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
const ZSTD_NOTES: [u8; 3] = [0x2a, 0x4d, 0x18];

/// Inspects the compression.
///
/// # Errors
/// It cannot be read, or is packed in a way that is named. While reading: it is damaged, or unfolds to far more than any
/// recording does.
pub fn unpacked(source: impl Read + Send + 'static) -> io::Result<Box<dyn Read + Send>> {
    let packed_bytes = Arc::new(AtomicU64::new(0));
    let mut source = BufReader::new(Counted { source, bytes: packed_bytes.clone() });
    let begins = source.fill_buf()?;
    if let Some((_, what)) = OTHERS.iter().find(|(magic, _)| begins.starts_with(magic)) {
        return Err(io::Error::new(io::ErrorKind::Unsupported, *what));
    }
    let unfolding: Box<dyn Read + Send> = if begins.starts_with(&[0x1f, 0x8b]) {
        Box::new(flate2::read::MultiGzDecoder::new(source))
    } else if begins.starts_with(b"BZh") {
        Box::new(bzip2::read::MultiBzDecoder::new(source))
    } else if begins.starts_with(&ZSTD) || begins.get(1..4) == Some(&ZSTD_NOTES) {
        Box::new(ZstdFrames { frame: None, rest: Some(source) })
    } else {
        return Ok(Box::new(source));
    };
    Ok(Box::new(Unfolding { source: unfolding, bytes: 0, packed_bytes }))
}

/// Counts what is read from a file.
struct Counted<R> {
    source: R,
    bytes: Arc<AtomicU64>,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(buffer)?;
        self.bytes.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}

/// Ends with an error where a small file unfolds to a mountain.
struct Unfolding {
    source: Box<dyn Read + Send>,
    bytes: u64,
    packed_bytes: Arc<AtomicU64>,
}

impl Read for Unfolding {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(buffer)?;
        self.bytes = self.bytes.saturating_add(count as u64);
        let packed_bytes = self.packed_bytes.load(Ordering::Relaxed);
        if self.bytes > HARMLESS_BYTES.max(packed_bytes.saturating_mul(RATIO_MAX)) {
            let what = format!("it unpacks to more than {RATIO_MAX} times its size, as no recording does");
            return Err(io::Error::new(io::ErrorKind::InvalidData, what));
        }
        Ok(count)
    }
}

/// The frames of a file packed with zstd, one after the other; those that only carry notes are passed over.
struct ZstdFrames<R: Read> {
    frame: Option<ruzstd::decoding::StreamingDecoder<R, ruzstd::decoding::FrameDecoder>>,
    /// What follows the last frame.
    rest: Option<R>,
}

impl<R: BufRead> ZstdFrames<R> {
    /// Goes on to the next frame; false: there is none.
    fn has_next(&mut self) -> io::Result<bool> {
        let Some(mut rest) = self.rest.take() else { return Ok(false) };
        // A file is not made of notes for ever: each has eight bytes at least.
        while rest.fill_buf()?.get(1..4) == Some(&ZSTD_NOTES) {
            let mut head = [0; 8];
            rest.read_exact(&mut head)?;
            let [.., a, b, c, d] = head;
            let length = u64::from(u32::from_le_bytes([a, b, c, d]));
            io::copy(&mut rest.by_ref().take(length), &mut io::sink())?;
        }
        if rest.fill_buf()?.is_empty() {
            return Ok(false);
        }
        self.frame = Some(ruzstd::decoding::StreamingDecoder::new(rest).map_err(io::Error::other)?);
        Ok(true)
    }
}

impl<R: BufRead> Read for ZstdFrames<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            if let Some(mut frame) = self.frame.take() {
                let count = frame.read(buffer)?;
                if count > 0 || buffer.is_empty() {
                    self.frame = Some(frame);
                    return Ok(count);
                }
                self.rest = Some(frame.into_inner());
            }
            if !self.has_next()? {
                return Ok(0);
            }
        }
    }
}

/// The text of a file, packed or not, as a whole.
///
/// # Errors
/// As [`unpacked`]; it is no text, or longer than a gibibyte.
pub fn text(path: &Path) -> io::Result<String> {
    let mut bytes = Vec::new();
    unpacked(File::open(path)?)?.take(TEXT_BYTES_MAX + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > TEXT_BYTES_MAX {
        let what = format!("it is longer than {} MB; split it", TEXT_BYTES_MAX >> 20);
        return Err(io::Error::new(io::ErrorKind::InvalidData, what));
    }
    String::from_utf8(bytes)
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is no text, packed or not"))
}

/// The first bytes behind the packing, as many as there are.
///
/// # Errors
/// As [`unpacked`].
pub fn beginning(path: &Path, bytes: u64) -> io::Result<Vec<u8>> {
    let mut found = Vec::new();
    // What is cut behind its beginning still has one.
    let _ = unpacked(File::open(path)?)?.take(bytes).read_to_end(&mut found);
    Ok(found)
}

/// Reads again from an earlier position, which only a file allows.
///
/// # Errors
/// It is a pipe, a terminal or a device.
pub fn must_be_a_file(path: &Path) -> io::Result<()> {
    let kind = std::fs::metadata(path)?.file_type();
    if kind.is_file() || kind.is_dir() {
        return Ok(());
    }
    let what =
        "it is no file but a pipe or a device, and must be read more than once; write it to a file first";
    Err(io::Error::new(io::ErrorKind::Unsupported, what))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write as _;

    #[test]
    fn packed_files_are_unpacked_or_named() {
        let words = b"the same words in every packing";
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        gzip.write_all(words).unwrap();
        let mut bzip2 = bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::fast());
        bzip2.write_all(words).unwrap();
        let zstd = ruzstd::encoding::compress_to_vec(
            words.as_slice(),
            ruzstd::encoding::CompressionLevel::Uncompressed,
        );
        for packed in [words.to_vec(), gzip.finish().unwrap(), bzip2.finish().unwrap(), zstd] {
            let mut found = Vec::new();
            unpacked(io::Cursor::new(packed)).unwrap().read_to_end(&mut found).unwrap();
            assert_eq!(found, words);
        }
        for (magic, what) in OTHERS {
            let error = unpacked(magic).err().unwrap();
            assert_eq!(error.to_string(), what);
        }
    }

    fn zstd(bytes: &[u8]) -> Vec<u8> {
        ruzstd::encoding::compress_to_vec(bytes, ruzstd::encoding::CompressionLevel::Fastest)
    }

    #[test]
    fn zstd_frames_may_have_skippable_frames_between() {
        let notes = [&[0x5a][..], &ZSTD_NOTES, &[3, 0, 0, 0], b"any"].concat();
        let packed = [&notes[..], &zstd(b"one "), &notes, &zstd(b""), &zstd(b"two"), &notes].concat();
        let mut found = Vec::new();
        unpacked(io::Cursor::new(packed.clone())).unwrap().read_to_end(&mut found).unwrap();
        assert_eq!(found, b"one two");
        for end in [packed.len() - 1, packed.len() - 20, 5] {
            let cut = packed[..end].to_vec();
            let read = unpacked(io::Cursor::new(cut)).and_then(|mut it| it.read_to_end(&mut found));
            assert!(end == packed.len() - 1 || read.is_err(), "{end}: a cut is reported");
        }
    }

    /// A frame of zstd that says `blocks` times: the same byte, 128 KiB of it.
    fn mountain(blocks: usize) -> Vec<u8> {
        let block = [0x02_u8, 0x00, 0x10, b'7'];
        let last = [0x03_u8, 0x00, 0x10, b'7'];
        [&ZSTD[..], &[0x00, 0x38], &block.repeat(blocks - 1), &last].concat()
    }

    #[test]
    fn decompression_bomb_is_an_error() {
        let small = mountain(8);
        let mut found = Vec::new();
        unpacked(io::Cursor::new(small)).unwrap().read_to_end(&mut found).unwrap();
        assert_eq!(found, vec![b'7'; 1 << 20], "up to a size that harms nobody");
        let huge = mountain(1 << 20);
        assert!(huge.len() < 5 << 20, "{} bytes for 128 GiB", huge.len());
        let mut source = unpacked(io::Cursor::new(huge)).unwrap();
        let read = io::copy(&mut source.by_ref().take(4 << 30), &mut io::sink());
        assert!(read.unwrap_err().to_string().contains("more than 250 times its size"));
    }
}
