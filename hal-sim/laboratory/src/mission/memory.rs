//! What a mission must not forget when the power goes: what is believed of every cell, where the robot was, what it tried.
//!
//! A memory is bytes with a checksum. The file is written beside its place, brought to the disk and then renamed, so that
//! a cut at any moment leaves the memory before or the new one; half of one is never believed. Cells under the brush are
//! remembered as they were before it came: a power cut may cost work, never a false claim.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;

use anyhow::{Context as _, ensure};
use crc::{CRC_32_ISO_HDLC, Crc};
use floorguard_mapping::{DirtCell, NO_SLOT};
use floorguard_types::geometry::Pose2;

const MAGIC: &[u8; 8] = b"FGMISSN1";
const CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// What is remembered of a mission.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Memory {
    /// Which mission: a checksum of floor, dirt and promise.
    pub about: u32,
    /// Time since the start of the mission, s.
    pub time_s: f32,
    /// Where the robot believed to be, in the map frame.
    pub pose_in_map: Pose2,
    /// Lanes that the systematic strategy has not finished.
    pub lanes_left: u32,
    /// When the mission went on after earlier power cuts, s: a simulated world is driven through them again.
    pub cuts_s: Vec<f32>,
    /// Number of a cell and what is believed of it; all others are clean.
    pub cells: Vec<(u32, DirtCell)>,
    /// Number of a cell and how often it was visited, where it was.
    pub visits: Vec<(u32, u8)>,
}

/// Checksum of what makes a mission another one.
pub fn about(parts: impl IntoIterator<Item = u32>) -> u32 {
    let mut digest = CHECKSUM.digest();
    for part in parts {
        digest.update(&part.to_le_bytes());
    }
    digest.finalize()
}

impl Memory {
    /// As bytes, little-endian, with a CRC-32 at the end.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(self.about.to_le_bytes());
        let pose = self.pose_in_map;
        for number in [self.time_s, pose.x_m, pose.y_m, pose.heading_rad] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(self.lanes_left.to_le_bytes());
        bytes.extend((self.cuts_s.len() as u32).to_le_bytes());
        bytes.extend(self.cuts_s.iter().flat_map(|cut_s| cut_s.to_le_bytes()));
        bytes.extend((self.cells.len() as u32).to_le_bytes());
        for (cell, dirt) in &self.cells {
            bytes.extend(cell.to_le_bytes());
            bytes.extend(dirt.expected_units.to_le_bytes());
            bytes.extend(dirt.tail.to_le_bytes());
            bytes.push(dirt.heavy_units);
        }
        bytes.extend((self.visits.len() as u32).to_le_bytes());
        for (cell, visits) in &self.visits {
            bytes.extend(cell.to_le_bytes());
            bytes.push(*visits);
        }
        bytes.extend(CHECKSUM.checksum(&bytes).to_le_bytes());
        bytes
    }

    /// Reads what [`Self::encode`] wrote.
    ///
    /// # Errors
    /// A byte is missing, too many, or not what it was.
    pub fn decode(bytes: &[u8]) -> anyhow::Result<Self> {
        let (content, sum) = bytes.split_last_chunk::<4>().context("the memory of the mission is cut off")?;
        ensure!(content.starts_with(MAGIC), "this is no memory of a mission");
        ensure!(
            CHECKSUM.checksum(content) == u32::from_le_bytes(*sum),
            "the memory of the mission is damaged"
        );
        let mut reader = Reader { rest: &content[MAGIC.len()..] };
        let mut memory = Self { about: reader.word()?, time_s: reader.number()?, ..Self::default() };
        memory.pose_in_map = Pose2::new(reader.number()?, reader.number()?, reader.number()?);
        memory.lanes_left = reader.word()?;
        for _ in 0..reader.word()? {
            memory.cuts_s.push(reader.number()?);
        }
        for _ in 0..reader.word()? {
            let cell = reader.word()?;
            let expected_units = reader.number()?;
            let (tail, [heavy_units]) = (u16::from_le_bytes(reader.take()?), reader.take()?);
            memory.cells.push((cell, DirtCell { expected_units, tail, slot: NO_SLOT, heavy_units }));
        }
        for _ in 0..reader.word()? {
            let cell = reader.word()?;
            let [visits] = reader.take()?;
            memory.visits.push((cell, visits));
        }
        ensure!(reader.rest.is_empty(), "the memory of the mission is longer than it says");
        Ok(memory)
    }

    /// Puts the memory in the place of the one before, in one step.
    ///
    /// # Errors
    /// The disk is full, or the folder cannot be written; the memory before stays.
    pub fn save(&self, path: &Path) -> anyhow::Result<()> {
        let mut new = path.as_os_str().to_owned();
        new.push(".new");
        let fail = || format!("{}: cannot be written", path.display());
        let mut file = File::create(&new).with_context(fail)?;
        file.write_all(&self.encode()).and_then(|()| file.sync_all()).with_context(fail)?;
        drop(file);
        std::fs::rename(&new, path).with_context(fail)?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        // The name, too, must reach the disk. Some file systems cannot do that for folders.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
        Ok(())
    }

    /// Reads a memory; `None` where there is none.
    ///
    /// # Errors
    /// A file that is no memory, or a damaged one.
    pub fn load(path: &Path) -> anyhow::Result<Option<Self>> {
        match std::fs::read(path) {
            Ok(bytes) => Self::decode(&bytes).map(Some).with_context(|| path.display().to_string()),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error).with_context(|| path.display().to_string()),
        }
    }
}

struct Reader<'a> {
    rest: &'a [u8],
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> anyhow::Result<[u8; N]> {
        let (bytes, rest) =
            self.rest.split_first_chunk::<N>().context("the memory of the mission is cut off")?;
        self.rest = rest;
        Ok(*bytes)
    }

    fn word(&mut self) -> anyhow::Result<u32> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    fn number(&mut self) -> anyhow::Result<f32> {
        let number = f32::from_le_bytes(self.take()?);
        ensure!(number.is_finite(), "the memory of the mission holds what is no number");
        Ok(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn memory() -> Memory {
        Memory {
            about: 7,
            time_s: 12.5,
            pose_in_map: Pose2::new(1.0, -2.0, 0.5),
            lanes_left: 3,
            cuts_s: vec![4.5, 7.0],
            cells: vec![
                (5, DirtCell::poisson(4.0, 0.2)),
                (9, DirtCell { heavy_units: 12, ..DirtCell::CLEAN }),
            ],
            visits: vec![(5, 2)],
        }
    }

    #[test]
    fn comes_back_whole_or_not_at_all() {
        let bytes = memory().encode();
        assert_eq!(Memory::decode(&bytes).unwrap(), memory());
        for end in 0..bytes.len() {
            assert!(Memory::decode(&bytes[..end]).is_err(), "cut at {end}");
        }
        for bit in 0..8 * bytes.len() {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(Memory::decode(&damaged).is_err(), "bit {bit}");
        }
    }

    /// A cut leaves the new file unfinished beside the old one: the old one is what is read.
    #[test]
    fn cut_save_leaves_the_previous_memory() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mission");
        assert_eq!(Memory::load(&path).unwrap(), None);
        memory().save(&path).unwrap();
        let next = Memory { time_s: 13.5, ..memory() }.encode();
        for end in 0..next.len() {
            std::fs::write(folder.path().join("mission.new"), &next[..end]).unwrap();
            assert_eq!(Memory::load(&path).unwrap(), Some(memory()));
        }
        Memory { time_s: 13.5, ..memory() }.save(&path).unwrap();
        assert_eq!(Memory::load(&path).unwrap().unwrap().time_s, 13.5);
    }
}
