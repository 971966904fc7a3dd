//! A recording of floorguard: its raw bytes through the same tasks, with the same result to the bit.

use std::io::Read;
use std::time::{Duration, Instant};

use floorguard_guard::GuardState;
use floorguard_runtime::shared::{PeopleReport, RobotStatus, StopRecord};
use floorguard_types::time::Stamp;

use super::super::arguments::ReplayArguments;
use super::super::findings::say_findings;
use super::rows::{FrameRow, print};
use floorguard_host::outcome::{BadInput, VerdictFailed};
use floorguard_host::words::counted;
use floorguard_recording::replay::{ReplayAudience, ReplayOutcome, replay_recording};
use floorguard_recording::{ReadError, Recorded, Recording, describe};

struct Printer {
    json: bool,
    realtime: Option<Instant>,
    sweeps: u64,
    stops: u64,
    identities: std::collections::BTreeSet<u32>,
    failed: std::io::Result<()>,
    /// The robot waited for the start command at some time.
    awaits_start: bool,
    /// It could move at some time.
    was_started: bool,
}

impl ReplayAudience for Printer {
    fn on_people(&mut self, report: &PeopleReport, digest: u64) {
        if let Some(started) = self.realtime {
            let due = Duration::from_micros(report.sweep.stamp.as_micros());
            std::thread::sleep(due.saturating_sub(started.elapsed()));
        }
        self.sweeps += 1;
        self.identities
            .extend(report.people.iter().filter(|track| describe::is_person(track)).map(|it| it.id));
        if self.json && self.failed.is_ok() {
            self.failed = print(&FrameRow::of_report(report, digest));
        }
    }

    fn on_status(&mut self, status: &RobotStatus) {
        let decision = &status.decision;
        self.awaits_start |= decision.state == GuardState::AwaitsStart;
        self.was_started |= decision.speed_limit_mps > 0.0 && !decision.action.stops();
    }

    fn on_stop(&mut self, stop: &StopRecord) {
        self.stops += 1;
        if !self.json {
            say!("{:8.1} s  {}", stop.stamp.as_micros() as f64 * 1.0e-6, stop.cause);
        }
    }
}

/// Replays it.
///
/// # Errors
/// Bad input, or another result than the recorded one.
pub fn run<R: Read>(
    first: Recorded,
    recording: &mut Recording<R>,
    (name, arguments): (&str, &ReplayArguments),
) -> anyhow::Result<()> {
    let started = Instant::now();
    let mut printer = Printer {
        json: arguments.json,
        realtime: arguments.realtime.then_some(started),
        sweeps: 0,
        stops: 0,
        identities: std::collections::BTreeSet::new(),
        failed: Ok(()),
        awaits_start: false,
        was_started: false,
    };
    let outcome = replay_recording(first, recording, &mut printer)
        .map_err(|error| BadInput(format!("{name}: {error}")))?;
    printer.failed?;
    say!(
        "{:.1} s of robot time in {:.1} s: {}, {} in all, {}",
        outcome.played_us as f64 * 1.0e-6,
        started.elapsed().as_secs_f64(),
        counted(printer.sweeps, "sweep"),
        counted(printer.identities.len() as u64, "person"),
        counted(printer.stops, "stop"),
    );
    say_findings(outcome.findings.as_deref());
    if printer.awaits_start && !printer.was_started {
        say!(
            "the recording holds no start command, and the robot of this version waits for one: it stands all the time. A \
             recording made before it did cannot be repeated to the bit"
        );
    }
    if let Some(learned) = &outcome.learned {
        say!("learned: {}", learned.words());
    }
    if arguments.check {
        must_be_compared(name, &outcome)?;
    }
    match outcome.order {
        Some(_) => order_verdict(name, outcome),
        None => verdict(name, outcome),
    }
}

/// A check that compares nothing has not succeeded.
fn must_be_compared(name: &str, outcome: &ReplayOutcome) -> anyhow::Result<()> {
    let missing = match (&outcome.unrepeatable, &outcome.order) {
        (Some(reason), _) => Some(format!("{reason}, so nothing could be compared")),
        (None, Some(order)) if order.polls == 0 => Some("it holds nothing to compare with".to_owned()),
        (None, Some(order)) => order.ends_at.map(|at| {
            format!(
                "only the run up to {:.3} s could be compared: the recorder missed rows there",
                seconds(at)
            )
        }),
        (None, None) => (outcome.compared == 0 && outcome.recorded_digest.is_none())
            .then(|| "the recording names no fingerprint to compare with".to_owned()),
    };
    match missing {
        Some(what) if outcome.is_identical() => Err(VerdictFailed(format!("{name}: {what}")).into()),
        _ => Ok(()),
    }
}

fn seconds(at: Stamp) -> f64 {
    at.as_micros() as f64 * 1.0e-6
}

/// Of a run in real time: what was decided then, and where today's code decides otherwise.
fn order_verdict(name: &str, outcome: ReplayOutcome) -> anyhow::Result<()> {
    let order = outcome.order.unwrap_or_default();
    if let Some(at) = order.ends_at {
        say!("the recorder missed rows at {:.3} s: what came after it is not compared", seconds(at));
    }
    if let Some(difference) = &order.first_difference {
        let what = format!(
            "{name}: today's code decides otherwise; the first difference is at {:.6} s, task {}\n  then:  {}\n  today: {}",
            seconds(difference.at),
            difference.task,
            difference.then,
            difference.today
        );
        return Err(VerdictFailed(what).into());
    }
    say!(
        "{} and {} on the bus as recorded, to the bit, in {}",
        counted(order.decisions, "decision"),
        counted(order.frames, "frame"),
        counted(order.polls, "step"),
    );
    outcome.ended.map_or(Ok(()), |error| Err(BadInput(format!("{name}: {error}")).into()))
}

fn verdict(name: &str, outcome: ReplayOutcome) -> anyhow::Result<()> {
    let digest = outcome.digest;
    // What cannot be read is no other behaviour of the robot.
    if let Some(error @ ReadError::Broken { .. }) = &outcome.ended {
        say!(
            "digest {digest:016x} at the damaged place, after {} moments that were as recorded",
            outcome.compared
        );
        return Err(BadInput(format!("{name}: {error}")).into());
    }
    if !outcome.is_identical() {
        let place = outcome.first_difference.map_or_else(
            || "at its end".to_owned(),
            |at| format!("within the second before {:.1} s", at.as_micros() as f64 * 1.0e-6),
        );
        let what =
            format!("{name}: digest {digest:016x} is not the recorded one; the first difference is {place}");
        return Err(VerdictFailed(what).into());
    }
    let seconds = outcome.compared;
    match outcome.ended {
        Some(error) => {
            say!("digest {digest:016x}, as recorded at {seconds} moments before the cut");
            Err(BadInput(format!("{name}: {error}")).into())
        }
        None if let Some(reason) = &outcome.unrepeatable => {
            say!("digest {digest:016x}; {reason}, so it cannot be compared with the recording");
            Ok(())
        }
        None if outcome.recorded_digest.is_some() => {
            say!("digest {digest:016x}, as recorded, and at {seconds} moments of the run");
            Ok(())
        }
        None => {
            say!("digest {digest:016x}; the recording was not closed and names none");
            Ok(())
        }
    }
}
