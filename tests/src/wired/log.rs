//! Reads the board's log as a stranger would: frames from the port, strings from the image.
//!
//! Written after the description of the encoding (rzCOBS; a frame is the string's number, the time stamp, the arguments),
//! not with the library that the firmware writes it with. Arguments are not shown: `defmt-print` does that.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, bail, ensure};
use object::{Object, ObjectSection, ObjectSymbol};

/// One message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// The board's time, microseconds.
    pub at_us: u64,
    /// `defmt_info` and the like.
    pub level: String,
    /// The string, with holes for the arguments.
    pub text: String,
}

/// All messages of a log.
///
/// # Errors
/// An invalid frame, or one whose string the image does not know.
pub fn read(image: &Path, log: &Path) -> anyhow::Result<Vec<Message>> {
    let strings = strings(image)?;
    let bytes = std::fs::read(log)?;
    let mut frames: Vec<&[u8]> = bytes.split(|byte| *byte == 0).collect();
    // Behind the last zero stands what was still in flight.
    frames.pop();
    frames.into_iter().filter(|frame| !frame.is_empty()).map(|frame| message(&strings, frame)).collect()
}

fn message(strings: &BTreeMap<u16, (String, String)>, packed: &[u8]) -> anyhow::Result<Message> {
    let plain = unpack(packed).context("a frame of the log is none")?;
    let (index, rest) = plain.split_first_chunk::<2>().context("a frame of the log is too short")?;
    let (stamp, _) = rest.split_first_chunk::<8>().context("a frame of the log has no time")?;
    let index = u16::from_le_bytes(*index);
    let (level, text) = strings.get(&index).with_context(|| format!("the image has no string {index}"))?;
    Ok(Message { at_us: u64::from_le_bytes(*stamp), level: level.clone(), text: text.clone() })
}

/// Level and text by number: the names of the symbols in the section of the log.
fn strings(image: &Path) -> anyhow::Result<BTreeMap<u16, (String, String)>> {
    let bytes = std::fs::read(image)?;
    let file = object::File::parse(&*bytes)?;
    let section = file.section_by_name(".defmt").context("the image has no strings of a log")?.index();
    let mut strings = BTreeMap::new();
    for symbol in file.symbols().filter(|symbol| symbol.section_index() == Some(section)) {
        let Ok(name) = serde_json::from_str::<serde_json::Value>(symbol.name()?) else { continue };
        if let (Some(tag), Some(data)) = (name["tag"].as_str(), name["data"].as_str()) {
            strings.insert(u16::try_from(symbol.address())?, (tag.to_owned(), data.to_owned()));
        }
    }
    ensure!(!strings.is_empty(), "the image has no strings of a log");
    Ok(strings)
}

/// Reverse zero-compressing COBS, from the end: a byte below 0x80 is a bit per byte of the seven before it (set: it was a
/// zero and is not there); from 0x80 on it counts bytes without a zero, less seven; 0xff is a full run of 134.
fn unpack(packed: &[u8]) -> anyhow::Result<Vec<u8>> {
    let mut reversed = Vec::new();
    let mut left = packed;
    while let Some((&code, before)) = left.split_last() {
        left = before;
        let mut take = |reversed: &mut Vec<u8>| -> anyhow::Result<()> {
            let Some((&byte, before)) = left.split_last() else { bail!("a run goes beyond the frame") };
            left = before;
            reversed.push(byte);
            Ok(())
        };
        match code {
            0 => bail!("a zero within a frame"),
            1..=0x7f => {
                for bit in 0..7 {
                    if code & 1 << (6 - bit) == 0 { take(&mut reversed)? } else { reversed.push(0) }
                }
            }
            0x80..=0xfe => {
                reversed.push(0);
                for _ in 0..usize::from(code & 0x7f) + 7 {
                    take(&mut reversed)?;
                }
            }
            0xff => {
                for _ in 0..134 {
                    take(&mut reversed)?;
                }
            }
        }
    }
    reversed.reverse();
    Ok(reversed)
}
