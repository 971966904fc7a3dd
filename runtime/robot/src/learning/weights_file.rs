//! What a robot learned about the appearance of people, as a file: a header with version, generation, length and
//! checksum.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `FLGLRN\r\n` |
//! | 2 | version of the format |
//! | 4 | generation: how often it was saved |
//! | 4 | number of waves |
//! | 4 | CRC-32 of the anchors, whose spreads are the units of the waves |
//! | … | offset, steps, weights |
//! | 4 | CRC-32 (ISO-HDLC) of everything above |

use std::path::Path;

use anyhow::{bail, ensure};
use crc::{CRC_32_ISO_HDLC, Crc};
use floorguard_perception::online_learning::{BASIS, Weights};

use crate::environment::bytes::{Reader, Writer};
use crate::environment::{places, replace_file};

const MAGIC: &[u8; 8] = b"FLGLRN\r\n";
const VERSION: u16 = 2;
const CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// What a file has kept.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// The weights.
    pub weights: Weights,
    /// How often they were saved.
    pub generation: u32,
    /// What was wrong with files that were passed over.
    pub passed_over: Vec<String>,
}

/// Saves weights that belong to `anchors`; the file before them is kept as `.old`.
///
/// # Errors
/// The disk is full, or the folder cannot be written.
pub fn save_weights(path: &Path, weights: &Weights, anchors: u32) -> anyhow::Result<()> {
    let generation = newest(path, anchors).0.map_or(0, |(generation, _)| generation).saturating_add(1);
    replace_file(path, &encode_weights(generation, weights, anchors))
}

/// Reads the newest whole file. `None` if there has never been one.
///
/// # Errors
/// There are files, but none is whole and of these anchors.
pub fn load_weights(path: &Path, anchors: u32) -> anyhow::Result<Option<Kept>> {
    match newest(path, anchors) {
        (Some((generation, weights)), passed_over) => Ok(Some(Kept { weights, generation, passed_over })),
        (None, problems) if problems.is_empty() => Ok(None),
        (None, problems) => bail!("{}", problems.join("; ")),
    }
}

fn newest(path: &Path, anchors: u32) -> (Option<(u32, Weights)>, Vec<String>) {
    let (mut best, mut problems): (Option<(u32, Weights)>, Vec<String>) = (None, Vec::new());
    for place in places(path) {
        let read = match std::fs::read(&place) {
            Ok(bytes) => decode_weights(&bytes, anchors),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
            Err(error) => Err(error.into()),
        };
        match read {
            Ok(found) if best.as_ref().is_none_or(|(generation, _)| found.0 > *generation) => {
                best = Some(found)
            }
            Ok(_) => {}
            Err(error) => problems.push(format!("{}: {error:#}", place.display())),
        }
    }
    (best, problems)
}

/// The bytes of a file.
#[must_use]
pub fn encode_weights(generation: u32, weights: &Weights, anchors: u32) -> Vec<u8> {
    let mut file = Writer::default();
    file.bytes(MAGIC);
    file.u16(VERSION);
    file.u32(generation);
    file.u32(BASIS as u32);
    file.u32(anchors);
    file.f32(weights.offset);
    file.u32(weights.steps);
    weights.waves.iter().for_each(|weight| file.f32(*weight));
    let checksum = CHECKSUM.checksum(&file.0);
    file.u32(checksum);
    file.0
}

/// Generation and weights out of the bytes of a file.
///
/// # Errors
/// What is wrong with them.
pub fn decode_weights(bytes: &[u8], anchors: u32) -> anyhow::Result<(u32, Weights)> {
    let Some((content, checksum)) = bytes.split_last_chunk::<4>() else { bail!("it ends too early") };
    let mut reader = Reader(content);
    ensure!(reader.bytes(8).ok() == Some(MAGIC.as_slice()), "nothing learned by floorguard");
    ensure!(CHECKSUM.checksum(content) == u32::from_le_bytes(*checksum), "it is cut short or damaged");
    let version = reader.u16()?;
    ensure!(version == VERSION, "version {version} of the format; this program reads version {VERSION}");
    let generation = reader.u32()?;
    let waves = reader.u32()?;
    ensure!(waves as usize == BASIS, "{waves} waves; this program has {BASIS}");
    let reported = reader.u32()?;
    ensure!(
        reported == anchors,
        "learned beside other anchors ({reported:08x}) than those in use ({anchors:08x})"
    );
    let mut weights = Weights { offset: reader.f32()?, steps: reader.u32()?, ..Weights::ZERO };
    for weight in &mut weights.waves {
        *weight = reader.f32()?;
    }
    ensure!(reader.0.is_empty(), "it is longer than it says");
    ensure!(weights.is_sound(), "weights that nothing can have learned");
    Ok((generation, weights))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANCHORS: u32 = 0xA5;

    fn load(path: &Path) -> Option<(u32, Weights)> {
        load_weights(path, ANCHORS).unwrap().map(|kept| (kept.generation, kept.weights))
    }

    #[test]
    fn weights_round_trip_and_detect_damage() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("people.learned");
        assert_eq!(load(&path), None);
        let mut weights = Weights { offset: 0.5, steps: 77, ..Weights::ZERO };
        weights.waves[9] = -1.25;
        save_weights(&path, &weights, ANCHORS).unwrap();
        assert_eq!(load(&path), Some((1, weights)));
        let whole = std::fs::read(&path).unwrap();
        for index in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[index] ^= 0x10;
            assert!(decode_weights(&damaged, ANCHORS).is_err(), "byte {index}");
            assert!(decode_weights(&whole[..index], ANCHORS).is_err(), "cut at {index}");
        }
        let others = decode_weights(&whole, ANCHORS + 1).unwrap_err().to_string();
        assert!(others.contains("other anchors (000000a5)"), "{others}");
        // A damaged file gives way to the one before, and that is reported.
        save_weights(&path, &Weights::ZERO, ANCHORS).unwrap();
        assert_eq!(load(&path), Some((2, Weights::ZERO)));
        std::fs::write(&path, &whole[..20]).unwrap();
        let kept = load_weights(&path, ANCHORS).unwrap().unwrap();
        assert_eq!((kept.generation, kept.weights), (1, weights));
        assert!(kept.passed_over.len() == 1 && kept.passed_over[0].contains("damaged"), "{kept:?}");
    }

    /// Whatever a power cut leaves of a save, at most the newest save is lost.
    #[test]
    fn cut_loses_at_most_the_newest() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("people.learned");
        let of = |offset: f32| Weights { offset, ..Weights::ZERO };
        save_weights(&path, &of(1.0), ANCHORS).unwrap();
        let newer = encode_weights(2, &of(2.0), ANCHORS);
        for cut in 0..=newer.len() {
            // Cut while the new file is written, and between the two renames.
            for aside in [false, true] {
                let (new, old) = (path.with_extension("learned.new"), path.with_extension("learned.old"));
                std::fs::write(&new, &newer[..cut]).unwrap();
                if aside {
                    std::fs::rename(&path, &old).unwrap();
                }
                let found = load(&path).expect("one of them is whole");
                assert!(
                    found == (1, of(1.0)) || (cut == newer.len() && found == (2, of(2.0))),
                    "{cut} {found:?}"
                );
                if aside {
                    std::fs::rename(&old, &path).unwrap();
                }
                std::fs::remove_file(&new).unwrap();
            }
        }
    }
}
