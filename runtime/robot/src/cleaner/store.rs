//! What a power cut must not take: where the robot was, and what it had cleaned.
//!
//! A save is a version, the fingerprint of the plan that it belongs to, the pose, and every cell of which more is known than
//! at the start, closed by a CRC-32. In a file it replaces the one before only when it is whole on the disk.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::ensure;
use floorguard_mapping::{DirtCell, GridGeometry, NO_SLOT};
use floorguard_runtime::digest::Fnv64;
use floorguard_types::geometry::{Point2, Pose2};

use super::plan::MissionPlan;
use crate::environment::{Reader, Writer, places, read_newest, replace_file};

/// From the saved pose to what the brush may have reached after it, metres: a second of driving, half a metre of rolling
/// on, and half of the brush.
const SWEPT_SINCE_M: f32 = 1.5;
/// What the doubt leaves of the belief in dirt. Twenty cuts at 6 to 24 s of two missions in a room: 975 of 1,000 cells were
/// claimed, one of them falsely; with 0.65 it was 857 and none, with 0.8 it was 707.
const AS_LIKELY_AS_NOT: f32 = 0.5;
/// Cells below this probability of being dirty are left as they are.
const PLAINLY_DIRTY: f32 = 0.5;
const MAGIC: &[u8; 8] = b"FGMISS01";
const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// Where saves are kept.
#[derive(Clone, Debug, Default)]
pub enum Store {
    /// Nowhere.
    #[default]
    None,
    /// In memory: what a disk is to a robot whose computer is simulated.
    Memory(Arc<Mutex<Vec<u8>>>),
    /// In a file.
    File(PathBuf),
}

/// A mission that can go on.
#[derive(Clone, Debug, PartialEq)]
pub struct Saved {
    /// Where the robot was believed to be, map frame.
    pub pose_in_map: Pose2,
    cells: Vec<(u32, DirtCell)>,
}

impl Saved {
    /// Of a belief; only what differs from the `prior` is kept.
    pub fn of(pose_in_map: Pose2, cells: &[DirtCell], prior: &[DirtCell]) -> Self {
        // A cell under the brush is worth what it was before: the particles' credit dies with the computer.
        let settled = cells.iter().map(|cell| DirtCell { slot: NO_SLOT, ..*cell });
        let changed = settled.zip(prior).enumerate().filter(|(_, (cell, before))| cell != *before);
        Self { pose_in_map, cells: changed.map(|(index, (cell, _))| (index as u32, cell)).collect() }
    }

    /// Puts what was known back, and doubts what may have changed since.
    pub fn restore(&self, raster: &GridGeometry, cells: &mut [DirtCell]) {
        for (index, known) in &self.cells {
            if let Some(cell) = cells.get_mut(*index as usize) {
                *cell = *known;
            }
        }
        self.doubt_around(raster, cells);
    }

    /// What lies around the saved pose may have been swept since the save, or not: a belief that insists on its dirt would
    /// take a sensor that finds none for a sign that the robot is somewhere else. Nothing gains a claim by it.
    fn doubt_around(&self, raster: &GridGeometry, cells: &mut [DirtCell]) {
        let here = Point2::new(self.pose_in_map.x_m, self.pose_in_map.y_m);
        for (index, cell) in cells.iter_mut().enumerate() {
            let tail = cell.tail_probability();
            if tail < PLAINLY_DIRTY || raster.centre(index).distance(here) > SWEPT_SINCE_M {
                continue;
            }
            let heavy_units =
                if cell.heavy_units > 0 { f32::from(cell.heavy_units) } else { cell.expected_units };
            *cell = DirtCell {
                expected_units: cell.expected_units * AS_LIKELY_AS_NOT,
                tail: DirtCell::encode_tail(tail * AS_LIKELY_AS_NOT),
                slot: NO_SLOT,
                heavy_units: heavy_units.round().clamp(1.0, 254.0) as u8,
            };
        }
    }

    fn encode(&self, plan: u64) -> Vec<u8> {
        let mut out = Writer::default();
        out.bytes(MAGIC);
        out.bytes(&plan.to_le_bytes());
        out.f32(self.pose_in_map.x_m);
        out.f32(self.pose_in_map.y_m);
        out.f32(self.pose_in_map.heading_rad);
        out.u32(self.cells.len() as u32);
        for (index, cell) in &self.cells {
            out.u32(*index);
            out.f32(cell.expected_units);
            out.u16(cell.tail);
            out.u8(cell.heavy_units);
        }
        let crc = CRC.checksum(&out.0);
        out.u32(crc);
        out.0
    }

    fn decode(bytes: &[u8], (plan, cells_max): (u64, usize)) -> anyhow::Result<Self> {
        let (body, crc) =
            bytes.split_last_chunk::<4>().ok_or_else(|| anyhow::anyhow!("it ends too early"))?;
        ensure!(CRC.checksum(body) == u32::from_le_bytes(*crc), "its checksum is wrong");
        let mut input = Reader(body);
        ensure!(input.bytes(MAGIC.len())? == MAGIC, "it is no mission of this version");
        ensure!(input.bytes(8)? == plan.to_le_bytes(), "it belongs to another mission");
        let pose_in_map = Pose2::new(input.f32()?, input.f32()?, input.f32()?);
        let count = input.u32()? as usize;
        ensure!(count <= cells_max, "it has more cells than the floor");
        let mut cell = || {
            let (index, expected_units, tail) = (input.u32()?, input.f32()?.max(0.0), input.u16()?);
            Ok((index, DirtCell { expected_units, tail, slot: NO_SLOT, heavy_units: input.u8()? }))
        };
        let cells = (0..count).map(|_| cell()).collect::<anyhow::Result<_>>()?;
        Ok(Self { pose_in_map, cells })
    }
}

/// A save belongs to one plan only.
fn fingerprint(plan: &MissionPlan) -> u64 {
    let mut digest = Fnv64::new();
    digest.add(plan.to_text().unwrap_or_default().as_bytes());
    digest.value()
}

impl Store {
    /// Saves a mission. A disk that fails does not stop a robot: the failure is reported, and the save before
    /// stays.
    pub fn save(&self, plan: &MissionPlan, saved: &Saved) {
        match self {
            Self::None => {}
            Self::Memory(memory) => {
                *memory.lock().unwrap_or_else(PoisonError::into_inner) = saved.encode(fingerprint(plan));
            }
            Self::File(path) => {
                if let Err(error) = replace_file(path, &saved.encode(fingerprint(plan))) {
                    say!("  mission: not saved ({error:#})");
                }
            }
        }
    }

    /// The mission is done: the next one on this file begins anew. What is in memory lasts no longer than a run anyway.
    pub fn finish(&self) {
        if let Self::File(path) = self {
            for version in places(path) {
                // One that is not there needs no removing; one that stays goes on with a mission that is done.
                let _ = std::fs::remove_file(version);
            }
        }
    }

    /// Another mission begins: nothing of the one before is gone on with.
    pub fn forget(&self) {
        if let Self::Memory(memory) = self {
            memory.lock().unwrap_or_else(PoisonError::into_inner).clear();
        }
        self.finish();
    }

    /// The mission to go on with, if there is one for this plan.
    pub fn load(&self, plan: &MissionPlan, cells: usize) -> Option<Saved> {
        let wanted = (fingerprint(plan), cells);
        match self {
            Self::None => None,
            Self::Memory(memory) => {
                Saved::decode(&memory.lock().unwrap_or_else(PoisonError::into_inner), wanted).ok()
            }
            Self::File(path) => read_newest(path, |bytes| Saved::decode(bytes, wanted)),
        }
    }
}

#[cfg(test)]
mod tests {
    use floorguard_cleaning::CleanRule;

    use super::*;

    fn saved() -> Saved {
        let prior = vec![DirtCell::poisson(12.0, 0.9); 50];
        let mut cells = prior.clone();
        cells[7] = DirtCell { expected_units: 0.5, tail: 12, slot: NO_SLOT, heavy_units: 9 };
        cells[9].slot = 3;
        Saved::of(Pose2::new(1.0, -2.0, 0.5), &cells, &prior)
    }

    #[test]
    fn save_round_trips_and_detects_damage() {
        let bytes = saved().encode(5);
        let back = Saved::decode(&bytes, (5, 50)).unwrap();
        assert_eq!(back, saved());
        let mut cells = vec![DirtCell::poisson(12.0, 0.9); 50];
        let far = GridGeometry::new(50, 1, 0.1, Point2::new(100.0, 0.0)).unwrap();
        back.restore(&far, &mut cells);
        assert_eq!((cells[7].expected_units, cells[9].slot), (0.5, NO_SLOT));
        assert!(Saved::decode(&bytes, (6, 50)).is_err());
        for index in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[index] ^= 0x10;
            assert!(Saved::decode(&damaged, (5, 50)).is_err(), "{index}");
            assert!(Saved::decode(&bytes[..index], (5, 50)).is_err(), "{index}");
        }
    }

    /// Near the saved pose dirt is as likely as not, and stays to be cleaned; elsewhere, and where little is left, nothing changes.
    #[test]
    fn dirt_around_saved_pose_is_never_claimed() {
        let raster = GridGeometry::new(100, 1, 0.1, Point2::new(0.0, -2.05)).unwrap();
        let rule = CleanRule::per_cell(5, 0.01);
        let light = DirtCell {
            expected_units: 0.4,
            tail: DirtCell::encode_tail(0.015),
            slot: NO_SLOT,
            heavy_units: 7,
        };
        let mut cells = vec![DirtCell::poisson(12.0, 0.98); 100];
        cells[11] = light;
        saved().doubt_around(&raster, &mut cells);
        assert!((cells[10].tail_probability() - 0.49).abs() < 1e-3);
        assert_eq!((cells[10].expected_units, cells[10].heavy_units), (6.0, 12));
        assert_eq!((cells[11], cells[60]), (light, DirtCell::poisson(12.0, 0.98)));
        assert!(cells.iter().all(|cell| rule.needs_cleaning(cell)));
    }

    #[test]
    fn cut_file_leaves_the_previous_save() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mission.fgm");
        let old = saved().encode(5);
        replace_file(&path, &old).unwrap();
        let mut newer = saved();
        newer.pose_in_map.x_m = 9.0;
        replace_file(&path, &newer.encode(5)).unwrap();
        let read = || read_newest(&path, |bytes| Saved::decode(bytes, (5, 50)));
        assert_eq!(read().unwrap().pose_in_map.x_m, 9.0);
        std::fs::write(&path, &newer.encode(5)[..20]).unwrap();
        assert_eq!(read().unwrap().pose_in_map.x_m, 1.0);
        Store::File(path.clone()).finish();
        assert!(read().is_none(), "a mission that is done begins anew");
    }
}
