//! All reachable states of the decision machine, by breadth-first search over abstracted inputs.
//!
//! Abstraction: one cause of each kind of rule, time in steps of 100 ms, self-test passed or not, reset pressed or not.

use std::collections::{BTreeSet, VecDeque};
use std::string::String;
use std::{format, vec};

use crate::*;
use floorguard_types::time::Stamp;

const STEP_US: u64 = 100_000;
/// One of each: limits, holds, latches with power, latches without, never clears.
const CAUSES_USED: [Cause; 4] =
    [Cause::Warning, Cause::ScanProtective, Cause::EmergencyStop, Cause::StateCorrupted];

/// A machine's state without absolute time: what differs only in the clock is the same.
fn key(machine: &DecisionMachine, now: Stamp) -> String {
    format!("{:?}", machine.abstracted(now))
}

#[test]
fn fg_req_005_latched_moves_only_after_reset_and_self_test() {
    let start = Stamp::from_micros(10_000_000);
    let mut seen = BTreeSet::new();
    let mut queue = VecDeque::from(vec![(DecisionMachine::new(start), start, false)]);
    let mut transitions = 0_u32;
    while let Some((machine, now, was_latched)) = queue.pop_front() {
        for input in 0..64_u8 {
            let evidence = CAUSES_USED.iter().enumerate().filter(|(bit, _)| input & (1 << bit) != 0);
            let (reset, fit) = (input & 16 != 0, input & 32 != 0);
            let mut next = machine;
            let then = now.plus_micros(STEP_US);
            let mut worst = Action::None;
            for (_, cause) in evidence {
                next.raise(CauseRecord::new(*cause, then));
                worst = worst.max(cause.action());
            }
            if reset {
                next.request_reset(then);
            }
            let verdict = next.settle(fit, then);
            transitions += 1;
            assert!(verdict.action >= worst, "a hazard is present and less than its action is taken");
            let latched = verdict.state == GuardState::Latched;
            let released = was_latched && !latched;
            assert!(
                !released || (fit && next.resets() > machine.resets()),
                "released without reset and self-test"
            );
            assert!(!latched || verdict.action.stops(), "latched and moving");
            assert_eq!(verdict.primary.is_some(), verdict.action != Action::None);
            if !seen.insert((key(&next, then), latched)) {
                continue;
            }
            queue.push_back((next, then, latched));
        }
        assert!(seen.len() < 200_000, "the state space is not finite");
    }
    assert!(seen.len() > 100, "{} states, {transitions} transitions", seen.len());
    std::println!("{} states, {transitions} transitions", seen.len());
}
