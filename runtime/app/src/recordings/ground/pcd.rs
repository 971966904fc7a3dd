//! PCD, the file format of the Point Cloud Library: text, binary, and compressed.

use anyhow::{Context as _, bail};
use floorguard_recording::decode::Field;

use super::cloud_file::Table;
use super::lzf;

/// Type number of ROS.
fn kind(word: &str, size: usize) -> Option<u8> {
    Some(match (word, size) {
        ("I", 1) => 1,
        ("U", 1) => 2,
        ("I", 2) => 3,
        ("U", 2) => 4,
        ("I", 4) => 5,
        ("U", 4) => 6,
        ("F", 4) => 7,
        ("F", 8) => 8,
        _ => return None,
    })
}

/// What the head says.
#[derive(Default)]
struct Head {
    names: Vec<String>,
    sizes: Vec<usize>,
    types: Vec<String>,
    counts: Vec<usize>,
    points: usize,
    data: String,
    /// Where the points begin.
    body: usize,
}

fn head(bytes: &[u8]) -> anyhow::Result<Head> {
    let mut head = Head::default();
    for line in bytes.split_inclusive(|byte| *byte == b'\n').take(64) {
        head.body += line.len();
        let line = String::from_utf8_lossy(line);
        let mut words = line.split_ascii_whitespace();
        let key = words.next().unwrap_or_default();
        let numbers = |words: std::str::SplitAsciiWhitespace<'_>| -> anyhow::Result<Vec<usize>> {
            words.map(|word| word.parse().with_context(|| format!("PCD: {key} {word}"))).collect()
        };
        match key {
            "FIELDS" => head.names = words.map(str::to_owned).collect(),
            "SIZE" => head.sizes = numbers(words)?,
            "TYPE" => head.types = words.map(str::to_owned).collect(),
            "COUNT" => head.counts = numbers(words)?,
            "POINTS" => {
                head.points = numbers(words)?.first().copied().context("PCD: POINTS without a number")?
            }
            "DATA" => {
                words.next().unwrap_or_default().clone_into(&mut head.data);
                return Ok(head);
            }
            _ => {}
        }
    }
    bail!("PCD: no line DATA in its head")
}

/// The points.
///
/// # Errors
/// Why they cannot be read.
pub fn table(bytes: &[u8]) -> anyhow::Result<Table> {
    let mut head = head(bytes)?;
    if head.counts.is_empty() {
        head.counts = vec![1; head.names.len()];
    }
    let lengths = [head.sizes.len(), head.types.len(), head.counts.len()];
    if lengths.iter().any(|length| *length != head.names.len()) {
        bail!("PCD: FIELDS, SIZE, TYPE and COUNT differ in length");
    }
    let data = bytes.get(head.body..).unwrap_or_default();
    if head.data == "ascii" {
        return text(&head, data);
    }
    let (mut fields, mut widths, mut step) = (Vec::new(), Vec::new(), 0);
    for (index, name) in head.names.iter().enumerate() {
        let (size, count) = (head.sizes[index], head.counts[index]);
        // Padding has names like "_", and types of any size.
        if let Some(datatype) = kind(&head.types[index], size).filter(|_| name != "_") {
            fields.push(Field { name: name.clone(), offset: step, datatype });
        }
        widths.push(size * count);
        step += size * count;
    }
    let data = match head.data.as_str() {
        "binary" => data.to_vec(),
        "binary_compressed" => in_rows(&unpack(data)?, &widths, head.points),
        other => bail!("PCD: unknown DATA {other}"),
    };
    Ok(Table { fields, step, count: head.points, big_endian: false, data })
}

fn text(head: &Head, data: &[u8]) -> anyhow::Result<Table> {
    let names = head.names.iter().zip(&head.counts).flat_map(|(name, count)| vec![name.clone(); *count]);
    let mut table = Table::of_doubles(&names.collect::<Vec<_>>());
    let text = String::from_utf8_lossy(data);
    for (number, line) in text.lines().filter(|line| !line.trim().is_empty()).take(head.points).enumerate() {
        table.add_row(line).with_context(|| format!("PCD: point {} is cut or no number", number + 1))?;
    }
    if table.count < head.points {
        bail!("PCD: it announces {} points and holds {}", head.points, table.count);
    }
    Ok(table)
}

/// Two sizes of four bytes, then the packed bytes.
fn unpack(data: &[u8]) -> anyhow::Result<Vec<u8>> {
    let (packed, rest) = data.split_first_chunk::<4>().context("PCD: cut")?;
    let (plain, rest) = rest.split_first_chunk::<4>().context("PCD: cut")?;
    let (packed, plain) = (u32::from_le_bytes(*packed) as usize, u32::from_le_bytes(*plain) as usize);
    let packed = rest.get(..packed).context("PCD: cut")?;
    lzf::unpack(packed, plain).context("PCD: its compressed points are damaged")
}

/// Compressed points are stored field by field.
fn in_rows(columns: &[u8], widths: &[usize], points: usize) -> Vec<u8> {
    let mut rows = Vec::with_capacity(columns.len());
    for point in 0..points {
        let mut at = 0;
        for width in widths {
            rows.extend(columns.get(at + point * width..at + (point + 1) * width).unwrap_or_default());
            at += points * width;
        }
    }
    rows
}
