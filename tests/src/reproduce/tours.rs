//! Tours and the filter's cost: ours beside what one installs today, on the same distances.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;

use crate::bench::{cleaning, tours};

/// Ours may be longer than the best tour of the peers by this, percent.
const EXCESS_MAX_PERCENT: f64 = 3.0;
/// The script that runs the peers, and what it needs for tours.
const PEERS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/peers/measure.py");

/// A line of a peer.
#[derive(Deserialize)]
struct Reported {
    peer: String,
    #[serde(default)]
    input: String,
    #[serde(default)]
    version: String,
    ns: Option<f64>,
    /// Length of its tour, units of the distances.
    length: Option<f64>,
    skipped: Option<String>,
}

/// Measures, and writes the text into `folder`. The second value says whether everything that must show did.
///
/// # Errors
/// A map that cannot be read, or a folder that cannot be written.
pub fn tours(folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let ours = tours::tours(folder)?;
    let peers = peers(folder);
    let mut text = String::from(
        "closed tours over cells of real buildings, the ways round the walls; times are those of one core\n",
    );
    let mut holds = true;
    for tour in &ours {
        let length = tour.length;
        let _infallible =
            writeln!(text, "{:28} ours {length:.0} units in {:.0} ms", tour.input, 1e-6 * tour.took.cpu_ns);
        for peer in peers.iter().filter(|peer| peer.input == tour.input) {
            let (Some(theirs), Some(ns)) = (peer.length, peer.ns) else { continue };
            let excess_percent = 100.0 * (length / theirs - 1.0);
            holds &= excess_percent <= EXCESS_MAX_PERCENT;
            let (name, version, ms) = (&peer.peer, &peer.version, ns / 1e6);
            let _infallible =
                writeln!(text, "{:32} {excess_percent:+.2} % over {name} {version}, {ms:.0} ms", "");
        }
    }
    for peer in &peers {
        if let Some(reason) = &peer.skipped {
            let _infallible = writeln!(text, "{}: absent, nothing compared ({reason})", peer.peer);
        }
    }
    for line in cleaning::run() {
        holds &= line.holds;
        let word = if line.holds { "" } else { "  MISSED" };
        let _infallible = writeln!(text, "{:46} {:36} {}{word}", line.stage, line.value, line.beside);
    }
    print!("{text}");
    std::fs::write(folder.join("tours.txt"), &text)?;
    Ok((text, holds))
}

/// What the peers say; one that is not there says so.
fn peers(folder: &Path) -> Vec<Reported> {
    let python = python();
    let output = Command::new(&python).arg(PEERS).arg(folder).args([".", ".", "tour"]).output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    let reported: Vec<Reported> = text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    if reported.is_empty() {
        let skipped = format!("{} does not run tests/peers/measure.py: it needs numpy", python.display());
        return vec![Reported {
            peer: "LKH, OR-Tools".to_owned(),
            input: String::new(),
            version: String::new(),
            ns: None,
            length: None,
            skipped: Some(skipped),
        }];
    }
    reported
}

/// Python with the peers: of FLOORGUARD_PYTHON, of the environment that `cargo xtask bench --peers` makes, or the system's.
fn python() -> PathBuf {
    if let Some(path) = std::env::var_os("FLOORGUARD_PYTHON") {
        return PathBuf::from(path);
    }
    let made = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/peers/venv/bin/python");
    if made.is_file() { made } else { PathBuf::from("python3") }
}
