//! A drive: one or several files, read twice. The first reading finds how much there is and where the scanner is mounted.

use std::path::{Path, PathBuf};

use floorguard_host::outcome::BadInput;
use floorguard_host::packing::{beginning, must_be_a_file};
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::input::{OdometryTrack, ScanRecord};

use super::bag::{BagScans, BagSurvey};
use super::carmen;
use super::sieve::{Sieve, SieveCounters};
use crate::recordings::{MCAP_MAGIC, is_capture, is_log, not_for_us};

/// So much of a file tells what it is.
const SNIFF_BYTES: u64 = 65_536;
/// The files of one drive follow each other within this time, seconds.
const GAP_MAX_S: f64 = 60.0;

/// Takes scans one by one.
pub type Sink<'a> = dyn FnMut(ScanRecord) -> anyhow::Result<()> + 'a;

/// What is wanted of the files.
#[derive(Clone, Debug)]
pub struct InputOptions {
    /// Of bags, only this topic of scans.
    pub topic: Option<String>,
    /// Use the odometry of the files.
    pub with_odometry: bool,
    /// From this time on, seconds since the first scan.
    pub from_s: f64,
    /// Up to this time; infinite for all.
    pub to_s: f64,
}

/// What was read.
#[derive(Clone, Debug, Default)]
pub struct ReadSummary {
    /// What was used, left out and mended.
    pub counters: SieveCounters,
    /// Why a file ended early; everything before was used.
    pub ended: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FileKind {
    Log,
    Bag,
}

/// Files that belong together.
#[derive(Debug)]
pub struct Drive {
    files: Vec<(PathBuf, FileKind)>,
    options: InputOptions,
    bag: Option<BagScans>,
    first_s: f64,
    /// Scans that are wanted, about.
    pub scans: u64,
    /// Where the scanner is mounted on the robot.
    pub scanner_in_robot: Se2,
    /// What the user should know about the input.
    pub notes: Vec<String>,
}

fn bad(path: &Path, what: &dyn std::fmt::Display) -> BadInput {
    BadInput(format!("{}: {what}", path.display()))
}

fn kind_of(path: &Path) -> Result<FileKind, BadInput> {
    if path.is_dir() {
        return Err(bad(path, &"this is a folder; give the .mcap files in it"));
    }
    must_be_a_file(path).map_err(|error| bad(path, &error))?;
    let begins = beginning(path, SNIFF_BYTES).map_err(|error| bad(path, &error))?;
    if let Some(what) = not_for_us(&begins) {
        return Err(bad(path, &what));
    }
    if begins.starts_with(MCAP_MAGIC) {
        Ok(FileKind::Bag)
    } else if is_capture(&begins) {
        let what = "this is a capture of the network; scans are taken from recordings, bags (LaserScan) and CARMEN logs";
        Err(bad(path, &what))
    } else if is_log(&begins) {
        Ok(FileKind::Log)
    } else {
        Err(bad(
            path,
            &"neither a recording or bag (MCAP) nor a CARMEN log; `floorguard inspect` tells what it is",
        ))
    }
}

impl Drive {
    /// Looks at the files.
    ///
    /// # Errors
    /// A file cannot be read, holds no scans, or does not continue the one before.
    pub fn open(paths: &[PathBuf], options: InputOptions) -> anyhow::Result<Self> {
        let files = paths.iter().map(|path| Ok((path.clone(), kind_of(path)?)));
        let files = files.collect::<Result<Vec<_>, BadInput>>()?;
        let mut notes = Vec::new();
        let mut survey = BagSurvey::default();
        for (path, _) in files.iter().filter(|(_, kind)| *kind == FileKind::Bag) {
            survey.read(path)?;
        }
        let mut bag = None;
        if let Some((path, _)) = files.iter().find(|(_, kind)| *kind == FileKind::Bag) {
            let chosen = survey.choose(options.topic.as_deref()).map_err(|what| bad(path, &what))?;
            if !chosen.is_mounted {
                notes.push(
                    "the bag names no mounting of the scanner: the trajectory is that of the scanner"
                        .to_owned(),
                );
            }
            bag = Some(chosen);
        }
        let scanner_in_robot = bag.as_ref().map_or_else(Se2::default, |bag| bag.scanner_in_robot);
        let mut drive = Self { files, options, bag, first_s: 0.0, scans: 0, scanner_in_robot, notes };
        drive.count()?;
        Ok(drive)
    }

    fn count(&mut self) -> anyhow::Result<()> {
        let mut first_s: Option<f64> = None;
        let (mut last_s, mut last_path) = (f64::NEG_INFINITY, PathBuf::new());
        let mut times = Vec::new();
        for (path, kind) in &self.files {
            let (mut count, mut begins_s) = (0_u64, f64::INFINITY);
            self.read_file(path, *kind, &mut |record| {
                count += 1;
                begins_s = begins_s.min(record.time_s);
                times.push(record.time_s);
                Ok(())
            })?;
            if count == 0 {
                let what =
                    "no scan in it; needed are LaserScan messages, or lines FLASER, ROBOTLASER1 or RAWLASER1";
                return Err(bad(path, &what).into());
            }
            let gap_s = begins_s - last_s;
            if first_s.is_some() && !(0.0..=GAP_MAX_S).contains(&gap_s) {
                let what = format!(
                    "it begins {gap_s:.1} s after the end of {}: not the continuation of one drive; map it by itself",
                    last_path.display()
                );
                return Err(bad(path, &what).into());
            }
            first_s = first_s.or(Some(begins_s));
            last_s = times.last().copied().unwrap_or(begins_s);
            last_path.clone_from(path);
        }
        self.first_s = first_s.unwrap_or(0.0);
        self.scans = times.iter().filter(|time_s| self.is_wanted(**time_s)).count() as u64;
        if self.scans == 0 {
            return Err(BadInput(format!(
                "no scan between --from {} and --to {}",
                self.options.from_s, self.options.to_s
            ))
            .into());
        }
        Ok(())
    }

    /// The robot's heading over time by something with stamps of its own: the gyroscope, or else the odometry of a bag. The odometry
    /// of a log has the stamps of the scans.
    pub fn headings(&self) -> Option<&OdometryTrack> {
        let bag = self.bag.as_ref().filter(|_| self.options.with_odometry)?;
        [&bag.turned, &bag.odometry].into_iter().find(|track| !track.is_empty())
    }

    fn is_wanted(&self, time_s: f64) -> bool {
        (self.options.from_s..=self.options.to_s).contains(&(time_s - self.first_s))
    }

    fn read_file(&self, path: &Path, kind: FileKind, sink: &mut Sink<'_>) -> anyhow::Result<Option<String>> {
        match (kind, &self.bag) {
            (FileKind::Bag, Some(bag)) => bag.read(path, sink),
            _ => carmen::read(path, sink),
        }
    }

    /// Hands over the wanted scans in order, without those that a mapper must not see. `count` is called for each that is
    /// read.
    ///
    /// # Errors
    /// A file cannot be opened, or the sink's own.
    pub fn read(&self, count: &dyn Fn(), sink: &mut Sink<'_>) -> anyhow::Result<ReadSummary> {
        let mut sieve = Sieve::default();
        let mut ended = None;
        for (path, kind) in &self.files {
            ended = self.read_file(path, *kind, &mut |mut record| {
                if !self.is_wanted(record.time_s) {
                    return Ok(());
                }
                count();
                record.odometry = record.odometry.filter(|_| self.options.with_odometry);
                sieve.pass(record).map_or(Ok(()), &mut *sink)
            })?;
            if ended.is_some() {
                break;
            }
        }
        Ok(ReadSummary { counters: sieve.counters, ended })
    }
}
