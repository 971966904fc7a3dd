//! Damage in the ways that find mistakes in parsers.

use crate::campaign::Random;

/// Values on which length fields, counters and comparisons tip over.
const EDGES: [u64; 12] =
    [0, 1, 2, 0x7F, 0x80, 0xFF, 0x100, 0x7FFF, 0x8000, 0xFFFF, 0x7FFF_FFFF, 0xFFFF_FFFF_FFFF_FFFF];

/// One to six mistakes in `bytes`, which keeps at most `longest` bytes. One message in eight stays as it is.
pub fn corrupt(bytes: &mut Vec<u8>, other: &[u8], longest: usize, random: &mut Random) {
    if random.seldom(8) {
        return;
    }
    for _ in 0..=random.below(6) {
        mistake(bytes, other, random);
    }
    bytes.truncate(longest);
}

fn mistake(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let length = bytes.len() as u64;
    let at = random.below(length + 1) as usize;
    match random.below(8) {
        0 if length > 0 => bytes[at.min(length as usize - 1)] ^= 1 << random.below(8),
        1 if length > 0 => bytes[at.min(length as usize - 1)] = random.next() as u8,
        2 => bytes.truncate(at),
        3 => bytes.insert(at, random.next() as u8),
        4 if length > 0 => {
            let end = (at + random.below(16) as usize).min(bytes.len());
            bytes.drain(at..end);
        }
        5 => {
            let edge = EDGES[random.below(EDGES.len() as u64) as usize].to_le_bytes();
            let width = 1 << random.below(3);
            for (slot, byte) in bytes.iter_mut().skip(at).zip(edge.iter().take(width)) {
                *slot = *byte;
            }
        }
        6 => {
            let from = random.below(other.len() as u64 + 1) as usize;
            bytes.truncate(at);
            bytes.extend_from_slice(&other[from..]);
        }
        _ => {
            for _ in 0..random.below(40) {
                bytes.push(random.next() as u8);
            }
        }
    }
}

/// One of the messages.
///
/// # Panics
/// There is none.
pub fn pick<'a, T>(messages: &'a [T], random: &mut Random) -> &'a T {
    &messages[random.below(messages.len() as u64) as usize]
}
