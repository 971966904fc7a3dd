//! The same robot over what a real one has: UDP on the loopback, pseudo-terminals, an SLCAN adapter, two threads.

use floorguard_laboratory::world::record_plan_in_real_time;
use std::fs::File;
use std::io::BufReader;

use floorguard_configuration::{ActuatedLidarConfiguration, EXAMPLE, parse};
use floorguard_laboratory::world::{CarrierFigures, Observer, Plan, run_real_recorded, run_virtual};
use floorguard_operator::telemetry::RunSinks;
use floorguard_recording::replay::{ReplayAudience, ReplayOutcome, replay_recording};
use floorguard_recording::{RawStream, Recording, topics};
use floorguard_runtime::shared::PeopleReport;
use floorguard_types::geometry::{Point2, Point3};

const DURATION_US: u64 = 10_000_000;

/// Nothing repeats bit for bit in real time; what counts is the same: nobody hurt, no stop missed, the robot drives and
/// sees people. A busy machine may make it stop for a late sensor, so distances are only bounded from below.
#[test]
fn real_carriers_give_the_verdict_of_virtual_time() {
    let mut plan = Plan::named("crossing", 2, DURATION_US).unwrap();
    plan.actuated_lidar = Some(actuated_lidar());
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer).unwrap();
    let virtual_time = observer.into_observation();
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.mcap");
    let mut sinks = RunSinks::default();
    record_plan_in_real_time(&mut sinks, &plan, &file).unwrap();
    let figures = run_real_recorded((&plan, None), &mut observer, &mut sinks).unwrap();
    let real_time = observer.into_observation();
    println!("{figures:?} {:?}", real_time.verdict);
    assert!(virtual_time.verdict.passed && real_time.verdict.passed, "{:?}", real_time.verdict);
    assert!(real_time.ready_s.is_some(), "never ready: {:?}", real_time.under_cause_s);
    assert!(real_time.verdict.distance_m > 1.0, "{:?}", real_time.under_cause_s);
    assert!(real_time.verdict.mota.is_some_and(|mota| mota > 0.5), "{:?}", real_time.verdict);
    the_window_shows_the_scene(&plan, &figures);
    everything_is_recorded(&file);
    let (outcome, sweeps) = replay(&file);
    // Threads in real time do not repeat; the recording keeps their order, and every decision comes back to the bit.
    let order = outcome.order.as_ref().expect("a run in real time keeps its order");
    assert!(
        order.decisions > 5_000 && order.first_difference.is_none() && order.ends_at.is_none(),
        "{outcome:?}"
    );
    assert!(sweeps > 80, "{sweeps} sweeps");
    assert_eq!((outcome.digest, sweeps), (replay(&file).0.digest, sweeps));
}

/// A UST-10LX over TCP on a motor that turns by ±60° in two seconds.
fn actuated_lidar() -> ActuatedLidarConfiguration {
    let section = "[actuated_lidar]\nmodel = \"ust-10lx\"\nsource = \"tcp:192.168.0.10:10940\"\n\
        motor_source = \"socketcan:can1\"\nwindow_deg = 60\nspeed_radps = 1.0\nheight_m = 0.57\ncell_m = 0.1\n\
        people_source = \"udp:127.0.0.1:7300\"\n";
    let read = parse("robot.toml", &format!("{EXAMPLE}\n{section}")).unwrap();
    read.carriers.actuated_lidar.unwrap()
}

/// Both wires were asked and understood while the robot drove: the surfaces of the window are those of the scene. People who are
/// not in the boxes of a picture, because they are far or hidden in part, stay among them.
fn the_window_shows_the_scene(plan: &Plan, figures: &CarrierFigures) {
    let window = figures.window.as_ref().expect("a window");
    assert!(window.faults.is_empty() && window.scans > 100, "{}", window.words());
    assert!(window.free_m2 > 1.0 && window.cells > 100, "{}", window.words());
    let (scene, start) = (plan.scenario.scene.build(), plan.odometry_in_world());
    let above: Vec<Point3> = figures.surfaces.iter().copied().filter(|point| point.z_m > 0.15).collect();
    let near = above.iter().filter(|point| {
        let place = start.transform(Point2::new(point.x_m, point.y_m));
        scene.nearest_obstacle(place).is_some_and(|(_, gap_m)| gap_m < 0.2)
    });
    let near = near.count();
    assert!(above.len() > 100 && near * 10 >= above.len() * 9, "{near} of {}", above.len());
}

/// Every line has its bytes, and what the robot made of them stands beside it.
fn everything_is_recorded(file: &std::path::Path) {
    let mut recording = Recording::new(BufReader::new(File::open(file).unwrap()));
    let mut counts = std::collections::BTreeMap::<String, u32>::new();
    for message in recording.by_ref() {
        *counts.entry(message.unwrap().topic.to_string()).or_default() += 1;
    }
    let least = [
        (RawStream::Lidar.topic(), 6_000),
        (RawStream::Scanner.topic(), 200),
        (RawStream::Imu.topic(), 500),
        (RawStream::CanReceived.topic(), 1_000),
        (RawStream::CanSent.topic(), 100),
        (topics::SCAN, 180),
        (topics::PEOPLE, 80),
        (topics::ODOMETRY, 200),
        (topics::PERMITTED, 80),
        (topics::CLOUD, 15),
    ];
    for (topic, least) in least {
        assert!(counts.get(topic).is_some_and(|count| *count >= least), "{topic}: {counts:?}");
    }
}

#[derive(Default)]
struct Sweeps(u32);

impl ReplayAudience for Sweeps {
    fn on_people(&mut self, _report: &PeopleReport, _digest: u64) {
        self.0 += 1;
    }
}

fn replay(file: &std::path::Path) -> (ReplayOutcome, u32) {
    let mut recording = Recording::new(BufReader::new(File::open(file).unwrap()));
    let first = recording.next().unwrap().unwrap();
    let mut sweeps = Sweeps::default();
    (replay_recording(first, &mut recording, &mut sweeps).unwrap(), sweeps.0)
}
