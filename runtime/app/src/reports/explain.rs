//! `floorguard explain`: why the robot stopped, from a recording.

use std::fs::File;
use std::io::{BufReader, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;

use super::report::language;
use crate::recordings::say_findings;
use floorguard_host::outcome::BadInput;
use floorguard_host::packing::{must_be_a_file, unpacked};
use floorguard_operator::incident::{Gather, Incident, Snapshot, page};
use floorguard_operator::words::Language;
use floorguard_recording::replay::{ReplayOutcome, is_replayable, replay_recording};
use floorguard_recording::{RUN_METADATA, Recorded, Recording, topics};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_types::time::Stamp;

type RunRecording = Recording<BufReader<Box<dyn std::io::Read + Send>>>;

/// What to explain.
#[derive(Clone, Debug, Args)]
pub struct ExplainArguments {
    /// The recording (.mcap) of `--record`.
    pub file: PathBuf,
    /// The moment, seconds of the robot's clock, as `replay` and `report` print it; a stop that begins within 0.6 s of it is
    /// meant. Without it, the last stop.
    #[arg(long, value_name = "SECONDS", value_parser = moment_s)]
    pub at: Option<f64>,
    /// Also write one page that needs nothing else: the moment from above, the sensors, the ten seconds before.
    #[arg(long, value_name = "FILE.html")]
    pub out: Option<PathBuf>,
    /// Language of the text and of the page: en, de, fr, it or es; `--json` is in English.
    #[arg(long, value_name = "CODE", default_value = "en", value_parser = language)]
    pub language: Language,
    /// One object on standard output in place of the text; its fields: book, What a recording holds.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// Bad input, a moment that the recording does not hold, or a page that cannot be written.
pub fn run(arguments: &ExplainArguments) -> anyhow::Result<()> {
    let name = arguments.file.display().to_string();
    let bad = |what: &dyn std::fmt::Display| BadInput(format!("{name}: {what}"));
    must_be_a_file(&arguments.file).map_err(|error| bad(&error))?;
    let asked_s = match arguments.at {
        Some(at_s) => at_s,
        None => last_stop_s(&arguments.file)?
            .ok_or_else(|| bad(&"it holds no stop; name a moment with --at SECONDS"))?,
    };
    let (first, mut recording) = open(&arguments.file)?;
    let robot = robot_of(&recording).map_err(|error| bad(&error))?;
    let mut gather = Gather::new(&robot, Stamp::from_micros((asked_s * 1.0e6) as u64));
    let outcome = replay_recording(first, &mut recording, &mut gather).map_err(|error| bad(&error))?;
    say_findings(outcome.findings.as_deref());
    let snapshots = gather.finish();
    let drive = robot.guard().drive;
    let incident = |language| {
        let repetition = repetition(&outcome, snapshots.last(), language);
        Incident::new((&name, repetition), &snapshots, (&drive, language)).ok_or_else(|| {
            let end_s = outcome.played_us as f64 * 1.0e-6;
            bad(&format_args!("{asked_s:.3} s is not in it; it holds 0 s to {end_s:.1} s"))
        })
    };
    let spoken = incident(arguments.language)?;
    if let Some(out) = &arguments.out {
        std::fs::write(out, page(&spoken, &snapshots))
            .map_err(|error| BadInput(format!("{}: cannot be written ({error})", out.display())))?;
        say!("explain: {}", out.display());
    }
    let mut stdout = std::io::stdout().lock();
    if arguments.json {
        writeln!(stdout, "{}", serde_json::to_string(&incident(Language::English)?)?)?;
    } else {
        write!(stdout, "{}", spoken.text())?;
    }
    Ok(())
}

/// After its first message, behind which it says what it is.
fn open(path: &Path) -> anyhow::Result<(Recorded, RunRecording)> {
    let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
    let file = File::open(path).and_then(unpacked).map_err(|error| bad(&error))?;
    let mut recording = Recording::new(BufReader::new(file));
    let first = match recording.next() {
        Some(Ok(first)) => first,
        Some(Err(error)) => return Err(bad(&error).into()),
        None => return Err(bad(&"the recording holds no message").into()),
    };
    if !is_replayable(&recording) {
        return Err(bad(&"only a recording that floorguard made with --record can be explained").into());
    }
    Ok((first, recording))
}

fn robot_of(recording: &RunRecording) -> anyhow::Result<RobotConfiguration> {
    let text = recording.metadata(RUN_METADATA).and_then(|texts| texts.get("robot.toml"));
    let text = text.ok_or_else(|| anyhow::anyhow!("it does not say what robot made it"))?;
    Ok(floorguard_configuration::parse_recorded("robot.toml", text)?.configuration.robot)
}

/// When the last stop began, seconds of the robot's clock.
fn last_stop_s(path: &Path) -> anyhow::Result<Option<f64>> {
    let (_, recording) = open(path)?;
    // What was complete before damage counts; the replay names the damage.
    let stops = recording.map_while(Result::ok).filter(|message| &*message.topic == topics::STOPS);
    Ok(stops.last().map(|stop| stop.at.as_micros() as f64 * 1.0e-6))
}

/// Whether what is shown is what was decided then.
fn repetition(outcome: &ReplayOutcome, moment: Option<&Snapshot>, language: Language) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let begin = language.fill("Played again from the recorded bytes by floorguard {}", &[version]);
    let until = moment.map_or(Stamp::ZERO, |snapshot| snapshot.at);
    if let Some(reason) = &outcome.unrepeatable {
        let words = "{}, so it was not compared with the recording: causes and times may differ.";
        return format!("{begin}. {}", language.fill(words, &[reason]));
    }
    let difference = match &outcome.order {
        Some(order) => order.first_difference.as_ref().map(|difference| difference.at),
        None => outcome.first_difference,
    };
    match difference.filter(|at| *at <= until) {
        Some(at) => {
            let from = language.number(at.as_micros() as f64 * 1.0e-6, 3);
            let words = "This version decides otherwise from {} s on, so what is shown may not be what was decided then.";
            format!("{begin}. {}", language.fill(words, &[&from]))
        }
        None => {
            let words = "up to this moment every compared decision is the recorded one, to the bit.";
            format!("{begin}; {}", language.say(words))
        }
    }
}

/// A moment of a recording, seconds of the robot's clock: not before 0.
///
/// # Errors
/// Anything else, in words.
fn moment_s(text: &str) -> Result<f64, String> {
    let some = text.parse::<f64>().ok().filter(|seconds| *seconds >= 0.0 && *seconds < 1.0e9);
    some.ok_or_else(|| "give seconds of the robot's clock, not before 0".to_owned())
}
