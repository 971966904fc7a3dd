//! Breaks the firmware on purpose, one fault per start, and sees it stop the drives, die, come back and tell why.

use std::path::Path;
use std::time::Duration;

use anyhow::Context;
use floorguard_hosted::world::{Plan, Tape};

use super::board::Board;
use super::play::{World, greet, newest_report};
use super::report::Report;

/// A fault, and what must come of it.
#[derive(Clone, Copy, Debug)]
struct Fault {
    number: u32,
    name: &'static str,
    /// Cause in the black box; `None`: the machine must live on.
    cause: Option<u32>,
    /// From the fault to the stop of the drives, milliseconds of the board's time.
    bound_ms: u32,
}

const PANIC: u32 = 1;
const FAULT: u32 = 2;
const WATCHDOG: u32 = 3;
/// The board breaks what it is to break at this time.
const AT_MS: u32 = 2_000;
/// Watchdog and the pause between two feedings.
const WATCHDOG_BOUND_MS: u32 = 130;

const FAULTS: [Fault; 7] = [
    Fault { number: 1, name: "panic in perception", cause: Some(PANIC), bound_ms: 20 },
    Fault { number: 2, name: "stack overflow", cause: Some(FAULT), bound_ms: 20 },
    Fault { number: 3, name: "read of an empty address", cause: Some(FAULT), bound_ms: 20 },
    Fault { number: 4, name: "guard task stalls", cause: Some(WATCHDOG), bound_ms: WATCHDOG_BOUND_MS },
    Fault { number: 5, name: "perception stalls, its queue fills", cause: None, bound_ms: 0 },
    Fault { number: 6, name: "watchdog starves", cause: Some(WATCHDOG), bound_ms: WATCHDOG_BOUND_MS },
    Fault { number: 7, name: "interrupt storm", cause: Some(WATCHDOG), bound_ms: WATCHDOG_BOUND_MS },
];

/// Breaks each in turn and prints a line for each; false when one of them did not end as it should.
///
/// # Errors
/// The emulator cannot be run.
pub fn run_faults(image: &Path) -> anyhow::Result<bool> {
    let mut good = true;
    for fault in &FAULTS {
        let verdict = run_fault(image, fault).with_context(|| fault.name)?;
        println!("{:36} {}", fault.name, verdict.as_ref().unwrap_or_else(|problem| problem));
        good &= verdict.is_ok();
    }
    Ok(good)
}

/// What came of it, in words, as it should or as it should not.
fn run_fault(image: &Path, fault: &Fault) -> anyhow::Result<Result<String, String>> {
    let plan = Plan::named("crossing", 2, 10_000_000)?;
    let folder = tempfile::tempdir()?;
    let mut board = Board::start(image, &Tape::new(&plan).finish(), fault.number, folder.path())?;
    let mut world = World::new(&plan)?;
    let start = greet(&board)?;
    board.witness.set_read_timeout(Some(Duration::from_secs(4)))?;
    let mut newest = start;
    let lives_until_us = u64::from(AT_MS + 1_000) * 1_000;
    while newest.now_us < lives_until_us {
        // A dead board says nothing.
        let Ok(report) = newest_report(&board) else { break };
        newest = report;
        world.serve(&mut board, &newest, newest.now_us - start.now_us)?;
    }
    world.listen(&mut board, newest.now_us - start.now_us)?;
    if newest.now_us >= lives_until_us {
        return Ok(judge_living(fault, &newest));
    }
    let reborn = greet(&board)?;
    Ok(judge_dead(fault, &reborn, world.stopped_nodes))
}

fn judge_living(fault: &Fault, report: &Report) -> Result<String, String> {
    let told = format!(
        "the guard goes on; {} packets found the queue full, {} mm/s permitted",
        report.queue_lost,
        report.permitted_um_s / 1_000
    );
    if fault.cause.is_none() && report.queue_lost > 0 { Ok(told) } else { Err(format!("WRONG: {told}")) }
}

fn judge_dead(fault: &Fault, reborn: &Report, stopped_nodes: bool) -> Result<String, String> {
    let [cause, detail, uptime_ms, deaths] = reborn.last_words;
    let after_ms = uptime_ms.saturating_sub(AT_MS);
    let told = format!(
        "drives stopped {after_ms} ms later ({} allowed), cause {cause} ({detail:#x}) after the reset",
        fault.bound_ms
    );
    let as_it_should = fault.cause == Some(cause) && deaths == 1 && after_ms <= fault.bound_ms;
    match (as_it_should, stopped_nodes) {
        (true, true) => Ok(told),
        (_, false) => Err(format!("WRONG: nobody stopped the drives; {told}")),
        (false, true) => Err(format!("WRONG: {told}")),
    }
}
