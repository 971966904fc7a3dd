//! `floorguard report`: a recording as one HTML file.

use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;

use clap::Args;

use super::exit::BadInput;
use floorguard_host::packing::unpacked;
use floorguard_host::words::counted;
use floorguard_operator::report::{document, read_history};
use floorguard_recording::Recording;

/// What to report.
#[derive(Clone, Debug, Args)]
pub struct ReportArguments {
    /// The recording (.mcap).
    pub file: PathBuf,
    /// Where to write the page; without it, beside the recording.
    #[arg(long, value_name = "FILE.html")]
    pub out: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Bad input, or the page cannot be written. Of a recording that is cut the page shows everything before the cut.
pub fn run(arguments: &ReportArguments) -> anyhow::Result<()> {
    let name = arguments.file.display();
    let bad = |error: &dyn std::fmt::Display| BadInput(format!("{name}: {error}"));
    let file = File::open(&arguments.file).and_then(unpacked).map_err(|error| bad(&error))?;
    let mut recording = Recording::new(BufReader::new(file));
    let history = read_history(&mut recording).map_err(|error| bad(&error))?;
    if history.path.is_empty() && history.scans.is_empty() {
        return Err(bad(&"the recording holds neither odometry nor scans: nothing to report").into());
    }
    let title = arguments.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let out = arguments.out.clone().unwrap_or_else(|| arguments.file.with_extension("html"));
    std::fs::write(&out, document(&history, &title))
        .map_err(|error| BadInput(format!("{}: cannot be written ({error})", out.display())))?;
    let stops = counted(history.stops.len() as u64, "stop");
    say!("report: {} ({stops}, {:.0} s)", out.display(), history.duration_s);
    match &history.ended {
        Some(ended) => Err(bad(&format_args!("{ended}; the report shows everything before")).into()),
        None => Ok(()),
    }
}
