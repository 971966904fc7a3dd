//! Twenty classes of faults × every source × every phase of a mission, against the whole robot in virtual time.
//! `cargo xtask campaign faults` runs as many as one likes and prints which cells of the matrix were covered.

use std::collections::BTreeMap;

use floorguard_laboratory::campaign::{Cell, cells, fault_trial, name};
use floorguard_tests::campaign::{Slice, report};

/// The robot's state is large, and moved by value when a run begins.
const STACK_BYTES: usize = 64 << 20;

fn run(slice: &Slice) {
    let mut counts: BTreeMap<Cell, u64> = cells().into_iter().map(|cell| (cell, 0)).collect();
    let (mut stops, mut failures) = (0, Vec::new());
    for trial in slice.trials.clone() {
        let (cell, outcome) = fault_trial(slice.seed, trial);
        *counts.entry(cell).or_default() += 1;
        stops += outcome.verdict.map_or(0, |verdict| u64::from(verdict.stops));
        if let Some(failure) = outcome.failure {
            failures.push(format!("{failure}\n  {}", outcome.command));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    for (cell, count) in counts {
        report(&[(&format!("cell | {}", name(cell)), count)]);
    }
    report(&[("runs", slice.trials.end - slice.trials.start), ("stops", stops)]);
}

#[test]
fn no_matrix_fault_misses_a_stop() {
    let slice = Slice::from_environment(12);
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
    let outcome = thread.spawn(move || run(&slice)).expect("a thread").join();
    if let Err(panic) = outcome {
        std::panic::resume_unwind(panic);
    }
}
