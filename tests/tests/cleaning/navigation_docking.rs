//! Drives that end where they began, judged by where the robot truly stood then.

use floorguard_laboratory::judge::{NavigationReport, Outcome};
use floorguard_laboratory::world::{Observation, Observer, Plan, run_virtual};
use floorguard_sim::scenario::Scenario;
use floorguard_types::geometry::Pose2;

/// A charging place in the corner of a hall.
const HALL: &str = include_str!("../../../hal-sim/scenarios/dock.toml");

/// What comes while the robot is away: boxes around the dock, so that its scanner sees less of what it saw.
const CHANGED: &str = r#"
  { kind = "box", at_m = [4.6, 0.5], size_m = [7.0, 0.4], from_m = 0.0, height_m = 0.5, appears_s = 40.0 },
  { kind = "box", at_m = [5.6, 3.0], size_m = [6.0, 0.3], from_m = 0.0, height_m = 0.5, appears_s = 40.0 },
  { kind = "box", at_m = [6.5, 1.8], size_m = [0.4, 2.0], from_m = 0.0, height_m = 0.5, appears_s = 40.0 },
]
"#;

fn drive(plan: &Plan) -> (Observation, NavigationReport) {
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(plan, &mut show);
    run_virtual(plan, &mut observer).unwrap();
    let seen = observer.into_observation();
    let drive = seen.verdict.navigation.clone().expect("the drive is judged");
    (seen, drive)
}

fn plan_in(hall: &str, seed: u64) -> Plan {
    let scenario = Scenario::from_toml(hall).unwrap();
    Plan::of("dock", scenario, seed, 240_000_000).unwrap().docking(Pose2::new(6.5, 5.0, 1.0)).unwrap()
}

/// Within a centimetre and a degree of its true place, also where boxes have come meanwhile.
#[test]
fn robot_docks_where_it_began() {
    let changed = format!("{}{CHANGED}", HALL.trim_end().trim_end_matches(']'));
    for (hall, seed) in [(HALL, 1), (&changed, 1)] {
        let (seen, drive) = drive(&plan_in(hall, seed));
        println!("seed {seed}: {}", drive.words());
        assert_eq!(seen.verdict.verdict, Outcome::Good, "{} {drive:#?}", seen.verdict.reason);
        assert!(
            drive.docks && drive.reached && drive.off_goal_m <= 0.01 && drive.off_goal_deg <= 1.0,
            "{drive:#?}"
        );
    }
}

/// A robot that comes back by its map alone says that it is there, and the judge does not believe it.
#[test]
fn return_by_map_alone_is_no_docking() {
    let mut plan = plan_in(HALL, 1);
    let start = plan.scenario.start_pose();
    let mut drive_plan = plan.navigation.take().expect("a drive");
    // Behind the goal comes the start as another place of a tour.
    drive_plan.tour = vec![[start.x_m, start.y_m, start.heading_rad]];
    plan.navigation = Some(drive_plan);
    let (_, drive) = drive(&plan);
    println!("{}", drive.words());
    assert!(!drive.reached && drive.off_goal_m > 0.01, "{drive:#?}");
}
