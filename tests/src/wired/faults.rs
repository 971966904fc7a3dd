//! Breaks the firmware on purpose, one fault per start, and sees it stop the drives and tell why: after its reset where it
//! dies, and of its life where it lives on.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::Context;
use floorguard_laboratory::world::Plan;
use floorguard_operator::telemetry::Tape;

use super::black_box::{ReadOut, read_out};
use super::board::Board;
use super::log;
use super::play::{World, greet, newest_report};
use super::report::Report;

/// A fault, and what must come of it.
#[derive(Clone, Copy, Debug)]
struct Fault {
    number: u32,
    name: &'static str,
    /// How the machine must end; `None`: it must live on.
    restart: Option<&'static str>,
    /// Where it lives on: what the guard must object to.
    cause: &'static str,
    /// From the fault to the stop of the drives, milliseconds of the board's time.
    bound_ms: u32,
    /// What must have happened, so that it was this fault and no other.
    seen: fn(&Report) -> bool,
}

/// The robot drives at the latest at this time of the board, milliseconds; soon after, the board breaks.
const DRIVES_WITHIN_MS: u32 = 30_000;
/// A machine that dies stops the drives itself: 11 characters on the bus.
const DYING_MS: u32 = 20;
/// Watchdog and the pause between two feedings.
const WATCHDOG_MS: u32 = 130;
/// Deadline of a source (`[deadlines]` of robot.toml), two ticks of the guard, and what was in flight.
const COMMAND_LOST_MS: u32 = 200 + 30;
const LIDAR_LOST_MS: u32 = 300 + 30;
/// Datagrams in flight while a FIFO of eight is to overrun.
const FLOOD: u32 = 64;
/// Numbers of the faults that change what the world does.
const ETHERNET_OVERRUN: u32 = 8;
/// Those of [`Which::Few`].
const FEW: [u32; 3] = [2, 4, ETHERNET_OVERRUN];
/// Boards that run at the same time.
const AT_ONCE: usize = 2;
/// Portions of the bus that are read after a death.
const LISTENED: usize = 64;
/// An operator in a hurry.
const RESET_DELAY_US: u64 = 100_000;
/// Silent for this long, the board is asked; for that long, it is given up. Of our time: a dead board has none.
const SILENCE: Duration = Duration::from_millis(300);
const PATIENCE: Duration = Duration::from_secs(60);
/// How long the world watches a board that lives on.
const WATCHED_MS: u32 = 1_000;

const fn dies(number: u32, name: &'static str, restart: &'static str, bound_ms: u32) -> Fault {
    Fault { number, name, restart: Some(restart), cause: "", bound_ms, seen: |_| true }
}

const FAULTS: [Fault; 9] = [
    dies(1, "panic in perception", "panic", DYING_MS),
    dies(2, "stack overflow", "fault", DYING_MS),
    dies(3, "read of an empty address", "fault", DYING_MS),
    dies(4, "guard task stalls", "watchdog", WATCHDOG_MS),
    Fault {
        number: 5,
        name: "perception task stalls",
        restart: None,
        cause: "wanted command",
        bound_ms: COMMAND_LOST_MS,
        seen: |report| report.queue_lost > 0,
    },
    dies(6, "watchdog starves", "watchdog", WATCHDOG_MS),
    dies(7, "interrupt storm", "watchdog", WATCHDOG_MS),
    Fault {
        number: ETHERNET_OVERRUN,
        name: "Ethernet FIFO overruns",
        restart: None,
        cause: "lidar",
        bound_ms: LIDAR_LOST_MS,
        seen: |report| report.overruns > 0,
    },
    Fault {
        number: 9,
        name: "perception too slow, queues full",
        restart: None,
        cause: "wanted command",
        bound_ms: COMMAND_LOST_MS,
        seen: |report| report.queue_lost > 0,
    },
];

/// Which faults to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Which {
    /// All of them.
    All,
    /// One of each way to end: a fault of the processor, the watchdog, a life that goes on.
    Few,
}

/// Breaks each in turn and prints a line for each; false when one of them did not end as it should. `program` is
/// `floorguard`, which reads the black box.
///
/// # Errors
/// The emulator cannot be run.
pub fn run_faults(image: &Path, program: &Path, which: Which) -> anyhow::Result<bool> {
    let mut good = true;
    let chosen: Vec<&Fault> =
        FAULTS.iter().filter(|fault| which == Which::All || FEW.contains(&fault.number)).collect();
    for pair in chosen.chunks(AT_ONCE) {
        let verdicts = std::thread::scope(|scope| {
            let runs = pair.iter().map(|fault| scope.spawn(move || run_fault(image, program, fault)));
            let runs: Vec<_> = runs.collect();
            runs.into_iter().map(|run| run.join().expect("the run ends")).collect::<Vec<_>>()
        });
        for (fault, verdict) in pair.iter().zip(verdicts) {
            let verdict = verdict.context(fault.name)?;
            println!("{:34} {}", fault.name, verdict.as_ref().unwrap_or_else(|problem| problem));
            good &= verdict.is_ok();
        }
    }
    Ok(good)
}

/// What came of it, in words, as it should or as it should not.
fn run_fault(image: &Path, program: &Path, fault: &Fault) -> anyhow::Result<Result<String, String>> {
    let plan = Plan::named("crossing", 2, 10_000_000)?;
    let folder = tempfile::tempdir()?;
    let mut board =
        Board::start(image, &Tape::new(&plan.robot, plan.duration_us).finish(), fault.number, folder.path())?;
    let mut world = World::new(&plan)?;
    world.reset_delay_us = RESET_DELAY_US;
    let start = greet(&board)?;
    board.bench.set_read_timeout(Some(SILENCE))?;
    let (mut newest, mut stopped_ms) = (start, None);
    let mut heard = Instant::now();
    let reborn = loop {
        // A dead board says nothing, and one that was reset waits for a hello; a slow one is merely slow. Which of them
        // it is, it tells by the number of its deaths.
        let Ok(report) = newest_report(&board) else {
            anyhow::ensure!(heard.elapsed() < PATIENCE, "the board has fallen silent: {newest:?}");
            board.bench.send(b"H")?;
            continue;
        };
        heard = Instant::now();
        let [.., deaths] = report.crash_record;
        if deaths > 0 {
            break Some(report);
        }
        newest = report;
        let drove = world.ordered_to_stand_us.is_none();
        world.serve(&mut board, &newest, newest.now_us - start.now_us)?;
        let now_ms = (newest.now_us / 1_000) as u32;
        if newest.planned_ms == 0 || now_ms < newest.planned_ms {
            anyhow::ensure!(now_ms < DRIVES_WITHIN_MS, "the robot does not drive: {newest:?}");
            continue;
        }
        if fault.number == ETHERNET_OVERRUN {
            world.window = FLOOD;
        }
        // From the fault on, the first stop counts: what comes back, may drive again.
        let after_ms = now_ms - newest.planned_ms;
        if stopped_ms.is_none() && world.ordered_to_stand_us.is_some() {
            anyhow::ensure!(drove, "the robot stood when the fault came: {newest:?}");
            stopped_ms = Some(after_ms);
        }
        if after_ms > WATCHED_MS {
            break None;
        }
    };
    let Some(reborn) = reborn else {
        let read = read_out(program, &board.black_box)?;
        return Ok(judge_living(fault, &newest, stopped_ms, &read));
    };
    // It may have died long after its last report, and its crash record may stand behind much else.
    for _ in 0..LISTENED {
        world.listen(&mut board, newest.now_us - start.now_us)?;
    }
    let read = read_out(program, &board.black_box)?;
    let reported = log::read(image, &board.log)?;
    let logged = reported.iter().any(|message| message.text.contains("death {}"));
    Ok(judge_dead(fault, (&newest, &reborn), &read, world.stopped_nodes).and_then(|good| {
        if logged { Ok(good) } else { Err(format!("WRONG: the log tells of no death; {good}")) }
    }))
}

fn judge_living(
    fault: &Fault,
    report: &Report,
    stopped_ms: Option<u32>,
    read: &ReadOut,
) -> Result<String, String> {
    let objected = |cause: &Option<String>| cause.as_deref().is_some_and(|cause| cause == fault.cause);
    let boxed = read.since.iter().any(objected);
    let reported = format!(
        "drives stopped {} ms later ({} allowed), {:?} in the black box: {boxed}; {} packets late, FIFO full {} times",
        stopped_ms.map_or_else(|| "never".to_owned(), |ms| ms.to_string()),
        fault.bound_ms,
        fault.cause,
        report.queue_lost,
        report.overruns,
    );
    let in_time = stopped_ms.is_some_and(|ms| ms <= fault.bound_ms);
    let as_it_should = fault.restart.is_none() && in_time && boxed && read.whole && (fault.seen)(report);
    if as_it_should { Ok(reported) } else { Err(format!("WRONG: {reported}")) }
}

fn judge_dead(
    fault: &Fault,
    (newest, reborn): (&Report, &Report),
    read: &ReadOut,
    stopped_nodes: bool,
) -> Result<String, String> {
    let [_, detail, uptime_ms, deaths] = reborn.crash_record;
    let after_ms = uptime_ms.saturating_sub(newest.planned_ms);
    let restart = read.restart.as_deref().unwrap_or("nothing");
    let reported = format!(
        "drives stopped {after_ms} ms later ({} allowed), reset; black box: {} moments before it, {restart} ({detail:#x})",
        fault.bound_ms,
        read.before.len(),
    );
    // An entry every 10 ms, but for what the read-out leaves out.
    let moments = read.before.len() > newest.planned_ms as usize / 20;
    let named = fault.restart.is_some_and(|wanted| restart.starts_with(wanted));
    let as_it_should = named && moments && read.whole && deaths == 1 && after_ms <= fault.bound_ms;
    match (as_it_should, stopped_nodes) {
        (true, true) => Ok(reported),
        (_, false) => Err(format!("WRONG: nobody stopped the drives; {reported}")),
        (false, true) => Err(format!("WRONG: {reported}")),
    }
}
