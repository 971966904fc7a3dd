//! The same worlds driven with each lidar, scanner and base: the judge of contacts, which knows nothing of sensors, says the same.

use floorguard_configuration::{
    BRIDGED_EXAMPLE, EXAMPLE, bridged_keys, bridged_scanner_keys, livox_keys, ouster_example, ouster_keys,
};
use floorguard_drivers::ouster::{Beams, DataFormat};
use floorguard_laboratory::plan::Plan;
use floorguard_laboratory::world::{Observer, load_scenario, run_virtual};
use floorguard_runtime::configuration::{RangingModel, ScannerModel};
use floorguard_sim::Scenario;

const RANGING: [RangingModel; 7] = [
    RangingModel::HokuyoUst,
    RangingModel::HokuyoUrg04lx,
    RangingModel::SickTim5xx,
    RangingModel::SickLms1xx,
    RangingModel::RplidarA,
    RangingModel::RplidarS,
    RangingModel::Bridged(BRIDGED_EXAMPLE),
];

/// A closed room with a box of 30 cm before the robot. Its walls are within the range of the weakest scanner, 4 m.
const ROOM: &str = "
title = \"a box in a small room\"
bumpers = true
[route]
speed_mps = 0.8
waypoints_m = [[3.0, 0.0]]
[scene]
wall = [
  { from_m = [-2.0, -1.9], to_m = [4.2, -1.9] },
  { from_m = [-2.0, 1.9], to_m = [4.2, 1.9] },
  { from_m = [-2.0, -1.9], to_m = [-2.0, 1.9] },
  { from_m = [4.2, -1.9], to_m = [4.2, 1.9] },
]
furniture = [
  { kind = \"box\", at_m = [3.4, 0.0], size_m = [0.4, 0.8], from_m = 0.0, height_m = 0.3 },
]
";

/// What holds a robot before something in its scanner's plane.
const SCANNER_HOLDS: &str = "obstacle in the protective field (safety scanner)";

fn hazard(world: &str) -> Scenario {
    let path = format!("{}/../hal-sim/scenarios/hazards/{world}.toml", env!("CARGO_MANIFEST_DIR"));
    load_scenario(path.as_ref()).unwrap()
}

/// How far the robot came, metres, its contacts while it moved, and how long its scanner's protective field held it, seconds.
fn drive_held(scenario: Scenario, duration_s: u64, fit: impl Fn(Plan) -> Plan) -> (f64, u32, f64) {
    let mut plan = fit(Plan::of("same", scenario, 1, duration_s * 1_000_000).unwrap());
    plan.lidar_grain = 4;
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer).unwrap();
    let observation = observer.into_observation();
    println!("ready after {:?} s, held for {:?} s", observation.ready_s, observation.under_cause_s);
    let held_s = observation.under_cause_s.get(SCANNER_HOLDS).copied().unwrap_or(0.0);
    let verdict = observation.verdict;
    (verdict.distance_m, verdict.bodies.counts.while_moving(), held_s)
}

fn drive(scenario: Scenario, duration_s: u64, fit: impl Fn(Plan) -> Plan) -> (f64, u32) {
    let (distance_m, contacts, _) = drive_held(scenario, duration_s, fit);
    (distance_m, contacts)
}

/// A board at 0.7 m, which the lidar alone sees in time.
#[test]
fn every_lidar_stops_before_the_board() {
    let os2 = Beams { format: DataFormat::Legacy, ..Beams::even(64, (11_250, -11_250)) };
    let lidars = [
        ("PandarXT-16", "model = \"pandar-xt16\"".to_owned()),
        ("PandarXT-32", "model = \"pandar-xt32\"".to_owned()),
        ("Ouster OS1-32", ouster_keys(&ouster_example())),
        ("Ouster OS2-64", ouster_keys(&os2)),
        ("bridged", bridged_keys()),
        ("Livox Mid-360", livox_keys()),
    ];
    let (reference_m, contacts) = drive(hazard("board-70"), 9, |plan| plan);
    assert!(reference_m > 2.0 && contacts == 0, "VLP-16: {reference_m} m, {contacts} contacts");
    println!("VLP-16: {reference_m:.3} m");
    for (name, keys) in lidars {
        let (distance_m, contacts) = drive(hazard("board-70"), 9, |plan| plan.with_lidar(&keys).unwrap());
        println!("{name}: {distance_m:.3} m");
        assert!(contacts == 0, "{name}: {contacts} contacts");
        assert!((distance_m - reference_m).abs() < 0.4, "{name}: {distance_m} m, a VLP-16 {reference_m} m");
    }
}

/// A box of 30 cm, which the scanner sees; every wall is within the range of each of them.
#[test]
fn every_scanner_stops_before_the_box() {
    let room = || Scenario::from_toml(ROOM).unwrap();
    let (reference_m, contacts) = drive(room(), 10, |plan| plan);
    println!("S300: {reference_m:.3} m");
    assert!(reference_m > 0.4 && contacts == 0, "S300: {reference_m} m, {contacts} contacts");
    let fine = ScannerModel::MicroScan3 { beams: 2_751 };
    for model in [fine].into_iter().chain(RANGING.map(ScannerModel::Ranging)) {
        // The slow ones have as much longer to come there.
        let duration_s = if model == fine { 10 } else { 18 };
        let (distance_m, contacts, held_s) =
            drive_held(room(), duration_s, |plan| plan.with_scanner(model).unwrap());
        println!("{model:?}: {distance_m:.3} m");
        // Nearer than half a metre some measure nothing: something else holds it then.
        assert!(held_s > 0.5, "{model:?}: the lidar may have stopped it: {held_s} s");
        assert!(contacts == 0, "{model:?}: {contacts} contacts");
        assert!(
            distance_m > 0.4 && distance_m < reference_m + 0.5,
            "{model:?}: {distance_m} m, an S300 {reference_m} m"
        );
    }
}

/// A hall with open ends: a safety scanner warrants that nothing is there, none of the others does, and their robots stand.
#[test]
fn fg_req_085_ranging_scanners_stand_in_open_halls() {
    for model in RANGING {
        let fit = |plan: Plan| plan.with_scanner(ScannerModel::Ranging(model)).unwrap();
        let (distance_m, contacts) = drive(hazard("box-30"), 8, fit);
        println!("{}: {distance_m:.3} m", model.name());
        assert!(contacts == 0 && distance_m < 0.05, "{}: {distance_m} m", model.name());
    }
    let (distance_m, _) = drive(hazard("box-30"), 8, |plan| plan);
    assert!(distance_m > 1.0, "S300: {distance_m} m");
}

/// Bases with their part of `[can]`, and what they carry.
const ROBOTS: [(&str, &str, &str, RangingModel); 4] = [
    ("differential", "left_drive_node = 1\nright_drive_node = 2\n", "ouster", RangingModel::HokuyoUst),
    ("tricycle", NODES, "pandar-xt32", RangingModel::SickTim5xx),
    ("ackermann", NODES, "columns", RangingModel::Bridged(BRIDGED_EXAMPLE)),
    (
        "omnidirectional",
        "front_left_drive_node = 1\nfront_right_drive_node = 2\nrear_left_drive_node = 3\nrear_right_drive_node = 4\n",
        "ouster",
        RangingModel::SickLms1xx,
    ),
];
const NODES: &str = "drive_node = 1\nsteering_node = 2\nleft_encoder_node = 3\nright_encoder_node = 4\n";

/// A file with base, lidar and scanner, as `simulate --robot` reads it.
fn robot_file((kind, nodes, lidar, scanner): (&str, &str, &str, RangingModel)) -> String {
    let steering = if kind == "ackermann" { "steering_max_deg = 40.0\n" } else { "" };
    let lidar = match lidar {
        "ouster" => ouster_keys(&ouster_example()),
        "columns" => bridged_keys(),
        plain => format!("model = \"{plain}\"\n"),
    };
    let imu = match kind {
        "differential" => "[imu]\nmodel = \"vectornav\"\n",
        "ackermann" => "[imu]\nmodel = \"bridged\"\n",
        _ => "[imu]\n",
    };
    let device = match scanner {
        RangingModel::Bridged(shape) => bridged_scanner_keys(&shape),
        asked => format!("model = \"{}\"\nsource = \"tcp:192.168.0.10:2112\"\n", asked.key()),
    };
    let scanner = device + "accept_uncertified_mps = 0.3\n";
    let changes = [
        (NODES, nodes),
        ("\n[limits]\n", &format!("\n[base]\nkind = \"{kind}\"\n{steering}[limits]\n")),
        ("model = \"vlp16\"\n", &lidar),
        ("model = \"s300\"\nsource = \"serial:/dev/ttyUSB0\"\nbaud = 500000\n", &scanner),
        ("[imu]\n", imu),
        ("wheelbase_m = 0.80\n", if kind == "differential" { "" } else { "wheelbase_m = 0.80\n" }),
    ];
    changes.iter().fold(EXAMPLE.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    })
}

/// Each base behind sensors that the example does not have, from its file: all stop before the box.
#[test]
fn every_base_stops_behind_other_sensors() {
    let folder = tempfile::tempdir().unwrap();
    for robot in ROBOTS {
        let file = folder.path().join("robot.toml");
        std::fs::write(&file, robot_file(robot)).unwrap();
        let fit = |plan: Plan| plan.with_robot(&file).unwrap_or_else(|error| panic!("{robot:?}: {error:#}"));
        let (distance_m, contacts) = drive(Scenario::from_toml(ROOM).unwrap(), 18, fit);
        println!("{robot:?}: {distance_m:.3} m");
        assert!(contacts == 0 && (0.4..3.0).contains(&distance_m), "{robot:?}: {distance_m} m, {contacts}");
    }
}
