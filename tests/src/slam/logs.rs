//! The logs, their keys, and what others reached on them.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use floorguard_host::packing::unpacked;

use crate::data::recording;

/// A log.
pub struct Log {
    /// Its short name.
    pub name: &'static str,
    /// The file below the folder of logs.
    file: &'static str,
    /// The reference relations.
    key: &'static str,
    /// Mean translation errors of others, metres: iris_lama 1.3 scan to map, its graph, its particle filter; karto with
    /// slam_karto's values, with slam_toolbox's; gmapping; odometry alone. NaN where it was not run.
    pub peers_m: [f64; 7],
    /// Mean translation that must not be exceeded, metres.
    pub limit_m: f64,
}

/// Names of the peers.
pub const PEERS: [&str; 7] =
    ["lama map", "lama graph", "lama filter", "karto", "toolbox", "gmapping", "odometry"];

/// All five. The relations of ACES are true; those of the others come from corrected logs, which are some 5 cm off
/// themselves.
pub const LOGS: [Log; 5] = [
    Log {
        name: "aces",
        file: "radish_aces.clf.bz2",
        key: "keys/radish_aces.relations",
        peers_m: [0.502, 0.452, 0.043, 0.047, 0.044, 0.059, 0.549],
        limit_m: 0.037,
    },
    Log {
        name: "intel",
        file: "radish_intel.clf.bz2",
        key: "intel.pseudo_relations.gz",
        peers_m: [0.047, 0.054, 0.042, 0.066, 0.471, 0.048, 10.0],
        limit_m: 0.045,
    },
    Log {
        name: "fr101",
        file: "fr101.rebuilt_odometry.scans.gz",
        key: "fr101.pseudo_relations.gz",
        peers_m: [0.032, 0.039, 0.032, 0.042, 0.079, 0.037, 2.66],
        limit_m: 0.035,
    },
    Log {
        name: "edmonton",
        file: "edmonton.rebuilt_odometry.scans.gz",
        key: "edmonton.pseudo_relations.gz",
        peers_m: [0.046, 0.045, 0.050, 0.057, 0.089, f64::NAN, 0.224],
        limit_m: 0.048,
    },
    Log {
        name: "fhw",
        file: "fhw.rebuilt_odometry.scans.gz",
        key: "fhw.pseudo_relations.gz",
        peers_m: [0.069, 0.056, 0.069, 0.547, 0.101, f64::NAN, 16.6],
        limit_m: 0.055,
    },
];

/// Text of a file, packed or not.
///
/// # Errors
/// It cannot be read.
pub fn text(path: &Path) -> anyhow::Result<String> {
    let mut text = String::new();
    let mut source = File::open(path).and_then(unpacked).with_context(|| path.display().to_string())?;
    source.read_to_string(&mut text).with_context(|| path.display().to_string())?;
    Ok(text)
}

impl Log {
    /// The log as a CARMEN file, and its relations; `None` where they are absent. Three of the logs have a format of their
    /// own and are written as CARMEN lines into `folder`.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    pub fn files(&self, folder: &Path) -> anyhow::Result<Option<[PathBuf; 2]>> {
        let path = |name: &str| recording(&format!("slam2d_logs/{name}"));
        let Some((log, key)) = path(self.file).zip(path(self.key)) else { return Ok(None) };
        if self.file.contains(".clf") {
            return Ok(Some([log, key]));
        }
        let written = folder.join(format!("{}.clf", self.name));
        std::fs::write(&written, carmen(&text(&log)?)).with_context(|| written.display().to_string())?;
        Ok(Some([written, key]))
    }
}

/// Lines of time, odometry (x, y, heading), number of beams, first angle, step, ranges: as `FLASER` lines, whose beams begin
/// at −90° and lie 180° divided by their number apart, as these do.
fn carmen(text: &str) -> String {
    let mut log = String::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        if let [time, x, y, heading, beams, _first, _step, ranges @ ..] = words.as_slice() {
            let (pose, ranges) = (format!("{x} {y} {heading}"), ranges.join(" "));
            // Writing to a string cannot fail.
            let _ = writeln!(log, "FLASER {beams} {ranges} {pose} {pose} {time} nohost {time}");
        }
    }
    log
}
