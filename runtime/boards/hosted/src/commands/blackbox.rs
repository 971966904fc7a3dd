//! `floorguard blackbox`: the log of a black box, from the MCU or from `run --black-box`, listed and made a recording.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use clap::Args;
use floorguard_core::geometry::Twist2;
use floorguard_core::time::Stamp;
use floorguard_runtime::black_box_log::{LOG_VERSION, LogRow, decode_row};
use floorguard_runtime::shared::BoxEntry;
use serde::Serialize;

use super::exit::BadInput;
use crate::recording::{Diagnostic, RecordError, Recorder, Severity, topics};

/// What to read.
#[derive(Clone, Debug, Args)]
pub struct BlackBoxArguments {
    /// The log.
    pub file: PathBuf,
    /// Where to write the recording; without it, beside the log.
    #[arg(long, value_name = "FILE.mcap")]
    pub out: Option<PathBuf>,
    /// One object per moment and line on standard output.
    #[arg(long)]
    pub json: bool,
}

/// What a log holds.
#[derive(Debug, Default)]
struct Contents {
    moments: Vec<(Stamp, BoxEntry)>,
    damaged: u64,
    complete: bool,
    other_version: Option<u8>,
}

#[derive(Serialize)]
struct MomentRow {
    time_us: u64,
    state: String,
    action: String,
    cause: Option<String>,
    permitted_mps: f32,
    measured_mps: f32,
    limit_mps: f32,
    field_set: u8,
}

/// Runs the command.
///
/// # Errors
/// Bad input: not a single whole row.
pub fn run(arguments: &BlackBoxArguments) -> anyhow::Result<()> {
    let name = arguments.file.display();
    let bytes = std::fs::read(&arguments.file)
        .map_err(|error| BadInput(format!("{name}: cannot be read ({error})")))?;
    let contents = read(&bytes);
    if let Some(version) = contents.other_version {
        let what =
            format!("{name}: its rows have version {version}; this program reads version {LOG_VERSION}");
        return Err(BadInput(what).into());
    }
    if contents.moments.is_empty() {
        return Err(BadInput(format!("{name}: no whole row of a black box in it")).into());
    }
    if arguments.json {
        for (stamp, entry) in &contents.moments {
            anstream::println!("{}", serde_json::to_string(&row(*stamp, entry))?);
        }
    } else {
        contents.moments.windows(2).for_each(tell_change);
    }
    let out = arguments.out.clone().unwrap_or_else(|| arguments.file.with_extension("mcap"));
    record(&out, &contents.moments)
        .map_err(|error| BadInput(format!("{}: cannot be written ({error:#})", out.display())))?;
    let end = if contents.complete { "complete" } else { "cut" };
    anstream::eprintln!(
        "{} moments, {} damaged rows, {end}; recording: {}",
        contents.moments.len(),
        contents.damaged,
        out.display()
    );
    Ok(())
}

fn read(bytes: &[u8]) -> Contents {
    let mut contents = Contents::default();
    let mut rows: Vec<&[u8]> = bytes.split(|byte| *byte == 0).collect();
    // What stands behind the last zero was cut, or is nothing.
    let rest = rows.pop().unwrap_or_default();
    // A file may hold several read-outs: each counts its own moments.
    let mut begun_at = 0;
    contents.damaged += u64::from(!rest.is_empty());
    for packed in rows.into_iter().filter(|packed| !packed.is_empty()) {
        match decode_row(&mut packed.to_vec()) {
            Some(LogRow::Begin(LOG_VERSION, _)) => {
                begun_at = contents.moments.len();
                contents.complete = false;
            }
            Some(LogRow::Begin(version, _)) => contents.other_version = Some(version),
            Some(LogRow::Moment(moment)) => match moment.entry() {
                Some(entry) => contents.moments.push(entry),
                None => contents.damaged += 1,
            },
            Some(LogRow::End(moments)) => {
                contents.complete = moments as usize == contents.moments.len() - begun_at;
            }
            None => contents.damaged += 1,
        }
    }
    contents
}

fn row(stamp: Stamp, entry: &BoxEntry) -> MomentRow {
    MomentRow {
        time_us: stamp.as_micros(),
        state: format!("{:?}", entry.state),
        action: entry.action.to_string(),
        cause: entry.cause.map(|cause| cause.to_string()),
        permitted_mps: entry.permitted_mps,
        measured_mps: entry.measured_mps,
        limit_mps: entry.limit_mps,
        field_set: entry.field_set,
    }
}

fn tell_change(pair: &[(Stamp, BoxEntry)]) {
    let [(_, before), (stamp, now)] = pair else { return };
    if (before.state, before.action, before.cause) != (now.state, now.action, now.cause) {
        let cause = now.cause.map_or_else(String::new, |cause| format!(": {cause}"));
        anstream::println!(
            "{:10.3} s  {:?}, {}{cause}  at {:.2} m/s",
            stamp.as_micros() as f64 * 1.0e-6,
            now.state,
            now.action,
            now.measured_mps
        );
    }
}

fn record(path: &Path, moments: &[(Stamp, BoxEntry)]) -> anyhow::Result<()> {
    let mut recorder = Recorder::new(BufWriter::new(File::create(path)?))?;
    let mut last = None;
    for (stamp, entry) in moments {
        write_moment(&mut recorder, (*stamp, entry), &mut last)?;
    }
    recorder.finish()?;
    Ok(())
}

type Known = Option<(floorguard_core::guard::GuardState, floorguard_core::guard::Action)>;

fn write_moment(
    recorder: &mut Recorder<BufWriter<File>>,
    (stamp, entry): (Stamp, &BoxEntry),
    last: &mut Known,
) -> Result<(), RecordError> {
    let forward = |linear_mps| Twist2 { linear_mps, angular_radps: 0.0 };
    recorder.permitted(stamp, forward(entry.permitted_mps), entry.limit_mps)?;
    recorder.measured(stamp, forward(entry.measured_mps))?;
    let known = Some((entry.state, entry.action));
    let stops = entry.action.stops();
    let stopped = last.is_some_and(|(_, action)| action.stops());
    if *last == known {
        return Ok(());
    }
    let diagnostic = describe(entry);
    if stops && !stopped && last.is_some() {
        recorder.diagnostics(topics::STOPS, stamp, std::slice::from_ref(&diagnostic))?;
    }
    *last = known;
    recorder.diagnostics(topics::DIAGNOSTICS, stamp, &[Diagnostic { name: "guard".to_owned(), ..diagnostic }])
}

fn describe(entry: &BoxEntry) -> Diagnostic {
    let cause = entry.cause.map(|cause| cause.to_string()).unwrap_or_default();
    let values = [
        ("state", format!("{:?}", entry.state)),
        ("action", entry.action.to_string()),
        ("cause", cause.clone()),
        ("speed_mps", format!("{:.3}", entry.measured_mps)),
        ("speed_limit_mps", format!("{:.3}", entry.limit_mps)),
    ];
    Diagnostic {
        severity: if entry.action.stops() { Severity::Error } else { Severity::Good },
        name: cause.clone(),
        message: format!("{cause} -> {}", entry.action),
        values: values.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
    }
}
