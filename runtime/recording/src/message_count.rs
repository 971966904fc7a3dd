//! How many messages a recording holds, also one that was cut.

use super::chunk::salvage;
use super::records::{MAGIC, Step, first_record, first_record_head, opcode};

/// Complete messages in the bytes of a recording whose chunks are not packed, and how many bytes the last of them ends
/// at. The quickest of readers, for tests of files that were cut.
#[must_use]
pub fn count_messages(file: &[u8]) -> (u64, usize) {
    let mut found = (0, 0);
    let Some(mut rest) = file.strip_prefix(MAGIC.as_slice()) else { return found };
    while let Step::Whole(record, length) = first_record(rest) {
        rest = rest.get(length..).unwrap_or_default();
        match record.opcode {
            opcode::CHUNK => count_in_chunk(record.content, file.len() - rest.len(), &mut found),
            opcode::MESSAGE => found = (found.0 + 1, file.len() - rest.len()),
            opcode::DATA_END => return found,
            _ => {}
        }
    }
    if let Some((opcode::CHUNK, content)) = first_record_head(rest) {
        count_in_chunk(content, file.len(), &mut found);
    }
    found
}

/// The same within the content of a chunk that ends so many bytes from the beginning of the file.
fn count_in_chunk(content: &[u8], end: usize, found: &mut (u64, usize)) {
    let mut rest = salvage(content).unwrap_or_default();
    while let Step::Whole(record, length) = first_record(rest) {
        rest = rest.get(length..).unwrap_or_default();
        if record.opcode == opcode::MESSAGE {
            *found = (found.0 + 1, end - rest.len());
        }
    }
}
