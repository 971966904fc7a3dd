//! Arrays of a `.npz` file: a ZIP archive of arrays as NumPy writes them.

use std::io::Read as _;
use std::path::Path;

use anyhow::{Context as _, bail, ensure};

/// An array of two dimensions.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Table {
    /// Name without `.npy`.
    pub(super) name: String,
    /// Row by row.
    pub(super) rows: Vec<Vec<f32>>,
}

/// All arrays of a file.
pub(super) fn tables(path: &Path) -> anyhow::Result<Vec<Table>> {
    let bytes = std::fs::read(path)?;
    let end = bytes.windows(4).rposition(|mark| mark == b"PK\x05\x06").context("no end of a ZIP archive")?;
    let entries = number(&bytes, end + 10, 2)?;
    let mut at = number(&bytes, end + 16, 4)?;
    let mut tables = Vec::new();
    for _ in 0..entries {
        ensure!(bytes.get(at..at + 4) == Some(b"PK\x01\x02"), "a directory entry is damaged");
        let (method, packed) = (number(&bytes, at + 10, 2)?, number(&bytes, at + 20, 4)?);
        let lengths = [28, 30, 32].map(|field| number(&bytes, at + field, 2));
        let [name_length, extra, comment] = lengths;
        let name_length = name_length?;
        let name =
            String::from_utf8_lossy(bytes.get(at + 46..at + 46 + name_length).context("a name is cut")?);
        let local = number(&bytes, at + 42, 4)?;
        let begin = local + 30 + number(&bytes, local + 26, 2)? + number(&bytes, local + 28, 2)?;
        let content = unpack(method, bytes.get(begin..begin + packed).context("an entry is cut")?)?;
        let name = name.trim_end_matches(".npy").to_owned();
        tables.push(Table { rows: rows(&content).with_context(|| name.clone())?, name });
        at += 46 + name_length + extra? + comment?;
    }
    Ok(tables)
}

/// A little-endian number.
fn number(bytes: &[u8], at: usize, length: usize) -> anyhow::Result<usize> {
    let digits = bytes.get(at..at + length).context("the archive is cut")?;
    Ok(digits.iter().rev().fold(0, |sum, &digit| sum << 8 | usize::from(digit)))
}

fn unpack(method: usize, packed: &[u8]) -> anyhow::Result<Vec<u8>> {
    match method {
        0 => Ok(packed.to_vec()),
        8 => {
            let mut content = Vec::new();
            flate2::read::DeflateDecoder::new(packed).read_to_end(&mut content)?;
            Ok(content)
        }
        other => bail!("packed by method {other}"),
    }
}

/// The numbers of an array of two dimensions.
fn rows(content: &[u8]) -> anyhow::Result<Vec<Vec<f32>>> {
    ensure!(content.starts_with(b"\x93NUMPY\x01"), "no array of version 1");
    let length = number(content, 8, 2)?;
    let header =
        String::from_utf8_lossy(content.get(10..10 + length).context("the header is cut")?).into_owned();
    ensure!(
        header.contains("'<f4'") && header.contains("'fortran_order': False"),
        "not f32 by rows: {header}"
    );
    let shape =
        header.split_once("'shape': (").and_then(|(_, rest)| rest.split_once(')')).context("no shape")?.0;
    let sides: Vec<usize> = shape.split(',').filter_map(|side| side.trim().parse().ok()).collect();
    let [_, columns] = sides[..] else { bail!("shape ({shape})") };
    let values = content[10 + length..]
        .chunks_exact(4)
        .map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]]));
    let values: Vec<f32> = values.collect();
    Ok(values.chunks_exact(columns).map(<[f32]>::to_vec).collect())
}
