//! A robot that carries a microScan3 in place of the S300: its driver against the simulator's scanner, whose bytes were
//! written from the description of the format alone, and the whole robot on it.

use floorguard_laboratory::world::record_plan;
use std::fs::File;
use std::io::BufReader;

use crate::sim_support::{bytes_of, mean_and_deviation, room, wall_range_m};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_drivers::microscan3::{Configuration, Event, Receiver};
use floorguard_guard::{Health, Source};
use floorguard_host::executor::{TaskSet, use_virtual_clock};
use floorguard_laboratory::world::{Observation, Observer, Plan, run_recorded, run_virtual};
use floorguard_operator::telemetry::RunSinks;
use floorguard_recording::Recording;
use floorguard_recording::replay::{ReplayAudience, replay_recording};
use floorguard_robot::assembly::new_shared;
use floorguard_runtime::configuration::ScannerModel;
use floorguard_runtime::io::{DatagramReceiver, Received};
use floorguard_runtime::shared::PeopleReport;
use floorguard_runtime::tasks::scanner_datagrams;
use floorguard_sim::FaultSpec;
use floorguard_sim::robot::{RobotParameters, ScannerDevice};
use floorguard_sim::sensors::ScannerState;
use floorguard_sim::{Simulation, Stream};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

const START: Pose2 = Pose2 { x_m: 0.7, y_m: -0.4, heading_rad: 0.5 };
/// The scanner's place on the robot, metres forward.
const MOUNT_M: f32 = 0.90;
/// The simulator's noise.
const NOISE_M: f64 = 0.012;
/// From the middle beam, in the middle of the 30.6 ms that 275° take, to the beginning of a cycle.
const MIDDLE_US: u64 = 15_278;

#[derive(Default)]
struct Reported {
    scans: Vec<(u64, Scan)>,
    stand_by: usize,
    refused: usize,
}

fn simulation(beams: u16) -> Simulation {
    let scanner_device = ScannerDevice::MicroScan3(beams);
    let parameters = RobotParameters { scanner_device, ..RobotParameters::default() };
    Simulation::with_robot(&room(START), 1, parameters).unwrap()
}

fn listen(simulation: &mut Simulation, receiver: &mut Receiver, until_us: u64) -> Reported {
    let mut reported = Reported::default();
    simulation.advance_to(until_us, &mut |event| {
        let Some(bytes) = bytes_of(&event, Stream::ScannerData) else { return };
        receiver.push(bytes, Stamp::from_micros(event.at_us), |heard| match heard {
            Event::Scan(scan) => reported.scans.push((event.at_us, scan.clone())),
            Event::StandBy { .. } => reported.stand_by += 1,
            Event::Refused(_) => reported.refused += 1,
        });
    });
    reported
}

/// Every beam of a standing robot is the wall, at both resolutions of the family; bearings by the device's own frame, in
/// which straight ahead is 90° and the first beam lies at -47.5°.
#[test]
fn standing_robot_beams_meet_the_wall() {
    for beams in [2_751, 1_651] {
        let mut receiver = Receiver::new(Configuration::default());
        let reported = listen(&mut simulation(beams), &mut receiver, 1_000_000);
        assert!((24..=25).contains(&reported.scans.len()), "{}", reported.scans.len());
        assert_eq!((reported.refused, receiver.counters().lost_scans), (0, 0));
        let sensor = START.transform(Point2::new(MOUNT_M, 0.0));
        let mut errors = Vec::new();
        for (_, scan) in &reported.scans {
            assert_eq!(scan.beams.len(), usize::from(beams));
            for (index, beam) in scan.beams.iter().enumerate() {
                let polar_deg = -47.5 + 275.0 / f64::from(beams - 1) * index as f64;
                let bearing = f64::from(START.heading_rad) + (polar_deg - 90.0).to_radians();
                let BeamReturn::Hit(range_mm) = beam else { panic!("beam {index}: {beam:?}") };
                errors.push(f64::from(*range_mm) * 1.0e-3 - wall_range_m(sensor, bearing));
            }
        }
        let (mean, deviation) = mean_and_deviation(&errors);
        assert!(mean.abs() < 0.001, "{mean} m");
        assert!((0.95..1.05).contains(&(deviation / NOISE_M)), "{deviation} m");
    }
}

/// A scan may be taken for a little older than it is, never for younger.
#[test]
fn stamps_are_the_middle_of_the_scan() {
    let reported = listen(&mut simulation(2_751), &mut Receiver::new(Configuration::default()), 2_000_000);
    for (number, (_, scan)) in (0_u64..).zip(&reported.scans) {
        let (stamp_us, middle_us) = (scan.stamp.as_micros(), number * 40_000 + MIDDLE_US);
        assert!(stamp_us <= middle_us + 100, "{number}: {stamp_us} is younger than {middle_us}");
        assert!(stamp_us + 5_000 >= middle_us, "{number}: {stamp_us} is much older than {middle_us}");
    }
}

#[test]
fn what_does_not_measure_gives_no_scan() {
    let (mut simulation, mut receiver) = (simulation(2_751), Receiver::new(Configuration::default()));
    let mut phase = |state, until_us| {
        simulation.set_scanner_state(state);
        let reported = listen(&mut simulation, &mut receiver, until_us);
        (reported.scans.len(), reported.stand_by, reported.refused)
    };
    // A scan that was on its way when the state changed still arrives.
    let measured = phase(ScannerState::Measuring, 1_000_000);
    assert!(matches!(measured, (24..=25, 0, 0)), "{measured:?}");
    let stands_by = phase(ScannerState::StandBy, 2_000_000);
    assert!(matches!(stands_by, (0..=1, 24..=25, 0)), "{stands_by:?}");
    let locked = phase(ScannerState::LockOut, 3_000_000);
    assert!(matches!(locked, (0, 0..=1, 24..=25)), "{locked:?}");
    let again = phase(ScannerState::Measuring, 4_000_000);
    assert!(matches!(again, (24..=25, 0, 0..=1)), "{again:?}");
}

fn plan(scenario: &str, seconds: u64, faults: &[&str]) -> Plan {
    let plan = Plan::named(scenario, 1, seconds * 1_000_000).unwrap();
    let mut plan = plan.with_scanner(ScannerModel::MicroScan3 { beams: 2_751 }).unwrap();
    plan.faults = faults.iter().map(|text| FaultSpec::parse(text).unwrap()).collect();
    plan
}

fn play(plan: &Plan) -> Observation {
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(plan, &mut show);
    run_virtual(plan, &mut observer).unwrap();
    observer.into_observation()
}

/// The datagrams of a scanner that all arrived; then nothing more comes.
struct Arrived(std::collections::VecDeque<Vec<u8>>);

impl DatagramReceiver for Arrived {
    type Error = std::convert::Infallible;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<Received, Self::Error> {
        let Some(datagram) = self.0.pop_front() else { std::future::pending().await };
        buffer[..datagram.len()].copy_from_slice(&datagram);
        Ok(Received { length: datagram.len(), arrival: Stamp::from_micros(200_000) })
    }
}

/// How the guard finds a scanner of which it has heard 200 ms, with one place in the table of blocks emptied.
fn health_without(block: Option<usize>) -> Health {
    let mut datagrams = std::collections::VecDeque::new();
    simulation(2_751).advance_to(200_000, &mut |event| {
        let Some(bytes) = bytes_of(&event, Stream::ScannerData) else { return };
        let mut bytes = bytes.to_vec();
        // Behind the datagram's 24 bytes the first piece begins with the message's header.
        let is_first = bytes[24] == b'V' && bytes[16..20] == [0; 4];
        if let Some(place) = block.filter(|_| is_first) {
            bytes[24 + place..24 + place + 4].fill(0);
        }
        datagrams.push_back(bytes);
    });
    use_virtual_clock(200_000);
    let plan = plan("corridor", 1, &[]);
    let shared = new_shared::<NoopRawMutex>(&plan.robot, Stamp::from_micros(200_000)).unwrap();
    let mut tasks = TaskSet::new();
    let receiver = Receiver::new(Configuration::default());
    tasks.spawn(scanner_datagrams(&*shared, Arrived(datagrams), receiver));
    tasks.poll_until_quiet().unwrap();
    shared.inspect(|guard| guard.health()[Source::Scanner.index()].health)
}

/// It answers, and its data output is set up wrongly: nobody is sent to its cable.
#[test]
fn scanner_with_missing_output_is_faulty() {
    assert_eq!(health_without(None), Health::Healthy);
    for (what, place) in [("angles", 36), ("distances", 40)] {
        assert_eq!(health_without(Some(place)), Health::Faulty, "without {what}");
    }
}

/// It drives on a healthy scanner, and stops for one that is silent or talks nonsense.
#[test]
fn robot_needs_the_scanner_to_drive() {
    let seen = play(&plan("corridor", 7, &[]));
    assert!(seen.verdict.passed && seen.verdict.distance_m > 1.5, "{:?}", seen.verdict);
    let scanner_stops = |fault: &str| {
        let seen = play(&plan("corridor", 7, &[fault]));
        assert_eq!((seen.verdict.missed_stops, seen.verdict.avoidable_contacts), (0, 0), "{fault}");
        seen.stops.iter().filter(|stop| stop.kind == "safety scanner").count()
    };
    assert_eq!(scanner_stops("scanner:delay=1ms,from=4s,to=6s"), 0, "a network that is a little slow");
    for fault in ["silent", "drop=40%", "stranger"] {
        assert_eq!(scanner_stops(&format!("scanner:{fault},from=4s,to=6s")), 1, "{fault}");
    }
}

struct NoAudience;

impl ReplayAudience for NoAudience {
    fn on_people(&mut self, _report: &PeopleReport, _digest: u64) {}
}

/// The raw datagrams in a recording give the same run again, to the bit.
#[test]
fn its_recording_replays_to_the_bit() {
    let plan = plan("crossing", 6, &["scanner:drop=3%,from=2s,to=5s"]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    let mut sinks = RunSinks::default();
    record_plan(&mut sinks, &plan, &path).unwrap();
    run_recorded(&plan, &mut observer, &mut sinks).unwrap();
    let digest = observer.into_observation().verdict.digest;
    let mut recording = Recording::new(BufReader::new(File::open(&path).unwrap()));
    let first = recording.next().unwrap().unwrap();
    let outcome = replay_recording(first, &mut recording, &mut NoAudience).unwrap();
    assert!(outcome.is_identical(), "{outcome:?}");
    assert_eq!(format!("{:016x}", outcome.digest), digest);
}
