//! A recorded run, replayed from its file: the same bits, whole or cut, with faults and with the operator's buttons.

use floorguard_laboratory::world::record_plan;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use floorguard_laboratory::world::{Observer, Plan, run_recorded};
use floorguard_operator::telemetry::RunSinks;
use floorguard_recording::replay::{ReplayAudience, ReplayOutcome, replay_recording};
use floorguard_recording::{ReadError, Recording};
use floorguard_runtime::shared::{PeopleReport, StopRecord};
use floorguard_sim::FaultSpec;
use floorguard_types::geometry::Pose2;

#[derive(Default)]
struct Counter {
    sweeps: usize,
    stops: usize,
}

impl ReplayAudience for Counter {
    fn on_people(&mut self, _report: &PeopleReport, _digest: u64) {
        self.sweeps += 1;
    }

    fn on_stop(&mut self, _stop: &StopRecord) {
        self.stops += 1;
    }
}

fn record(plan: &Plan, path: &Path) -> (String, usize) {
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(plan, &mut show);
    let mut sinks = RunSinks::default();
    record_plan(&mut sinks, plan, path).unwrap();
    run_recorded(plan, &mut observer, &mut sinks).unwrap();
    let seen = observer.into_observation();
    (seen.verdict.digest, seen.stops.len())
}

fn replay(source: impl Read) -> (ReplayOutcome, Counter) {
    let mut recording = Recording::new(source);
    let first = recording.next().unwrap().unwrap();
    let mut counter = Counter::default();
    (replay_recording(first, &mut recording, &mut counter).unwrap(), counter)
}

fn check(plan: &Plan) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (digest, stops) = record(plan, &path);
    let (outcome, counter) = replay(BufReader::new(File::open(&path).unwrap()));
    assert_eq!(format!("{:016x}", outcome.digest), digest);
    assert!(outcome.is_identical() && outcome.ended.is_none(), "{outcome:?}");
    assert!(u64::from(outcome.compared) >= plan.duration_us / 1_000_000, "{outcome:?}");
    assert_eq!(counter.stops, stops);
    assert!(counter.sweeps as u64 >= plan.duration_us / 100_000 - 10, "{}", counter.sweeps);
    // Cut anywhere: identical up to the cut, and the cut is reported.
    let bytes = std::fs::read(&path).unwrap();
    for share in [0.2, 0.613] {
        let cut = (bytes.len() as f64 * share) as usize;
        let (outcome, _) = replay(&bytes[..cut]);
        assert!(outcome.is_identical() && outcome.compared > 0, "{outcome:?}");
        assert!(matches!(outcome.ended, Some(ReadError::Cut { .. })), "{:?}", outcome.ended);
    }
}

#[test]
fn people_crossing_replay_to_the_bit() {
    check(&Plan::named("crossing", 5, 10_000_000).unwrap());
}

#[test]
fn faults_and_buttons_replay_to_the_bit() {
    let mut plan = Plan::named("supermarket", 2, 16_000_000).unwrap();
    plan.faults =
        vec![FaultSpec::parse("lidar:drop=5%").unwrap(), FaultSpec::parse("scanner:drop=1%").unwrap()];
    plan.emergency_stop_us = vec![(4_000_000, 6_000_000)];
    check(&plan);
}

/// What plans a drive to a goal is in the recording, and drives again.
#[test]
fn drive_to_a_goal_replays_to_the_bit() {
    let plan = Plan::named("supermarket", 1, 12_000_000).unwrap();
    check(&plan.navigating(Pose2::new(14.5, 4.5, 1.57)).unwrap());
}

/// Sets the checksum of each chunk to 0: not available (MCAP specification, Chunk).
fn without_checksums(bytes: &mut [u8]) {
    const CHUNK: u8 = 0x06;
    let mut at = 8;
    while let Some(head) = bytes.get(at..at + 9) {
        let (kind, length) = (head[0], u64::from_le_bytes(head[1..].try_into().unwrap()) as usize);
        if kind == CHUNK {
            // Behind the times and the size.
            bytes[at + 9 + 24..at + 9 + 28].fill(0);
        }
        at += 9 + length;
    }
}

/// Another byte anywhere must not pass for the same run.
#[test]
fn a_changed_byte_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    record(&Plan::named("crossing", 5, 4_000_000).unwrap(), &path);
    let mut bytes = std::fs::read(&path).unwrap();
    // A lidar datagram in the middle: its first block begins with FF EE.
    let middle = bytes.len() / 2;
    let block = middle + bytes[middle..].windows(2).position(|pair| pair == [0xFF, 0xEE]).unwrap();
    bytes[block + 4..block + 100].fill(0);
    let (damaged, _) = replay(bytes.as_slice());
    let ended = damaged.ended.as_ref().map(ToString::to_string).unwrap_or_default();
    assert!(ended.contains("checksum"), "{damaged:?}");
    // Without checksums the same bytes are an undamaged recording of another run.
    without_checksums(&mut bytes);
    let (outcome, _) = replay(bytes.as_slice());
    assert!(!outcome.is_identical());
    assert!(outcome.first_difference.is_some(), "{outcome:?}");
}
