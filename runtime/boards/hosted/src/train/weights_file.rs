//! What a robot learned about the looks of people, as a file: a header with version, generation, length and checksum.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `FLGLRN\r\n` |
//! | 2 | version of the format |
//! | 4 | generation: how often it was saved |
//! | 4 | number of waves |
//! | … | offset, steps, weights |
//! | 4 | CRC-32 (ISO-HDLC) of everything above |

use std::path::Path;

use anyhow::{bail, ensure};
use crc::{CRC_32_ISO_HDLC, Crc};
use floorguard_core::online_learning::{BASIS, Weights};

use crate::environment::bytes::{Reader, Writer};
use crate::environment::{places, replace_file};

const MAGIC: &[u8; 8] = b"FLGLRN\r\n";
const VERSION: u16 = 1;
const CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Saves weights; the file before them is kept as `.old`.
///
/// # Errors
/// The disk is full, or the folder cannot be written.
pub fn save_weights(path: &Path, weights: &Weights) -> anyhow::Result<()> {
    let generation = newest(path).0.map_or(0, |(generation, _)| generation).saturating_add(1);
    let mut file = Writer::default();
    file.bytes(MAGIC);
    file.u16(VERSION);
    file.u32(generation);
    file.u32(BASIS as u32);
    file.f32(weights.offset);
    file.u32(weights.steps);
    weights.waves.iter().for_each(|weight| file.f32(*weight));
    let checksum = CHECKSUM.checksum(&file.0);
    file.u32(checksum);
    replace_file(path, &file.0)
}

/// Reads the newest whole file. `None` if there has never been one.
///
/// # Errors
/// There are files, but none is whole.
pub fn load_weights(path: &Path) -> anyhow::Result<Option<Weights>> {
    match newest(path) {
        (Some((_, weights)), _) => Ok(Some(weights)),
        (None, problems) if problems.is_empty() => Ok(None),
        (None, problems) => bail!("{}", problems.join("; ")),
    }
}

fn newest(path: &Path) -> (Option<(u32, Weights)>, Vec<String>) {
    let (mut best, mut problems): (Option<(u32, Weights)>, Vec<String>) = (None, Vec::new());
    for place in places(path) {
        let read = match std::fs::read(&place) {
            Ok(bytes) => decode(&bytes),
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

fn decode(bytes: &[u8]) -> anyhow::Result<(u32, Weights)> {
    let Some((content, checksum)) = bytes.split_last_chunk::<4>() else { bail!("it ends too early") };
    let mut reader = Reader(content);
    ensure!(reader.bytes(8).ok() == Some(MAGIC.as_slice()), "nothing learned by floorguard");
    ensure!(CHECKSUM.checksum(content) == u32::from_le_bytes(*checksum), "it is cut short or damaged");
    let version = reader.u16()?;
    ensure!(version == VERSION, "version {version} of the format; this program reads version {VERSION}");
    let generation = reader.u32()?;
    let waves = reader.u32()?;
    ensure!(waves as usize == BASIS, "{waves} waves; this program has {BASIS}");
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

    #[test]
    fn weights_come_back_and_damage_is_noticed_at_every_byte() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("people.learned");
        assert_eq!(load_weights(&path).unwrap(), None);
        let mut weights = Weights { offset: 0.5, steps: 77, ..Weights::ZERO };
        weights.waves[9] = -1.25;
        save_weights(&path, &weights).unwrap();
        assert_eq!(load_weights(&path).unwrap(), Some(weights));
        let whole = std::fs::read(&path).unwrap();
        for index in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[index] ^= 0x10;
            assert!(decode(&damaged).is_err(), "byte {index}");
            assert!(decode(&whole[..index]).is_err(), "cut at {index}");
        }
        // A damaged file gives way to the one before.
        save_weights(&path, &Weights::ZERO).unwrap();
        std::fs::write(&path, &whole[..20]).unwrap();
        assert_eq!(load_weights(&path).unwrap(), Some(weights));
    }
}
