//! The faults of the matrix on the emulated Cortex-M7: the board is told what the host's robot was told, faults and all,
//! and must answer with the same fingerprint; the host's run is judged by the simulator's truth.
//!
//! `cargo xtask campaign firmware-faults` builds the firmware and says where it is.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_hosted::campaign::{Cell, cells, name, taped_fault_trial};
use floorguard_tests::campaign::{Slice, report};
use floorguard_tests::worst::Emulator;

/// The robot's state is large, and moved by value when a run begins.
const STACK_BYTES: usize = 64 << 20;
/// Room for a tape in the board's memory.
const TAPE_BYTES_MAX: usize = (16 << 20) - (128 << 10);

/// Trials that once differed, by seed and number: a sweep put together from wrong packets seems to show 75 people, the
/// board has room for 32, and the host followed them all.
const FINDINGS: [(u64, u64); 1] = [(2, 496)];

fn run(slice: &Slice, emulator: &Emulator) {
    let mut counts = BTreeMap::<Cell, u64>::new();
    let (mut stops, mut runs, mut failures) = (0, 0, Vec::new());
    let findings = if slice.trials.start == 0 { &FINDINGS[..] } else { &[] };
    for (seed, trial) in findings.iter().copied().chain(slice.trials.clone().map(|trial| (slice.seed, trial)))
    {
        let Some((cell, outcome, tape)) = taped_fault_trial(seed, trial) else { continue };
        runs += 1;
        *counts.entry(cell).or_default() += 1;
        let Some(verdict) = outcome.verdict.filter(|_| outcome.failure.is_none()) else {
            failures.push(format!("{:?}\n  {}", outcome.failure, outcome.command));
            continue;
        };
        assert!(tape.len() < TAPE_BYTES_MAX, "the tape of {} is too long for the board", outcome.command);
        stops += u64::from(verdict.stops);
        match emulator.digest(&tape) {
            Ok(digest) if digest == verdict.digest => {}
            other => {
                failures.push(format!("host {}, board {other:?}\n  {}", verdict.digest, outcome.command));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    for cell in cells() {
        report(&[(&format!("cell | {}", name(cell)), counts.get(&cell).copied().unwrap_or(0))]);
    }
    report(&[("runs", runs), ("stops", stops)]);
}

#[test]
fn the_emulated_board_answers_every_fault_as_the_host_does() {
    let Some(image) = std::env::var_os("FLOORGUARD_TAPE_IMAGE") else {
        println!("skipped: no firmware; cargo xtask campaign firmware-faults builds it");
        return;
    };
    let slice = Slice::from_environment(2);
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
    let outcome = thread.spawn(move || {
        let folder = tempfile::tempdir().expect("a folder");
        let tape = folder.path().join("input.tape");
        run(&slice, &Emulator { image: Path::new(&image).to_path_buf(), tape });
    });
    if let Err(panic) = outcome.expect("a thread").join() {
        std::panic::resume_unwind(panic);
    }
}
