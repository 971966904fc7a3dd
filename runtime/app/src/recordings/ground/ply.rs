//! PLY, the polygon file format: the points of its first element, in text or binary.

use anyhow::{Context as _, bail};
use floorguard_recording::decode::Field;

use super::cloud_file::Table;

/// Heads are shorter, bytes.
const HEAD_MAX: usize = 65_536;

/// Type number of ROS, and bytes.
fn kind(word: &str) -> Option<(u8, usize)> {
    Some(match word {
        "char" | "int8" => (1, 1),
        "uchar" | "uint8" => (2, 1),
        "short" | "int16" => (3, 2),
        "ushort" | "uint16" => (4, 2),
        "int" | "int32" => (5, 4),
        "uint" | "uint32" => (6, 4),
        "float" | "float32" => (7, 4),
        "double" | "float64" => (8, 8),
        _ => return None,
    })
}

/// The vertices.
///
/// # Errors
/// Why they cannot be read.
pub fn table(bytes: &[u8]) -> anyhow::Result<Table> {
    const END: &[u8] = b"end_header";
    let head = bytes.get(..bytes.len().min(HEAD_MAX)).unwrap_or_default();
    let at = head.windows(END.len()).position(|word| word == END).context("PLY: no end_header")?;
    let line_end = bytes.get(at..).and_then(|rest| rest.iter().position(|byte| *byte == b'\n'));
    let body = at + line_end.context("PLY: nothing after its head")? + 1;
    let head = String::from_utf8_lossy(head.get(..at).unwrap_or_default()).into_owned();
    let (mut format, mut count, mut elements) = (String::new(), 0_usize, 0);
    let (mut fields, mut step) = (Vec::new(), 0);
    for line in head.lines() {
        match line.split_ascii_whitespace().collect::<Vec<_>>().as_slice() {
            ["format", name, ..] => (*name).clone_into(&mut format),
            ["element", name, number] => {
                elements += 1;
                if elements == 1 && *name != "vertex" {
                    bail!("PLY: its first element is {name}, not vertex");
                }
                if elements == 1 {
                    count = number.parse().context("PLY: no number of vertices")?;
                }
            }
            ["property", "list", ..] if elements == 1 => bail!("PLY: a vertex holds a list"),
            ["property", word, name] if elements == 1 => {
                let (datatype, size) = kind(word).with_context(|| format!("PLY: unknown type {word}"))?;
                fields.push(Field { name: (*name).to_owned(), offset: step, datatype });
                step += size;
            }
            _ => {}
        }
    }
    let data = bytes.get(body..).unwrap_or_default();
    match format.as_str() {
        "ascii" => text(&fields, count, data),
        "binary_little_endian" | "binary_big_endian" => {
            let big_endian = format == "binary_big_endian";
            Ok(Table { fields, step, count, big_endian, data: data.to_vec() })
        }
        _ => bail!("PLY: unknown format {format:?}"),
    }
}

fn text(fields: &[Field], count: usize, data: &[u8]) -> anyhow::Result<Table> {
    let names: Vec<String> = fields.iter().map(|field| field.name.clone()).collect();
    let mut table = Table::of_doubles(&names);
    let text = String::from_utf8_lossy(data);
    for (number, line) in text.lines().filter(|line| !line.trim().is_empty()).take(count).enumerate() {
        table.add_row(line).with_context(|| format!("PLY: vertex {} is cut or no number", number + 1))?;
    }
    if table.count < count {
        bail!("PLY: it announces {count} vertices and holds {}", table.count);
    }
    Ok(table)
}
