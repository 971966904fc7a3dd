//! Keeps the missions of Figure 5 that were run, so that a full run of hours can be broken off and go on.
//!
//! A line of JSON for each environment, share and range. A file of other code is of no use: its first line holds what one
//! mission of this code comes to, to the last bit.

use std::io::Write as _;
use std::path::PathBuf;

use floorguard_laboratory::mission::{Robot, TrialResult, run};
use floorguard_robot::site::{DirtSource, Floor, rooms};
use floorguard_types::random::Pcg32;
use serde::{Deserialize, Serialize};

use super::{SEED, protocol};

/// What is kept of a mission.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Kept {
    success: bool,
    quantile99: u32,
    distance_m: f32,
    time_s: f32,
    dirty: u32,
    claimed: u32,
    falsely: u32,
    covered: f32,
}

#[derive(Debug, Serialize, Deserialize)]
struct Row {
    environment: String,
    share: f32,
    range: (f32, f32),
    /// For each strategy, its missions in the order of their seeds.
    strategies: Vec<Vec<Kept>>,
}

/// The file.
pub struct Store {
    path: PathBuf,
    rows: Vec<Row>,
}

/// Which missions.
pub type Key<'a> = (&'a str, f32, (f32, f32));

impl Store {
    /// Reads what an earlier run left in a folder. A line that was cut off, or a file of other code, counts as not there.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn open(path: PathBuf) -> anyhow::Result<Self> {
        let mark = fingerprint()?;
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let mut lines = text.lines();
        let rows: Vec<Row> = if lines.next() == Some(mark.as_str()) {
            lines.filter_map(|line| serde_json::from_str(line).ok()).collect()
        } else {
            Vec::new()
        };
        let mut store = Self { path, rows: Vec::new() };
        std::fs::write(&store.path, format!("{mark}\n"))?;
        for row in rows {
            store.append(row)?;
        }
        Ok(store)
    }

    /// Combinations that are there.
    pub const fn count(&self) -> usize {
        self.rows.len()
    }

    /// The missions of a combination, if at least `trials` of them are there.
    pub fn get(&self, key: Key<'_>, trials: u64) -> Option<Vec<Vec<TrialResult>>> {
        let row = self.rows.iter().find(|r| (r.environment.as_str(), r.share, r.range) == key)?;
        let wanted = usize::try_from(trials).ok()?;
        row.strategies
            .iter()
            .map(|missions| Some(missions.get(..wanted)?.iter().map(Kept::mission).collect()))
            .collect()
    }

    /// Keeps the missions of a combination.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn put(
        &mut self,
        (environment, share, range): Key<'_>,
        missions: &[&[TrialResult]],
    ) -> anyhow::Result<()> {
        let strategies = missions.iter().map(|column| column.iter().map(Kept::of).collect()).collect();
        self.rows.retain(|r| (r.environment.as_str(), r.share, r.range) != (environment, share, range));
        self.append(Row { environment: environment.to_owned(), share, range, strategies })
    }

    fn append(&mut self, row: Row) -> anyhow::Result<()> {
        let mut file = std::fs::OpenOptions::new().append(true).open(&self.path)?;
        writeln!(file, "{}", serde_json::to_string(&row)?)?;
        self.rows.push(row);
        Ok(())
    }
}

impl Kept {
    fn of(result: &TrialResult) -> Self {
        Self {
            success: result.success,
            quantile99: result.quantile99,
            distance_m: result.distance_m,
            time_s: result.time_s,
            dirty: result.dirty_cells,
            claimed: result.claimed_cells,
            falsely: result.falsely_claimed_cells,
            covered: result.covered_share,
        }
    }

    fn mission(&self) -> TrialResult {
        TrialResult {
            success: self.success,
            quantile99: self.quantile99,
            distance_m: self.distance_m,
            time_s: self.time_s,
            dirty_cells: self.dirty,
            claimed_cells: self.claimed,
            falsely_claimed_cells: self.falsely,
            covered_share: self.covered,
            ..TrialResult::default()
        }
    }
}

/// What one mission comes to.
fn fingerprint() -> anyhow::Result<String> {
    let floor = Floor::new("plain", rooms::plain()?, Robot::PUBLISHED.radius_m)?;
    let dirt = DirtSource::Cells { count: 25, units: vec![15.0] };
    let expected = dirt.expected_units(&floor, &mut Pcg32::new(SEED, 0))?;
    let result = run(&floor, &protocol(), &expected, SEED)?;
    let place = result.path.last().copied().unwrap_or_default();
    let bits = [result.distance_m, result.mean_error_m, place.x_m, place.y_m].map(f32::to_bits);
    Ok(format!("missions of the code {bits:08x?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resumes_where_cut_and_rejects_other_code() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missions.jsonl");
        let missions = [
            TrialResult { distance_m: 12.5, success: true, ..TrialResult::default() },
            TrialResult::default(),
        ];
        let key = ("plain", 0.1, (5.0, 10.0));
        let mut store = Store::open(path.clone()).unwrap();
        store.put(key, &[&missions, &missions[..]]).unwrap();
        store.put(("plain", 0.2, (5.0, 10.0)), &[&missions]).unwrap();
        // Power fails within the last line.
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, &text[..text.len() - 9]).unwrap();
        let store = Store::open(path.clone()).unwrap();
        assert_eq!(store.count(), 1);
        let read = store.get(key, 2).unwrap();
        assert!(read.len() == 2 && read[0][0].success && read[0][0].distance_m == 12.5);
        assert!(store.get(key, 3).is_none());
        std::fs::write(&path, text.replacen("code", "other code", 1)).unwrap();
        assert_eq!(Store::open(path).unwrap().count(), 0);
    }
}
