//! `floorguard blackbox`: the log of a black box, from a file or asked for on the MCU's line, listed and made a recording.

use std::fs::File;
use std::io::{BufWriter, ErrorKind, Read, Write};
use std::os::unix::fs::FileTypeExt;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use floorguard_runtime::black_box_log::{LOG_VERSION, LogRestart, LogRow, decode_row};
use floorguard_runtime::shared::BoxEntry;
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;
use serde::Serialize;

use floorguard_host::outcome::BadInput;
use floorguard_host::words::counted;
use floorguard_recording::{Diagnostic, RecordError, Recorder, Severity, topics};

/// What to read.
#[derive(Clone, Debug, Args)]
pub struct BlackBoxArguments {
    /// The log; or the line on which the MCU answers: a serial device, or the socket of an emulated one.
    pub file: PathBuf,
    /// Bit rate of a serial device.
    #[arg(long, default_value_t = 115_200)]
    pub baud: u32,
    /// Where to write the recording; without it, beside the log, or `blackbox.mcap` here.
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
    /// Deaths of the machine, each before the moment of this number.
    restarts: Vec<(usize, LogRestart)>,
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
    holding: Option<String>,
    permitted_mps: f32,
    measured_mps: f32,
    limit_mps: f32,
    field_set: u8,
}

#[derive(Serialize)]
struct RestartRow {
    restart: &'static str,
    detail: u32,
    uptime_ms: u32,
    deaths: u32,
}

/// Asks for the black box.
const REQUEST: &[u8] = b"B";
/// A line that is silent for this long is complete.
const QUIET: Duration = Duration::from_millis(1_000);
/// A read-out takes at most this long: 60 KiB at 115,200 Bd take five seconds.
const LONGEST: Duration = Duration::from_secs(60);

/// Runs the command.
///
/// # Errors
/// Bad input: not a single whole row.
pub fn run(arguments: &BlackBoxArguments) -> anyhow::Result<()> {
    let name = arguments.file.display();
    let bytes = bytes_of(&arguments.file, arguments.baud)
        .map_err(|error| BadInput(format!("{name}: cannot be read ({error})")))?;
    let contents = read(&bytes);
    if let Some(version) = contents.other_version {
        let what =
            format!("{name}: its rows have version {version}; this program reads version {LOG_VERSION}");
        return Err(BadInput(what).into());
    }
    if contents.moments.is_empty() && contents.restarts.is_empty() {
        return Err(BadInput(format!("{name}: no whole row of a black box in it")).into());
    }
    let mut begun_at = 0;
    for (end, restart) in contents.lives() {
        tell(contents.moments.get(begun_at..end).unwrap_or_default(), restart, arguments.json)?;
        begun_at = end;
    }
    let beside = || match line_of(&arguments.file) {
        Some(_) => PathBuf::from("blackbox.mcap"),
        None => arguments.file.with_extension("mcap"),
    };
    let out = arguments.out.clone().unwrap_or_else(beside);
    record(&out, &contents.one_after_the_other())
        .map_err(|error| BadInput(format!("{}: cannot be written ({error:#})", out.display())))?;
    let end = if contents.complete { "complete" } else { "cut" };
    say!(
        "{}, {}, {end}; recording: {}",
        counted(contents.moments.len() as u64, "moment"),
        counted(contents.damaged, "damaged row"),
        out.display()
    );
    Ok(())
}

/// What answers on a path; `None`: a file.
enum Line {
    Socket,
    Device,
}

fn line_of(path: &Path) -> Option<Line> {
    let kind = std::fs::metadata(path).ok()?.file_type();
    match (kind.is_socket(), kind.is_char_device()) {
        (true, _) => Some(Line::Socket),
        (_, true) => Some(Line::Device),
        _ => None,
    }
}

/// The log: a file's content, or what the machine on the line answers.
fn bytes_of(path: &Path, baud: u32) -> std::io::Result<Vec<u8>> {
    match line_of(path) {
        None => std::fs::read(path),
        Some(Line::Socket) => {
            let line = UnixStream::connect(path)?;
            line.set_read_timeout(Some(QUIET))?;
            ask(line)
        }
        Some(Line::Device) => {
            let port = serialport::new(path.to_string_lossy(), baud).timeout(QUIET);
            ask(port.open()?)
        }
    }
}

fn ask(mut line: impl Read + Write) -> std::io::Result<Vec<u8>> {
    line.write_all(REQUEST)?;
    let (mut answer, mut portion) = (Vec::new(), [0; 4_096]);
    let began = Instant::now();
    while began.elapsed() < LONGEST {
        match line.read(&mut portion) {
            Ok(0) => break,
            Ok(count) => answer.extend_from_slice(portion.get(..count).unwrap_or_default()),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            // The machine may think before it begins, but not for long.
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => break,
            Err(error) => return Err(error),
        }
    }
    Ok(answer)
}

impl Contents {
    /// Where each life ends in the moments, and what ended it.
    fn lives(&self) -> impl Iterator<Item = (usize, Option<&LogRestart>)> {
        let deaths = self.restarts.iter().map(|(end, restart)| (*end, Some(restart)));
        deaths.chain([(self.moments.len(), None)])
    }

    /// Each life begins at zero; in a recording it goes on where the one before ended.
    fn one_after_the_other(&self) -> Vec<(Stamp, BoxEntry)> {
        let (mut all, mut begun_at, mut offset_us) = (Vec::new(), 0, 0);
        for (end, restart) in self.lives() {
            let moments = self.moments.get(begun_at..end).unwrap_or_default();
            let shifted = |(stamp, entry): &(Stamp, BoxEntry)| {
                (Stamp::from_micros(stamp.as_micros().saturating_add(offset_us)), *entry)
            };
            all.extend(moments.iter().map(shifted));
            let lived_us = restart.map_or(0, |restart| u64::from(restart.uptime_ms) * 1_000);
            let last_us = moments.last().map_or(0, |(stamp, _)| stamp.as_micros());
            offset_us = u64::saturating_add(offset_us, lived_us.max(last_us));
            begun_at = end;
        }
        all
    }
}

fn tell(moments: &[(Stamp, BoxEntry)], restart: Option<&LogRestart>, json: bool) -> anyhow::Result<()> {
    if json {
        for (stamp, entry) in moments {
            tell!("{}", serde_json::to_string(&row(*stamp, entry))?)?;
        }
    } else {
        moments.windows(2).try_for_each(report_change)?;
    }
    let Some(restart) = restart else { return Ok(()) };
    let name = restart.known_cause().map_or("cause unknown to this program", |cause| cause.name());
    let LogRestart { detail, uptime_ms, deaths, .. } = *restart;
    if json {
        tell!("{}", serde_json::to_string(&RestartRow { restart: name, detail, uptime_ms, deaths })?)?;
    } else {
        let seconds = f64::from(uptime_ms) * 1.0e-3;
        tell!("{seconds:10.3} s  RESET, number {deaths}: {name} ({detail:#x})")?;
    }
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
            Some(LogRow::Restart(restart)) => contents.restarts.push((contents.moments.len(), restart)),
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
        holding: entry.holding.map(|cause| cause.to_string()),
        permitted_mps: entry.permitted_mps,
        measured_mps: entry.measured_mps,
        limit_mps: entry.limit_mps,
        field_set: entry.field_set,
    }
}

fn report_change(pair: &[(Stamp, BoxEntry)]) -> std::io::Result<()> {
    let [(_, before), (stamp, now)] = pair else { return Ok(()) };
    if (before.state, before.action, before.holding) != (now.state, now.action, now.holding) {
        let cause = now.holding.map_or_else(String::new, |cause| format!(": {cause}"));
        tell!(
            "{:10.3} s  {:?}, {}{cause}  at {:.2} m/s",
            stamp.as_micros() as f64 * 1.0e-6,
            now.state,
            now.action,
            now.measured_mps
        )?;
    }
    Ok(())
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

type Known = Option<(floorguard_guard::GuardState, floorguard_guard::Action)>;

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
    let [first, cause] =
        [entry.cause, entry.holding].map(|cause| cause.map(|cause| cause.to_string()).unwrap_or_default());
    let values = [
        ("state", format!("{:?}", entry.state)),
        ("action", entry.action.to_string()),
        ("cause", cause.clone()),
        ("first_cause", first),
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
