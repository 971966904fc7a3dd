//! The same worlds driven by each base: the verdict of the independent judge, and where the robot believes it is, do not depend on the
//! wheels.

use floorguard_configuration::{CommandConfiguration, EXAMPLE};
use floorguard_laboratory::plan::{OutsideProgram, Stretch};
use floorguard_laboratory::world::{Observation, Observer, Plan, load_scenario, run_virtual};
use floorguard_sim::wire::SentVelocity;

const SECOND_US: u64 = 1_000_000;

/// A person stands 5 m ahead in a hall.
const PERSON_AHEAD: &str = "title = \"a person stands ahead\"\n[route]\nspeed_mps = 0.8\nwaypoints_m = [[9.0, 0.0]]\n\
    [scene]\nwall = [{ from_m = [-4.0, -6.0], to_m = [12.0, -6.0] }, { from_m = [12.0, -6.0], to_m = [12.0, 6.0] }]\n\
    [[person]]\nat_m = [5.0, 0.1]\nsees_robot = false\n";

/// A bend to the left and one to the right in the same hall.
const BENDS: &str = "title = \"two bends\"\n[route]\nspeed_mps = 0.6\nwaypoints_m = [[3.0, 1.6], [5.5, 0.6]]\n\
    [scene]\nwall = [{ from_m = [-4.0, -6.0], to_m = [12.0, -6.0] }, { from_m = [12.0, -6.0], to_m = [12.0, 6.0] }]\n";

/// The bases of the book, Odometry: Bases, each with its part of `[base]`, `[can]` and `[robot]`.
const BASES: [&str; 4] = ["tricycle", "differential", "ackermann", "omnidirectional"];

/// The example robot on other wheels.
fn robot(base: &str) -> String {
    let nodes = "drive_node = 1\nsteering_node = 2\nleft_encoder_node = 3\nright_encoder_node = 4\n";
    assert!(EXAMPLE.contains(nodes), "the example's nodes");
    let of = |kind: &str| format!("[base]\nkind = \"{kind}\"\n");
    match base {
        "differential" => EXAMPLE
            .replace("wheelbase_m = 0.80\n", "")
            .replace(nodes, "left_drive_node = 1\nright_drive_node = 2\n")
            .replace("\n[limits]\n", &format!("\n{}[limits]\n", of(base))),
        "ackermann" => {
            EXAMPLE.replace("\n[limits]\n", &format!("\n{}steering_max_deg = 40.0\n[limits]\n", of(base)))
        }
        "omnidirectional" => EXAMPLE
            .replace(
                nodes,
                "front_left_drive_node = 1\nfront_right_drive_node = 2\nrear_left_drive_node = 3\nrear_right_drive_node = 4\n",
            )
            .replace("\n[limits]\n", &format!("\n{}[limits]\n", of(base))),
        _ => EXAMPLE.to_owned(),
    }
}

/// Motor controllers of the book, Motor controllers, each with its part of `[base]`; brakes that grip without power.
const MOTORS: [(&str, &str); 7] = [
    ("odrive", "metres_per_turn = 0.5\nreversed = \"right\"\nbrakes = true\n"),
    ("odrive-omnidirectional", "metres_per_turn = 0.5\nreversed = \"right\"\nbrakes = true\n"),
    ("vesc", "metres_per_turn = 0.05\nreversed = \"none\"\nbrakes = true\npole_pairs = 7\n"),
    (
        "roboteq",
        "metres_per_turn = 0.02\nreversed = \"left\"\nbrakes = true\ncounts_per_turn = 2000\nsource = \"serial:/dev/ttyACM0\"\nbaud = 115200\n",
    ),
    ("roboteq-can", "metres_per_turn = 0.02\nreversed = \"left\"\nbrakes = true\ncounts_per_turn = 2000\n"),
    (
        "roboteq-can-omnidirectional",
        "metres_per_turn = 0.02\nreversed = \"right\"\nbrakes = true\ncounts_per_turn = 2000\n",
    ),
    ("wheel-line", "reversed = \"none\"\nbrakes = true\nsource = \"serial:/dev/ttyACM0\"\nbaud = 115200\n"),
];

/// The example robot with such controllers.
fn with_motors((motors, keys): (&str, &str)) -> String {
    let drives = motors.strip_suffix("-omnidirectional").unwrap_or(motors);
    let base = if motors.contains("omni") { "omnidirectional" } else { "differential" };
    // Beside the gateway an axis of an ODrive has a number that CANopen leaves free.
    let text = robot(base).replace("dirt_sensor_node = 6\n", "");
    let text = if drives == "roboteq-can" {
        // Both wheels of an axle are channels of one controller.
        text.replace("right_drive_node = 2", "right_drive_node = 1")
            .replace("rear_left_drive_node = 3", "rear_left_drive_node = 2")
            .replace("rear_right_drive_node = 4", "rear_right_drive_node = 2")
    } else {
        text.replace("rear_right_drive_node = 4", "rear_right_drive_node = 60")
    };
    let text = text.replace("\n[limits]\n", &format!("\ndrives = \"{drives}\"\n{keys}[limits]\n"));
    let text = if drives == "wheel-line" { text } else { text.replace("ticks_per_m = 20000.0\n", "") };
    if !keys.contains("source") {
        return text;
    }
    let (before, rest) = text.split_once("[can]").expect("a bus");
    format!("{before}[guard]{}", rest.split_once("[guard]").expect("thresholds").1)
}

fn play(base: &str, scenario: &str, seconds: u64) -> Observation {
    watch(plan(base, scenario, seconds))
}

fn plan(base: &str, scenario: &str, seconds: u64) -> Plan {
    let motors = MOTORS.into_iter().find(|(name, _)| *name == base);
    let text = motors.map_or_else(|| robot(base), with_motors);
    let folder = tempfile::tempdir().unwrap();
    let (world, file) = (folder.path().join("scenario.toml"), folder.path().join("robot.toml"));
    std::fs::write(&world, scenario).unwrap();
    std::fs::write(&file, text).unwrap();
    let mut plan = Plan::of(base, load_scenario(&world).unwrap(), 1, seconds * SECOND_US).unwrap();
    plan = plan.with_robot(&file).unwrap_or_else(|error| panic!("{base}: {error:#}"));
    plan.lidar_grain = 12;
    plan
}

fn watch(plan: Plan) -> Observation {
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer).unwrap();
    observer.into_observation()
}

#[test]
fn every_base_stops_for_a_person() {
    let motors = MOTORS.map(|(name, _)| name);
    for base in BASES.into_iter().chain(motors) {
        let seen = play(base, PERSON_AHEAD, 16);
        assert!(seen.verdict.passed, "{base}: {}", seen.verdict.why_not());
        assert_eq!(
            seen.verdict.bodies.counts.while_moving(),
            0,
            "{base}: {:?}",
            seen.verdict.bodies.contacts
        );
        let (went_m, at_end_m) = (seen.path_m(0.0, 15.0), seen.path_m(15.0, 16.0));
        assert!((1.5..4.0).contains(&went_m) && at_end_m < 0.02, "{base}: {went_m} m, then {at_end_m} m");
        assert!(!seen.stops.is_empty(), "{base}: no stop");
    }
}

#[test]
fn every_base_knows_its_bends() {
    let motors = MOTORS.map(|(name, _)| name);
    for base in BASES.into_iter().chain(motors) {
        let seen = play(base, BENDS, 26);
        assert!(seen.verdict.passed, "{base}: {}", seen.verdict.why_not());
        let end = seen.robot_path.last().expect("a path");
        let aside_m = seen.robot_path.iter().fold(0.0_f32, |most_m, pose| most_m.max(pose.y_m));
        // It follows its own reckoning to the last place, which counts as met from half a metre; what the wheels reckon wrongly adds
        // to that.
        let off_m = (end.x_m - 5.5).hypot(end.y_m - 0.6);
        assert!(off_m < 0.8 && (1.0..2.2).contains(&aside_m), "{base}: {end:?}, {aside_m} m aside");
    }
}

/// A program outside asks a car for a curve of 0.3 m: it gets the tightest that 40° allow, 0.8 m / tan 40°, and drives it.
#[test]
fn fg_req_083_tight_curve_becomes_drivable() {
    let hall = BENDS.replace("[[3.0, 1.6], [5.5, 0.6]]", "[]");
    let mut plan = plan("ackermann", &hall, 8);
    plan.command = Some(CommandConfiguration::on_port("127.0.0.1:7000".parse().unwrap()));
    let first = SentVelocity {
        sender: 7,
        sequence: 1,
        sent_ms: 0,
        deadline_ms: 150,
        linear_mps: 0.3,
        angular_radps: 1.0,
    };
    let stretch = Stretch { span_us: (SECOND_US, 8 * SECOND_US), period_us: 50_000, first };
    let program = OutsideProgram::new(stretch.frames(1));
    plan.outside = Some(program.clone());
    let seen = watch(plan);
    assert!(seen.verdict.passed, "{}", seen.verdict.why_not());
    let permitted = program.heard().last().expect("permits").permit.permitted;
    let tightest_m = 0.8 / 40.0_f32.to_radians().tan();
    assert!(permitted[0] > 0.05 && (permitted[0] / permitted[1] - tightest_m).abs() < 0.01, "{permitted:?}");
    // The middle of the rear axle goes round a circle of that radius, beside the start.
    let places = seen.robot_path.iter().skip(seen.robot_path.len() / 2);
    let off_m = places.map(|pose| (pose.x_m.hypot(pose.y_m - tightest_m) - tightest_m).abs());
    let worst_m = off_m.fold(0.0_f32, f32::max);
    assert!(worst_m < 0.15, "{worst_m}");
}
