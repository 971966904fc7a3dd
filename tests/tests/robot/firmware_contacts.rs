//! Worlds that hurt on the emulated Cortex-M7: the board receives the input of the host's robot and must answer with the same
//! fingerprint; the host's run is judged by true geometry.
//!
//! `cargo xtask campaign firmware-contacts` builds the firmware and says where it is.

use std::path::Path;

use floorguard_laboratory::campaign::{ContactSummary, taped_contact_trial};
use floorguard_tests::campaign::{Slice, report};
use floorguard_tests::worst::Emulator;

/// The robot's state is large, and moved by value when a run begins.
const STACK_BYTES: usize = 64 << 20;
/// Capacity for a tape in the board's memory.
const TAPE_BYTES_MAX: usize = (16 << 20) - (128 << 10);
/// As much of a trial as the board's memory holds, seconds.
const SECONDS: u64 = 15;

fn run(slice: &Slice, emulator: &Emulator) {
    let (mut rows, mut by_hand, mut differences) = (Vec::new(), 0, Vec::new());
    for trial in slice.trials.clone() {
        let taped = taped_contact_trial(slice.seed, trial, SECONDS).expect("the run");
        let Some(taped) = taped else {
            by_hand += 1;
            continue;
        };
        assert!(taped.tape.len() < TAPE_BYTES_MAX, "the tape of trial {trial} is too long for the board");
        match emulator.digest(&taped.tape) {
            Ok(digest) if digest == taped.row.digest => {}
            other => {
                differences.push(format!(
                    "host {}, board {other:?}\n  {}",
                    taped.row.digest,
                    taped.row.command()
                ));
            }
        }
        rows.push(taped.row);
    }
    assert!(differences.is_empty(), "{}", differences.join("\n"));
    let sum = ContactSummary::of(&rows);
    report(&[
        ("runs with the host's fingerprint", sum.trials),
        ("driven by hand, not on a tape", by_hand),
        ("stops", sum.stops),
        ("contacts of the moving robot", u64::from(sum.counts.while_moving())),
        ("of these, seen in time by a sensor", u64::from(sum.counts.avoidable_by_sensors)),
        ("missed stops", sum.missed_stops),
    ]);
}

#[test]
fn emulated_board_matches_host_among_hazards() {
    let Some(image) = std::env::var_os("FLOORGUARD_TAPE_IMAGE") else {
        println!("skipped: no firmware; cargo xtask campaign firmware-contacts builds it");
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
