//! Files as people pack them, told by their first bytes: gzip, bzip2 and zstd are unpacked on the way, others named.

use std::fs::File;
use std::io::{self, BufRead as _, BufReader, Read};
use std::path::Path;

/// How a file begins that is packed in a way that we do not unpack, and what does.
const OTHERS: [(&[u8], &str); 3] = [
    (b"\xfd7zXZ\0", "it is packed with xz; unpack it first with unxz"),
    (b"PK\x03\x04", "it is a zip archive; unpack it first with unzip"),
    (b"7z\xbc\xaf\x27\x1c", "it is a 7z archive; unpack it first with 7z x"),
];

/// Looks through the packing.
///
/// # Errors
/// It cannot be read, or is packed in a way that is named.
pub fn unpacked(source: impl Read + Send + 'static) -> io::Result<Box<dyn Read + Send>> {
    let mut source = BufReader::new(source);
    let begins = source.fill_buf()?;
    if let Some((_, what)) = OTHERS.iter().find(|(magic, _)| begins.starts_with(magic)) {
        return Err(io::Error::new(io::ErrorKind::Unsupported, *what));
    }
    Ok(if begins.starts_with(&[0x1f, 0x8b]) {
        Box::new(flate2::read::MultiGzDecoder::new(source))
    } else if begins.starts_with(b"BZh") {
        Box::new(bzip2::read::MultiBzDecoder::new(source))
    } else if begins.starts_with(&[0x28, 0xb5, 0x2f, 0xfd]) {
        Box::new(ruzstd::decoding::StreamingDecoder::new(source).map_err(io::Error::other)?)
    } else {
        Box::new(source)
    })
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

/// Looks again where it has looked before, which only a file allows.
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
    fn what_is_packed_is_unpacked_and_what_cannot_be_is_named() {
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
}
