//! The safety scanner's driver against the simulator's scanner, whose bytes were written from the description of the
//! format alone. Ranges are judged by plane geometry of a room.

use crate::sim_support::{DrivenSimulation, bytes_of, mean_and_deviation, room, wall_range_m};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_drivers::s300::{Bit13, Configuration, Counters, Event, Receiver, TelegramError};
use floorguard_guard::{Health, Source};
use floorguard_host::executor::{TaskSet, use_virtual_clock};
use floorguard_laboratory::world::Plan;
use floorguard_robot::assembly::new_shared;
use floorguard_runtime::tasks::scanner_input;
use floorguard_sim::Scenario;
use floorguard_sim::faults::{FaultLayer, FaultSpec};
use floorguard_sim::sensors::ScannerState;
use floorguard_sim::{Simulation, Stream};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

const START: Pose2 = Pose2 { x_m: 0.7, y_m: -0.4, heading_rad: 0.5 };
/// The scanner's place on the robot, metres forward.
const MOUNT_M: f32 = 0.90;
/// The simulator's noise: four uniform numbers, so it ends at two times the square root of three deviations.
const NOISE_M: f64 = 0.012;
const NOISE_END_M: f64 = 0.041_57;
/// Ranges are whole centimetres.
const GRID_M: f64 = 0.005;

#[derive(Clone, Debug, PartialEq)]
enum Reported {
    Scan(Box<Scan>),
    StandBy(u32),
    Refused(TelegramError),
}

type Portion = (u64, Vec<u8>);

fn portions(simulation: &mut Simulation, from_us: u64, to_us: u64, faults: &[&str]) -> Vec<Portion> {
    let specs: Vec<FaultSpec> = faults.iter().map(|text| FaultSpec::parse(text).unwrap()).collect();
    let mut layer = FaultLayer::new(&specs, from_us + 1);
    let mut arrived = Vec::new();
    simulation.advance_to(to_us, &mut |event| {
        layer.pass(event, &mut |event| {
            if let Some(bytes) = bytes_of(&event, Stream::ScannerSerial) {
                arrived.push((event.at_us, bytes.to_vec()));
            }
        });
    });
    arrived
}

fn receive(receiver: &mut Receiver, arrived: &[Portion]) -> Vec<(u64, Reported)> {
    let mut reported = Vec::new();
    for (at_us, bytes) in arrived {
        receiver.push(bytes, Stamp::from_micros(*at_us), |event| {
            let event = match event {
                Event::Scan(scan) => Reported::Scan(Box::new(scan.clone())),
                Event::StandBy { sequence } => Reported::StandBy(sequence),
                Event::Refused(error) => Reported::Refused(error),
            };
            reported.push((*at_us, event));
        });
    }
    reported
}

fn scans(reported: &[(u64, Reported)]) -> Vec<(u64, &Scan)> {
    reported
        .iter()
        .filter_map(
            |(at_us, reported)| {
                if let Reported::Scan(scan) = reported { Some((*at_us, &**scan)) } else { None }
            },
        )
        .collect()
}

fn heard(scenario: &Scenario, seed: u64, seconds: f64, faults: &[&str]) -> (Vec<(u64, Reported)>, Counters) {
    let mut simulation = Simulation::new(scenario, seed).unwrap();
    let arrived = portions(&mut simulation, 0, (seconds * 1.0e6) as u64, faults);
    let mut receiver = Receiver::new(Configuration::default());
    let reported = receive(&mut receiver, &arrived);
    (reported, receiver.counters())
}

/// Bearing of a beam in the scanner's frame: book, SICK S300: Line.
fn beam_rad(beam: usize) -> f64 {
    (-135.0 + 0.5 * beam as f64).to_radians()
}

#[test]
fn standing_robot_beams_meet_the_wall() {
    let (reported, counters) = heard(&room(START), 1, 4.0, &[]);
    let scans = scans(&reported);
    assert!((97..=99).contains(&scans.len()), "{}", scans.len());
    assert_eq!((counters.telegrams as usize, counters.checksum_failures), (scans.len(), 0));
    assert_eq!((counters.lost_scans, counters.repeated_scans), (0, 0));
    let sensor = START.transform(Point2::new(MOUNT_M, 0.0));
    let mut errors = Vec::new();
    for (_, scan) in &scans {
        assert_eq!(scan.beams.len(), 541);
        assert!((f64::from(scan.first_angle_rad) - beam_rad(0)).abs() < 1e-6);
        assert!((f64::from(scan.step_rad) - 0.5_f64.to_radians()).abs() < 1e-8);
        for (index, beam) in scan.beams.iter().enumerate() {
            let range_m = wall_range_m(sensor, f64::from(START.heading_rad) + beam_rad(index));
            let BeamReturn::Hit(range_mm) = beam else { panic!("beam {index}: {beam:?}") };
            errors.push(f64::from(*range_mm) * 1.0e-3 - range_m);
        }
    }
    let worst = errors.iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
    let (mean, deviation) = mean_and_deviation(&errors);
    assert!(worst <= NOISE_END_M + GRID_M, "{worst} m");
    assert!(mean.abs() < 0.001, "{mean} m");
    // Noise and rounding to whole centimetres.
    let sigma = (NOISE_M * NOISE_M + 0.01 * 0.01 / 12.0).sqrt();
    assert!((0.95..1.05).contains(&(deviation / sigma)), "{deviation} m");
}

/// The simulator's mirror passes the middle beam 15 ms after the begin of each cycle of 40 ms. The driver may take a
/// scan for older than it is, by the doubt about the scanner's own delay (book, SICK S300: Line), but not for younger.
#[test]
fn stamps_are_the_middle_of_the_scan() {
    let (reported, _) = heard(&room(START), 2, 4.0, &[]);
    for (number, (at_us, scan)) in (0_u64..).zip(scans(&reported)) {
        let middle_us = number * 40_000 + 15_000;
        let stamp_us = scan.stamp.as_micros();
        assert!(stamp_us <= middle_us && stamp_us + 25_000 >= middle_us, "{number}: {stamp_us} {middle_us}");
        assert!(stamp_us < at_us);
    }
    let stamps: Vec<u64> = scans(&reported).iter().skip(1).map(|(_, scan)| scan.stamp.as_micros()).collect();
    assert!(stamps.windows(2).all(|pair| (pair[1] - pair[0]).abs_diff(40_000) <= 1));
}

/// Straight ahead a reflector, to the left nothing for forty metres, the rest a wall.
fn gallery() -> Scenario {
    Scenario::from_toml(
        r#"
title = "a gallery"
[scene]
wall = [
  { from_m = [4.0, -1.0], to_m = [4.0, 1.0], material = "retro" },
  { from_m = [-3.0, -3.0], to_m = [6.0, -3.0] },
  { from_m = [-3.0, -3.0], to_m = [-3.0, 3.0] },
]
"#,
    )
    .unwrap()
}

/// "No echo" is free up to the range that the configuration vouches for; what bit 13 means is configuration as well.
#[test]
fn flags_and_missing_echoes_are_distinguished() {
    let mut simulation = Simulation::new(&gallery(), 3).unwrap();
    let arrived = portions(&mut simulation, 0, 500_000, &[]);
    for (bit13, reflector_is_hit) in [(Bit13::Reflector, true), (Bit13::Dazzled, false)] {
        let mut receiver = Receiver::new(Configuration { bit13, ..Configuration::default() });
        let reported = receive(&mut receiver, &arrived);
        let scans = scans(&reported);
        assert!(scans.len() >= 10);
        for (_, scan) in scans {
            // 3.05 m from the scanner to the reflector, ±18° wide.
            for beam in &scan.beams[270 - 34..=270 + 34] {
                match beam {
                    BeamReturn::Hit(mm) if reflector_is_hit => assert!((3_000..3_300).contains(mm), "{mm}"),
                    BeamReturn::Unknown if !reflector_is_hit => {}
                    other => panic!("{bit13:?}: {other:?}"),
                }
            }
            // To the left and forward nothing stands.
            for beam in &scan.beams[310..=450] {
                assert_eq!(*beam, BeamReturn::Free(30_000));
            }
            // To the right the wall, 2.95 m.
            assert!(matches!(scan.beams[90], BeamReturn::Hit(2_900..=3_000)), "{:?}", scan.beams[90]);
        }
    }
}

#[test]
fn stand_by_and_lock_out_are_unknown() {
    let mut simulation = Simulation::new(&room(START), 4).unwrap();
    let mut receiver = Receiver::new(Configuration::default());
    let mut phase = |state, to_us| {
        let from_us = to_us - 1_000_000;
        simulation.set_scanner_state(state);
        receive(&mut receiver, &portions(&mut simulation, from_us, to_us, &[]))
    };
    let measuring = phase(ScannerState::Measuring, 1_000_000);
    assert_eq!(scans(&measuring).len(), measuring.len());
    let stand_by = phase(ScannerState::StandBy, 2_000_000);
    // One telegram may have been on the line already.
    assert!(
        stand_by.iter().skip(1).all(|(_, reported)| matches!(reported, Reported::StandBy(_))),
        "{stand_by:?}"
    );
    assert!((24..=26).contains(&stand_by.len()));
    let locked = phase(ScannerState::LockOut, 3_000_000);
    let lock_out = Reported::Refused(TelegramError::LockOut { status: 1 });
    assert!(locked.iter().skip(1).all(|(_, reported)| *reported == lock_out), "{locked:?}");
    let again = phase(ScannerState::Measuring, 4_000_000);
    assert!(again.iter().skip(1).all(|(_, reported)| matches!(reported, Reported::Scan(_))));
    assert!(scans(&again).len() >= 23);
}

/// The line of a scanner whose bytes all arrived; then nothing more comes.
struct Line(std::collections::VecDeque<u8>);

impl embedded_io_async::ErrorType for Line {
    type Error = std::convert::Infallible;
}

impl embedded_io_async::Read for Line {
    async fn read(&mut self, portion: &mut [u8]) -> Result<usize, Self::Error> {
        if self.0.is_empty() {
            std::future::pending::<()>().await;
        }
        Ok(std::io::Read::read(&mut self.0, portion).unwrap_or(0))
    }
}

/// How the guard finds a scanner whose telegrams of the first 200 ms it has heard.
fn health_of(state: ScannerState, configuration: Configuration) -> Health {
    let mut simulation = Simulation::new(&room(START), 4).unwrap();
    simulation.set_scanner_state(state);
    let arrived = portions(&mut simulation, 0, 200_000, &[]);
    let line = Line(arrived.into_iter().flat_map(|(_, bytes)| bytes).collect());
    use_virtual_clock(200_000);
    let plan = Plan::named("corridor", 1, 1).unwrap();
    let shared = new_shared::<NoopRawMutex>(&plan.robot, Stamp::from_micros(200_000)).unwrap();
    let mut tasks = TaskSet::new();
    tasks.spawn(scanner_input(&*shared, line, Receiver::new(configuration)));
    tasks.poll_until_quiet().unwrap();
    shared.inspect(|guard| guard.health()[Source::Scanner.index()].health)
}

/// The stop reason points to the scanner, not to its cable: it answers, and is at fault. (The words for it are tested
/// with the panel.)
#[test]
fn locked_out_scanner_is_faulty_not_absent() {
    for (state, health) in
        [(ScannerState::Measuring, Health::Healthy), (ScannerState::LockOut, Health::Faulty)]
    {
        assert_eq!(health_of(state, Configuration::default()), health, "{state:?}");
    }
}

/// It answers, too, and no cable would help.
#[test]
fn scanner_with_wrong_beams_is_faulty() {
    for (beams, health) in [(540, Health::Faulty), (541, Health::Healthy), (542, Health::Faulty)] {
        let values_per_field = [beams].into_iter().collect();
        let configuration = Configuration { values_per_field, ..Configuration::default() };
        assert_eq!(health_of(ScannerState::Measuring, configuration), health, "{beams} beams");
    }
}

/// Values frozen, checksum right, scan number not advancing.
#[test]
fn a_frozen_scan_number_is_counted_and_shown() {
    let mut simulation = Simulation::new(&room(START), 5).unwrap();
    let arrived = portions(&mut simulation, 0, 300_000, &[]);
    let frozen: Vec<Portion> = (0..20_u64)
        .flat_map(|turn| {
            arrived[..5].iter().map(move |(at_us, bytes)| (at_us + turn * 40_000, bytes.clone()))
        })
        .collect();
    let mut receiver = Receiver::new(Configuration::default());
    let reported = receive(&mut receiver, &frozen);
    let scans = scans(&reported);
    assert_eq!(scans.len(), 20);
    assert_eq!(receiver.counters().repeated_scans, 19);
    assert!(
        scans.iter().all(|(_, scan)| scan.sequence == scans[0].1.sequence),
        "the guard must see it stand still"
    );
}

/// Bit errors, cut and lost portions of a fifth of a telegram: every scan that comes out is right, the missing ones are
/// counted, and a damaged telegram costs at most its neighbour.
#[test]
fn serial_noise_costs_scans_and_never_falsifies_them() {
    let sensor = START.transform(Point2::new(MOUNT_M, 0.0));
    for (fault, per_telegram) in [
        ("scanner:flip=4%", 0.18),
        ("scanner:drop=4%", 0.18),
        ("scanner:truncate=4%", 0.18),
        ("scanner:duplicate=4%", 0.18),
    ] {
        let (reported, counters) = heard(&room(START), 6, 20.0, &[fault]);
        let scans = scans(&reported);
        assert_eq!(scans.len(), reported.len(), "{fault}: nothing else is heard");
        for (_, scan) in &scans {
            for (index, beam) in scan.beams.iter().enumerate() {
                let range_m = wall_range_m(sensor, f64::from(START.heading_rad) + beam_rad(index));
                let BeamReturn::Hit(range_mm) = beam else { panic!("{fault}: {beam:?}") };
                let error_m = f64::from(*range_mm) * 1.0e-3 - range_m;
                assert!(error_m.abs() <= NOISE_END_M + GRID_M, "{fault}: beam {index} wrong by {error_m} m");
            }
        }
        let lost = 498 - scans.len();
        assert!((40..=(2.2 * per_telegram * 498.0) as usize).contains(&lost), "{fault}: {lost} lost");
        assert!(lost.abs_diff(counters.lost_scans as usize) <= 3, "{fault}: {lost}, {counters:?}");
        assert_eq!(counters.repeated_scans, 0, "{fault}");
    }
}

/// The robot drives: with the true pose at the moment of a beam its end lies on the wall. The stamp may be older than
/// the truth by the doubt of the scanner's delay, here 10 ms.
#[test]
fn driving_robot_scans_lie_on_walls() {
    let mut seat = DrivenSimulation::new(&room(Pose2::new(-1.5, 0.5, 0.2)), 7);
    let mut receiver = Receiver::new(Configuration::default());
    let mut reported = Vec::new();
    let mut poses = std::collections::BTreeMap::new();
    for ms in 0..7_000_u64 {
        if ms == 1_000 {
            seat.drive(0.8, 0.6);
        }
        for event in seat.step() {
            if let Some(bytes) = bytes_of(&event, Stream::ScannerSerial) {
                reported.extend(receive(&mut receiver, &[(event.at_us, bytes.to_vec())]));
            }
        }
        poses.insert(seat.now_us(), seat.simulation.truth().robot);
    }
    let mut errors = Vec::new();
    for (_, scan) in scans(&reported).iter().skip(60) {
        // 55.6 µs from beam to beam, the middle one at the stamp; 9.2 ms are this scanner's difference to the default.
        for (index, beam) in scan.beams.iter().enumerate() {
            let at_us = scan.stamp.as_micros() as f64 + 9_200.0 + (index as f64 - 270.0) * 55.556;
            let robot = poses.range(..=at_us as u64).next_back().unwrap().1;
            let sensor = robot.transform(Point2::new(MOUNT_M, 0.0));
            let range_m = wall_range_m(sensor, f64::from(robot.heading_rad) + beam_rad(index));
            let BeamReturn::Hit(range_mm) = beam else { panic!("{beam:?}") };
            errors.push(f64::from(*range_mm) * 1.0e-3 - range_m);
        }
    }
    let (mean, deviation) = mean_and_deviation(&errors);
    assert!(errors.len() > 50_000);
    assert!(mean.abs() < 0.002 && deviation < 0.015, "mean {mean} m, deviation {deviation} m");
}
