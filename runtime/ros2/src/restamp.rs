//! From the robot's clock to the clock on the wall: every `builtin_interfaces/Time` in a message, found by the message's definition.

use std::collections::BTreeMap;
use std::ops::Range;

/// Types within types; ROS 2 messages that a robot writes have half of it.
const DEPTH_MAX: usize = 8;
/// The type that is a moment.
const TIME: &str = "builtin_interfaces/Time";
/// Bytes before a message that say how it is written.
const HEADER_BYTES: usize = 4;

/// How often a field stands there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Many {
    Once,
    Array(usize),
    Sequence,
}

#[derive(Clone, Debug)]
enum Kind {
    /// A number of so many bytes.
    Number(usize),
    Text,
    Part(String),
}

#[derive(Clone, Debug)]
struct Field {
    kind: Kind,
    many: Many,
}

/// Where the moments of messages of one type are.
#[derive(Clone, Debug)]
pub struct Layout {
    own: Vec<Field>,
    parts: BTreeMap<String, Vec<Field>>,
}

impl Layout {
    /// From a definition with everything that it uses, as recordings hold it.
    #[must_use]
    pub fn of(definition: &str) -> Self {
        let separator = "=".repeat(80);
        let mut sections = definition.split(&separator);
        let own = fields(sections.next().unwrap_or_default());
        let parts = sections.filter_map(|section| {
            let (name, body) = section.trim_start().strip_prefix("MSG: ")?.split_once('\n')?;
            Some((name.to_owned(), fields(body)))
        });
        Self { own, parts: parts.collect() }
    }

    /// Adds an offset to every moment but zero, which is none. False: the message ends before its definition does, and what was
    /// reached is shifted.
    pub fn shift(&self, message: &mut [u8], offset_us: i64) -> bool {
        let mut found = Vec::new();
        let Some(body) = message.get_mut(HEADER_BYTES..) else { return false };
        let mut walk = Walk { body, at: 0, found: &mut found };
        let whole = walk.fields(self, &self.own, DEPTH_MAX).is_some();
        for place in found {
            if let Some(bytes) = body.get_mut(place) {
                shift_moment(bytes, offset_us);
            }
        }
        whole
    }
}

/// Two numbers, seconds and nanoseconds.
fn shift_moment(bytes: &mut [u8], offset_us: i64) {
    let Some((seconds, rest)) = bytes.split_first_chunk_mut::<4>() else { return };
    let Some(nanoseconds) = rest.first_chunk_mut::<4>() else { return };
    let since_us = i64::from(i32::from_le_bytes(*seconds)) * 1_000_000
        + i64::from(u32::from_le_bytes(*nanoseconds)) / 1_000;
    if since_us == 0 {
        return;
    }
    let shifted_us = since_us.saturating_add(offset_us).max(0);
    *seconds = i32::try_from(shifted_us / 1_000_000).unwrap_or(i32::MAX).to_le_bytes();
    *nanoseconds = (u32::try_from(shifted_us % 1_000_000).unwrap_or(0) * 1_000).to_le_bytes();
}

struct Walk<'a> {
    body: &'a [u8],
    at: usize,
    found: &'a mut Vec<Range<usize>>,
}

impl Walk<'_> {
    fn fields(&mut self, layout: &Layout, fields: &[Field], depth: usize) -> Option<()> {
        fields.iter().try_for_each(|field| self.field(layout, field, depth))
    }

    fn field(&mut self, layout: &Layout, field: &Field, depth: usize) -> Option<()> {
        let count = match field.many {
            Many::Once => 1,
            Many::Array(count) => count,
            Many::Sequence => self.length()?,
        };
        match &field.kind {
            Kind::Number(_) if count == 0 => Some(()),
            Kind::Number(size) => self.skip(*size, size.checked_mul(count)?),
            // Each takes at least a length: a count beyond the message ends with it.
            Kind::Text => (0..count).try_for_each(|_| {
                let length = self.length()?;
                self.skip(1, length)
            }),
            Kind::Part(name) if name == TIME => (0..count).try_for_each(|_| {
                let begin = self.at.next_multiple_of(4);
                self.skip(4, 8)?;
                self.found.push(begin..begin + 8);
                Some(())
            }),
            Kind::Part(name) => {
                let depth = depth.checked_sub(1)?;
                let part = layout.parts.get(name).filter(|part| !part.is_empty())?;
                (0..count).try_for_each(|_| self.fields(layout, part, depth))
            }
        }
    }

    fn skip(&mut self, aligned: usize, bytes: usize) -> Option<()> {
        let end = self.at.next_multiple_of(aligned).checked_add(bytes)?;
        self.at = end;
        (end <= self.body.len()).then_some(())
    }

    fn length(&mut self) -> Option<usize> {
        self.skip(4, 4)?;
        let bytes = self.body.get(self.at - 4..self.at)?.first_chunk::<4>()?;
        usize::try_from(u32::from_le_bytes(*bytes)).ok()
    }
}

/// The fields of one type; constants and remarks are none.
fn fields(body: &str) -> Vec<Field> {
    let line = |line: &str| {
        let (kind, name) = line.split('#').next()?.trim().split_once(' ')?;
        (!name.contains('=')).then(|| field(kind))
    };
    body.lines().filter_map(line).collect()
}

fn field(kind: &str) -> Field {
    let (kind, many) = match kind.strip_suffix(']').and_then(|kind| kind.split_once('[')) {
        Some((kind, count)) => (kind, count.parse().map_or(Many::Sequence, Many::Array)),
        None => (kind, Many::Once),
    };
    let kind = match kind {
        "bool" | "byte" | "char" | "int8" | "uint8" => Kind::Number(1),
        "int16" | "uint16" => Kind::Number(2),
        "int32" | "uint32" | "float32" => Kind::Number(4),
        "int64" | "uint64" | "float64" => Kind::Number(8),
        "string" => Kind::Text,
        part => Kind::Part(part.to_owned()),
    };
    Field { kind, many }
}

#[cfg(test)]
mod tests {
    use floorguard_recording::cdr::Encoder;

    use super::*;

    const DEFINITION: &str = "std_msgs/Header header\nuint8 OK=0\nbyte level # of what\npkg/Row[] rows\nfloat64 end\n\
        ================================================================================\n\
        MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
        ================================================================================\n\
        MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n\
        ================================================================================\n\
        MSG: pkg/Row\nfloat64[3] at\nstring name\nbuiltin_interfaces/Time when\n";

    fn message(moments: [(i32, u32); 3]) -> Vec<u8> {
        let mut encoder = Encoder::new();
        encoder.i32(moments[0].0).u32(moments[0].1).text("map").u8(7).length(2);
        for (index, (seconds, nanoseconds)) in moments.into_iter().enumerate().skip(1) {
            encoder.f64s(&[1.0, 2.0, 3.0]).text(&"n".repeat(index)).i32(seconds).u32(nanoseconds);
        }
        encoder.f64(0.5);
        encoder.finish()
    }

    #[test]
    fn every_moment_is_shifted_and_nothing_else() {
        let layout = Layout::of(DEFINITION);
        let mut bytes = message([(1, 500_000_000), (0, 0), (2, 999_999_000)]);
        assert!(layout.shift(&mut bytes, 1_600_000_000_000_001));
        assert_eq!(bytes, message([(1_600_000_001, 500_001_000), (0, 0), (1_600_000_003, 0)]));
    }

    #[test]
    fn shorter_message_is_reported_and_left() {
        let layout = Layout::of(DEFINITION);
        let whole = message([(1, 0), (2, 0), (3, 0)]);
        for cut in 0..whole.len() {
            let mut bytes = whole[..cut].to_vec();
            assert!(!layout.shift(&mut bytes, 1_000_000), "cut at {cut}");
            assert_eq!(bytes.len(), cut);
        }
    }

    #[test]
    fn definitions_of_recordings_are_understood() {
        let mut bytes = floorguard_recording::tf_message(
            floorguard_types::time::Stamp::from_micros(1_000_000),
            ("odom", "base_link"),
            floorguard_types::geometry::Pose2::new(1.0, 2.0, 0.5),
        );
        let layout = Layout::of(&floorguard_recording::TF_MESSAGE.definition());
        assert!(layout.shift(&mut bytes, 41_000_000));
        assert_eq!(bytes[8..12], 42_i32.to_le_bytes());
    }
}
