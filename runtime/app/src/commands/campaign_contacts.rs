//! `floorguard campaign contacts` and `campaign merge`: worlds that hurt, judged by true geometry; resumable, in shards.

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use anyhow::Context;
use floorguard_host::executor::StopFlag;
use floorguard_host::outcome::{BadInput, WrongUsage};
use floorguard_laboratory::campaign::{
    ContactRow, ContactSummary, RunOutcome, contact_plan, contact_trial, run_seeds_until,
};
use indicatif::ProgressBar;

use super::exit::{Unfinished, VerdictFailed};
use super::interrupt::end_at_ctrl_c;

/// So many failed trials are listed one by one.
const REPORTED_MAX: usize = 40;

/// A part of the trials: this machine's of so many machines'.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Of this machine, from 1.
    part: u64,
    /// Machines.
    of: u64,
}

impl Default for Shard {
    fn default() -> Self {
        Self { part: 1, of: 1 }
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers =
            text.split_once('/').and_then(|(part, of)| Some((part.parse().ok()?, of.parse().ok()?)));
        let shard = numbers.map(|(part, of)| Self { part, of });
        let is_one = |shard: &Self| (1..=shard.of).contains(&shard.part);
        shard
            .filter(is_one)
            .ok_or_else(|| format!("'{text}' is no shard; write 3/16 for the third of sixteen"))
    }
}

impl Shard {
    fn has(self, trial: u64) -> bool {
        trial % self.of == self.part - 1
    }
}

/// What to play.
pub struct ContactCampaign<'a> {
    /// Seed of all trials.
    pub seed: u64,
    /// First trial, and how many.
    pub trials: std::ops::Range<u64>,
    /// This machine's part of them.
    pub shard: Shard,
    /// The file of rows: trials that are in it are not played again.
    pub record: Option<&'a Path>,
    /// Worlds of failed trials are written here as scenario files.
    pub worlds: Option<&'a Path>,
    /// One object on standard output.
    pub json: bool,
}

impl ContactCampaign<'_> {
    /// Plays what is not played yet, and says what it comes to.
    ///
    /// # Errors
    /// A trial did not pass, the run was cut, or a file cannot be read or written.
    pub fn run(&self, bar: &ProgressBar) -> anyhow::Result<()> {
        let mut rows = self.record.map(read_rows).transpose()?.unwrap_or_default();
        rows.retain(|row| {
            row.seed == self.seed && self.trials.contains(&row.trial) && self.shard.has(row.trial)
        });
        let known: BTreeSet<u64> = rows.iter().map(|row| row.trial).collect();
        let wanted = self.trials.clone().filter(|trial| self.shard.has(*trial) && !known.contains(trial));
        let wanted: Vec<u64> = wanted.collect();
        bar.set_length(wanted.len() as u64);
        let record = Mutex::new(self.record.map(open_rows).transpose()?);
        let played = Mutex::new(Vec::new());
        let ended = StopFlag::default();
        end_at_ctrl_c(&ended, "what is running is run to its end, and `--record` keeps it")?;
        run_seeds_until(0..wanted.len() as u64, &ended, |index| {
            let row = contact_trial(self.seed, wanted.get(index as usize).copied().unwrap_or_default());
            let failure = keep(&record, &row).err().map(|error| error.to_string());
            bar.inc(1);
            played.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push(row);
            RunOutcome { failure, ..RunOutcome::default() }
        })?;
        bar.finish_and_clear();
        let played = played.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        let is_cut = played.len() < wanted.len();
        rows.extend(played);
        if let Some(folder) = self.worlds {
            write_worlds(folder, &rows)?;
        }
        conclude(&rows, self.json)?;
        match is_cut {
            true => {
                Err(Unfinished("interrupted; the same command with `--record` goes on".to_owned()).into())
            }
            false => Ok(()),
        }
    }
}

/// Adds up the files of several machines.
///
/// # Errors
/// A file cannot be read, or a trial did not pass.
pub fn merge(files: &[PathBuf], json: bool) -> anyhow::Result<()> {
    if files.is_empty() {
        return Err(
            WrongUsage("campaign merge: name the files of rows that `--record` wrote".to_owned()).into()
        );
    }
    let mut rows = Vec::new();
    for file in files {
        anyhow::ensure!(file.exists(), BadInput(format!("{}: there is no such file", file.display())));
        rows.extend(read_rows(file)?);
    }
    conclude(&rows, json)
}

fn conclude(rows: &[ContactRow], json: bool) -> anyhow::Result<()> {
    let summary = ContactSummary::of(rows);
    if json {
        tell!("{}", serde_json::to_string(&summary)?)?;
    } else {
        say!("{}", summary.words().trim_end());
        let mut failed: Vec<&ContactRow> = rows.iter().filter(|row| !row.passed).collect();
        failed.sort_by_key(|row| row.trial);
        for row in failed.iter().take(REPORTED_MAX) {
            say!("failed ({}): {}\n  {}", row.family, row.failures.join(", "), row.command());
            row.contacts.iter().for_each(|line| say!("    {line}"));
        }
        if failed.len() > REPORTED_MAX {
            say!("and {} more", failed.len() - REPORTED_MAX);
        }
        let mut unseen: Vec<&ContactRow> = rows.iter().filter(|row| row.passed_with_contact()).collect();
        unseen.sort_by_key(|row| row.trial);
        for row in unseen.iter().take(REPORTED_MAX) {
            say!("passed with a contact ({}):\n  {}", row.family, row.command());
            row.contacts.iter().for_each(|line| say!("    {line}"));
        }
    }
    if summary.failed == 0 {
        return Ok(());
    }
    Err(VerdictFailed(format!("{} of {} trials failed", summary.failed, summary.trials)).into())
}

/// The rows of a file; a last line that was cut is left out, and its trial is played again.
fn read_rows(path: &Path) -> anyhow::Result<Vec<ContactRow>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text =
        std::fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    Ok(text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
}

fn open_rows(path: &Path) -> anyhow::Result<File> {
    let unwritable = |error| BadInput(format!("{}: cannot be written ({error})", path.display()));
    let mut file = OpenOptions::new().create(true).append(true).open(path).map_err(unwritable)?;
    // Behind a line that was cut.
    if file.metadata()?.len() > 0 {
        file.write_all(b"\n")?;
    }
    Ok(file)
}

fn keep(record: &Mutex<Option<File>>, row: &ContactRow) -> anyhow::Result<()> {
    let mut record = record.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(file) = record.as_mut() {
        file.write_all(format!("{}\n", serde_json::to_string(row)?).as_bytes())?;
    }
    Ok(())
}

/// One scenario file for each trial that failed: `floorguard simulate --scenario FILE` plays its world.
fn write_worlds(folder: &Path, rows: &[ContactRow]) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be made", folder.display()))?;
    for row in rows.iter().filter(|row| !row.passed) {
        let plan = contact_plan(row.seed, row.trial)?;
        let why: String =
            row.failures.iter().chain(&row.contacts).map(|line| format!("# {line}\n")).collect();
        let path = folder.join(format!("{}-{}-{}.toml", row.family, row.seed, row.trial));
        let text = format!("# {}\n{why}{}", row.command(), plan.scenario.to_toml());
        std::fs::write(&path, text).with_context(|| format!("{}: cannot be written", path.display()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_all_trials_without_overlap() {
        let shards: Vec<Shard> = ["1/3", "2/3", "3/3"].iter().map(|text| text.parse().unwrap()).collect();
        for trial in 0..30 {
            assert_eq!(shards.iter().filter(|shard| shard.has(trial)).count(), 1, "{trial}");
        }
        for wrong in ["0/3", "4/3", "3", "a/b", "1/0"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn row_file_resumes_after_a_cut_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.jsonl");
        let row = |trial| ContactRow { trial, seed: 5, ..ContactRow::default() };
        let write = |trial| {
            let file = Mutex::new(Some(open_rows(&path).unwrap()));
            keep(&file, &row(trial)).unwrap();
        };
        write(1);
        OpenOptions::new().append(true).open(&path).unwrap().write_all(b"{\"seed\":5,\"tri").unwrap();
        write(2);
        let trials: Vec<u64> = read_rows(&path).unwrap().iter().map(|row| row.trial).collect();
        assert_eq!(trials, [1, 2]);
    }
}
