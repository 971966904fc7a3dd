//! `floorguard report`: a recording as one HTML file.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use clap::Args;

use crate::recordings::say_findings;
use floorguard_configuration::{RecordedConfiguration, parse_recorded};
use floorguard_host::outcome::BadInput;
use floorguard_host::packing::unpacked;
use floorguard_host::words::counted;
use floorguard_mapping::environment::WallTime;
use floorguard_operator::report::{
    Circumstances, History, cells, cells_csv, document, pdf, proof, read_history,
};
use floorguard_operator::telemetry::RECORDED_AT;
use floorguard_operator::words::Language;
use floorguard_recording::Recording;
use floorguard_robot::environment::Calendar;

/// What to report.
#[derive(Clone, Debug, Args)]
pub struct ReportArguments {
    /// The recording (.mcap).
    pub file: PathBuf,
    /// Where to write the page; without it, beside the recording.
    #[arg(long, value_name = "FILE.html")]
    pub out: Option<PathBuf>,
    /// Name of the robot, as its owner calls it.
    #[arg(long, value_name = "NAME")]
    pub robot: Option<String>,
    /// Who operated it.
    #[arg(long, value_name = "NAME")]
    pub operator: Option<String>,
    /// Also write the report for other programs; its schema: `docs/report.schema.json`.
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Also write the proof as a PDF file for a customer: what was cleaned, claimed with which confidence, what not and why.
    #[arg(long, value_name = "FILE.pdf")]
    pub pdf: Option<PathBuf>,
    /// Language of the page and of the PDF file: en, de, fr, it or es; the data for other programs are in English.
    #[arg(long, value_name = "CODE", default_value = "en", value_parser = language)]
    pub language: Language,
    /// Also write each cell of a mission's floor: place, what is claimed, dirt before and after.
    #[arg(long, value_name = "FILE.csv")]
    pub cells: Option<PathBuf>,
}

/// A language by its two letters.
///
/// # Errors
/// It is none of those that pages and files are written in.
pub fn language(code: &str) -> Result<Language, String> {
    Language::of_code(code).ok_or_else(|| "write en, de, fr, it or es".to_owned())
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
    let robot = history.texts.get("robot.toml").map(|text| parse_recorded("robot.toml", text));
    if let Some(Ok(RecordedConfiguration { findings: Some(findings), .. })) = robot {
        say_findings(Some(&findings.to_string()));
    }
    let title = arguments.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let out = arguments.out.clone().unwrap_or_else(|| arguments.file.with_extension("html"));
    let circumstances = Circumstances {
        date: date(&history, &arguments.file),
        recording: title,
        robot: arguments.robot.clone(),
        operator: arguments.operator.clone(),
    };
    write(&out, document(&history, &circumstances, arguments.language).as_bytes())?;
    if let Some(path) = &arguments.json {
        let proof = proof(&history, &circumstances, Language::English);
        write(path, serde_json::to_string_pretty(&proof)?.as_bytes())?;
    }
    if let Some(path) = &arguments.pdf {
        let proof = proof(&history, &circumstances, arguments.language);
        write(path, &pdf(&proof, &history, arguments.language))?;
    }
    if let Some(path) = &arguments.cells {
        write(path, cells_csv(&cells(&history)).as_bytes())?;
    }
    let stops = counted(history.stops.len() as u64, "stop");
    say!("report: {} ({stops}, {:.0} s)", out.display(), history.duration_s);
    match &history.ended {
        Some(ended) => Err(bad(&format_args!("{ended}; the report shows everything before")).into()),
        None => Ok(()),
    }
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    std::fs::write(path, bytes)
        .map_err(|error| BadInput(format!("{}: cannot be written ({error})", path.display())).into())
}

/// When a run in real time began; a simulated one does not say: then, when its file was written.
fn date(history: &History, file: &Path) -> String {
    let written = || {
        let modified = file.metadata().ok()?.modified().ok()?;
        let since = modified.duration_since(UNIX_EPOCH).ok()?;
        let at = WallTime::from_micros(i64::try_from(since.as_micros()).ok()?);
        Some(Calendar::of_this_computer().iso(at))
    };
    history.texts.get(RECORDED_AT).cloned().or_else(written).unwrap_or_default()
}
