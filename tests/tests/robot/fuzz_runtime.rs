//! The whole runtime on the virtual clock under anything: several faults at once, at any place, from the first moment.
//!
//! No panic, no task that spins, no order to the drive beyond its limits, and a robot that can be judged to the end.
//! `cargo xtask campaign fuzz-runtime` runs as many worlds as one likes.

use floorguard_tests::campaign::{Slice, report};
use floorguard_tests::fuzz::worlds;

/// The robot's state is large, and moved by value when a run begins.
const STACK_BYTES: usize = 64 << 20;

fn run(slice: &Slice) {
    let (mut moved, mut stops, mut missed) = (0, 0, 0);
    for number in slice.trials.clone() {
        let played = worlds::world(&mut slice.random(number));
        moved += u64::from(played.moved);
        stops += played.stops;
        missed += played.missed;
    }
    let worlds = slice.trials.end - slice.trials.start;
    report(&[
        ("worlds", worlds),
        ("moved", moved),
        ("stops", stops),
        ("missed under several faults", missed),
    ]);
    assert!(moved > 0 || worlds < 10, "no robot moved: the campaign tests nothing");
}

#[test]
fn any_faults_at_once_leave_the_runtime_running() {
    let slice = Slice::from_environment(16);
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
    if let Err(panic) = thread.spawn(move || run(&slice)).expect("a thread").join() {
        std::panic::resume_unwind(panic);
    }
}
