//! What the panel keeps over the runs: areas of the map, alerts, days; in one file that survives a cut at any byte.
//!
//! The robot's side adds to it about once a second, browsers read it; nobody writes to the disk while holding it.

mod alerts;
mod days;
mod parts;
mod schedules;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use floorguard_robot::cleaner::{Area, check_areas};
use floorguard_robot::environment::{Calendar, read_newest, replace_file};
use serde::{Deserialize, Serialize};

pub use alerts::Alert;
pub use days::{Day, MissionRecord};
pub use parts::PartUse;
pub use schedules::Schedule;

use alerts::Alerts;
use schedules::{check_schedules, take_due};

/// Days that are kept.
const DAYS_MAX: usize = 400;
/// Version of the file.
const VERSION: u32 = 1;

/// What is in the file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    version: u32,
    /// Areas of the map.
    pub areas: Vec<Area>,
    /// What happened, the newest first.
    pub alerts: Alerts,
    /// What was done, by date.
    pub days: BTreeMap<String, Day>,
    /// Missions that begin by the clock.
    #[serde(default)]
    pub schedules: Vec<Schedule>,
    /// Parts that wear out, by name.
    #[serde(default)]
    pub parts: BTreeMap<String, PartUse>,
}

/// The records of a panel.
#[derive(Debug, Default)]
pub struct Records {
    path: Option<PathBuf>,
    kept: Kept,
    number: u64,
    saved: u64,
}

/// Why areas or schedules are not taken.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct RecordRefused(String);

impl Records {
    /// Of a file; without one, of this run only. A file that cannot be read is left alone and reported.
    #[must_use]
    pub fn open(path: Option<PathBuf>) -> Self {
        let decode = |bytes: &[u8]| -> anyhow::Result<Kept> {
            let kept: Kept = serde_json::from_slice(bytes)?;
            anyhow::ensure!(kept.version == VERSION, "another version");
            check_areas(&kept.areas)?;
            check_schedules(&kept.schedules)?;
            Ok(kept)
        };
        let kept = path.as_ref().and_then(|path| read_newest(path, decode));
        if let Some(path) = path.as_ref().filter(|path| kept.is_none() && path.exists()) {
            say!("  panel: {} cannot be read; it begins anew and keeps that file as .old", path.display());
        }
        Self { path, kept: kept.unwrap_or_default(), number: 1, saved: 1 }
    }

    /// Counts changes.
    #[must_use]
    pub const fn number(&self) -> u64 {
        self.number
    }

    /// What is kept.
    #[must_use]
    pub const fn kept(&self) -> &Kept {
        &self.kept
    }

    /// Others from now on.
    ///
    /// # Errors
    /// Areas that no plan can have.
    pub fn set_areas(&mut self, areas: Vec<Area>) -> Result<(), RecordRefused> {
        check_areas(&areas).map_err(|error| RecordRefused(error.to_string()))?;
        self.kept.areas = areas;
        self.number += 1;
        Ok(())
    }

    /// Other schedules from now on. One that stays as it was does not begin a second time today.
    ///
    /// # Errors
    /// Schedules that the clock cannot follow.
    pub fn set_schedules(&mut self, schedules: Vec<Schedule>) -> Result<(), RecordRefused> {
        check_schedules(&schedules).map_err(|error| RecordRefused(error.to_string()))?;
        let began = |schedule: &Schedule| {
            let is_same = |known: &&Schedule| known.name == schedule.name && known.minute == schedule.minute;
            self.kept.schedules.iter().find(is_same).map(|known| known.began.clone()).unwrap_or_default()
        };
        let schedules =
            schedules.into_iter().map(|schedule| Schedule { began: began(&schedule), ..schedule });
        self.kept.schedules = schedules.collect();
        self.number += 1;
        Ok(())
    }

    /// The missions that the clock begins now; each is given once.
    pub fn take_due(&mut self, calendar: &Calendar) -> Vec<Schedule> {
        let due = take_due(&mut self.kept.schedules, calendar);
        self.number += u64::from(!due.is_empty());
        due
    }

    /// A part that wears out was driven with; true when its life has ended with it.
    pub fn use_part(&mut self, name: &str, driven_s: f64, life_h: f32) -> bool {
        self.number += 1;
        self.kept.parts.entry(name.to_owned()).or_default().add(driven_s, life_h)
    }

    /// A technician has changed a part. False if there is none of this name.
    pub fn part_changed(&mut self, name: &str, at: &str) -> bool {
        let Some(part) = self.kept.parts.get_mut(name) else { return false };
        *part = PartUse { changed: at.to_owned(), ..PartUse::default() };
        self.number += 1;
        true
    }

    /// Something happened.
    pub fn alert(&mut self, alert: Alert) {
        self.kept.alerts.push(alert);
        self.number += 1;
    }

    /// A person has seen an alert; without a number, all. False if there is none to be seen.
    pub fn acknowledge(&mut self, id: Option<u64>, at: &str) -> bool {
        let any = self.kept.alerts.acknowledge(id, at);
        self.number += u64::from(any);
        any
    }

    /// Adds to a day.
    pub fn on_day(&mut self, date: &str, add: impl FnOnce(&mut Day)) {
        add(self.kept.days.entry(date.to_owned()).or_default());
        if self.kept.days.len() > DAYS_MAX {
            self.kept.days.pop_first();
        }
        self.number += 1;
    }

    /// The file and its bytes, if there is something to write.
    fn unsaved(&mut self) -> Option<(PathBuf, Vec<u8>)> {
        let path = self.path.clone().filter(|_| self.saved != self.number)?;
        self.saved = self.number;
        self.kept.version = VERSION;
        Some((path, serde_json::to_vec(&self.kept).ok()?))
    }
}

/// Records that the robot's side and the browsers' side share.
#[derive(Clone, Debug, Default)]
pub struct SharedRecords(Arc<Mutex<Records>>);

impl SharedRecords {
    /// Shares records.
    #[must_use]
    pub fn new(records: Records) -> Self {
        Self(Arc::new(Mutex::new(records)))
    }

    /// The records, for a moment.
    pub fn lock(&self) -> MutexGuard<'_, Records> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes what has changed. For the browsers' side: a slow disk holds up nothing else.
    ///
    /// # Errors
    /// The disk is full, or the folder cannot be written.
    pub fn save(&self) -> anyhow::Result<()> {
        let unsaved = self.lock().unsaved();
        let Some((path, bytes)) = unsaved else { return Ok(()) };
        replace_file(&path, &bytes).inspect_err(|_| self.lock().saved = 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_robot::cleaner::AreaKind;

    fn area(name: &str) -> Area {
        let corners_m = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]];
        Area { name: name.to_owned(), kind: AreaKind::NoGo, corners_m }
    }

    fn alert() -> Alert {
        Alert { name: "emergency stop pressed".to_owned(), ..Alert::default() }
    }

    /// Whatever a cut leaves of the file, the newest whole one is read.
    #[test]
    fn records_survive_a_cut_at_any_byte() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("panel.json");
        let records = SharedRecords::new(Records::open(Some(path.clone())));
        records.lock().set_areas(vec![area("first")]).unwrap();
        records.save().unwrap();
        records.lock().set_areas(vec![area("second")]).unwrap();
        records.lock().alert(alert());
        records.save().unwrap();
        let whole = std::fs::read(&path).unwrap();
        let name = || Records::open(Some(path.clone())).kept.areas.first().map(|area| area.name.clone());
        assert_eq!(name().as_deref(), Some("second"));
        for cut in 0..whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            assert_eq!(name().as_deref(), Some("first"), "{cut}");
        }
    }

    #[test]
    fn alerts_are_acknowledged_once() {
        let mut records = Records::open(None);
        records.alert(alert());
        records.alert(alert());
        let id = records.kept().alerts.newest().expect("an alert").id;
        assert!(records.acknowledge(Some(id), "now") && !records.acknowledge(Some(id), "later"));
        assert!(records.acknowledge(None, "later") && !records.acknowledge(None, "later"));
    }

    #[test]
    fn two_areas_of_one_name_are_refused() {
        let mut records = Records::open(None);
        assert!(records.set_areas(vec![area("hall"), area("hall")]).is_err());
        assert_eq!(records.number(), 1);
    }
}
