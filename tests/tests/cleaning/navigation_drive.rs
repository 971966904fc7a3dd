//! Drives to a goal, judged by true contacts, the true pose and the reasons that the robot names while it stands.

use floorguard_laboratory::judge::{NavigationReport, Outcome};
use floorguard_laboratory::world::{Observation, Observer, Plan, run_virtual};
use floorguard_sim::scenario::Scenario;
use floorguard_types::geometry::Pose2;

fn play(plan: &Plan) -> (Observation, NavigationReport) {
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(plan, &mut show);
    run_virtual(plan, &mut observer).unwrap();
    let seen = observer.into_observation();
    let drive = seen.verdict.navigation.clone().expect("the drive is judged");
    (seen, drive)
}

/// What stands between two aisles besides the shelves.
#[derive(Clone, Copy, Default)]
struct Scene {
    walls: &'static str,
    furniture: &'static str,
    people: &'static str,
}

/// A block of shelves between two aisles, with more walls, and with people.
fn aisles(walls: &'static str, people: &'static str) -> Scenario {
    aisles_with(Scene { walls, people, ..Scene::default() })
}

fn aisles_with(Scene { walls, furniture, people }: Scene) -> Scenario {
    let text = format!(
        r#"
title = "two aisles"
start = {{ at_m = [-3.0, 2.0], yaw_deg = 0.0 }}
[route]
speed_mps = 0.8
waypoints_m = [[0.0, 2.0]]
[scene]
wall = [
  {{ from_m = [-5.0, -4.0], to_m = [11.0, -4.0] }},
  {{ from_m = [11.0, -4.0], to_m = [11.0, 4.0] }},
  {{ from_m = [11.0, 4.0], to_m = [-5.0, 4.0] }},
  {{ from_m = [-5.0, 4.0], to_m = [-5.0, -4.0] }},
  {{ from_m = [0.0, 3.2], to_m = [6.0, 3.2] }},
  {{ from_m = [0.0, -3.2], to_m = [6.0, -3.2] }},
{walls}]
furniture = [{{ kind = "shelf", at_m = [3.0, 0.0], size_m = [6.0, 2.4], height_m = 1.8 }}{furniture}]
{people}
"#
    );
    Scenario::from_toml(&text).unwrap()
}

fn drive_plan(scenario: Scenario, goal: Pose2, seconds: u64) -> Plan {
    Plan::of("aisles", scenario, 1, seconds * 1_000_000).unwrap().navigating(goal).unwrap()
}

/// Through the supermarket among its customers, past two shelves.
#[test]
fn goal_across_the_supermarket_is_reached() {
    let plan = Plan::named("supermarket", 1, 150_000_000).unwrap();
    let (seen, drive) = play(&plan.navigating(Pose2::new(14.5, 4.5, 1.57)).unwrap());
    assert_eq!(seen.verdict.verdict, Outcome::Good, "{} {drive:#?}", seen.verdict.reason);
    assert_eq!(
        (seen.verdict.avoidable_contacts, seen.verdict.missed_stops),
        (0, 0),
        "{:?}",
        seen.verdict.bodies
    );
    assert!(drive.reached && drive.off_goal_m < 0.4 && drive.unreasoned_s < 3.0, "{drive:#?}");
}

/// A room without a door: the reason is true, and it comes soon.
#[test]
fn goal_in_a_sealed_room_is_unreachable() {
    let room = "
  { from_m = [7.0, -3.6], to_m = [10.6, -3.6] },
  { from_m = [10.6, -3.6], to_m = [10.6, -0.4] },
  { from_m = [10.6, -0.4], to_m = [7.0, -0.4] },
  { from_m = [7.0, -0.4], to_m = [7.0, -3.6] },
";
    let (seen, drive) = play(&drive_plan(aisles(room, ""), Pose2::new(8.8, -2.0, 0.0), 60));
    assert_eq!(seen.verdict.verdict, Outcome::NotFinished, "{}", seen.verdict.reason);
    assert!(!drive.reached && drive.phase == "unreachable", "{drive:#?}");
    assert!(seen.verdict.duration_s < 20.0, "{}", seen.verdict.duration_s);
    let reason = &seen.verdict.reason;
    assert!(reason.contains("no path leads to the goal, by the map alone"), "{reason}");
    assert!(drive.distance_m < 0.5, "it never drove: {drive:#?}");
}

/// A person who stands fills the nearer aisle: the robot takes the other one.
#[test]
fn blocked_aisle_is_driven_round() {
    let blocked = "[[person]]\nkind = \"wheelchair\"\nat_m = [3.0, 2.2]\n";
    let (seen, drive) = play(&drive_plan(aisles("", blocked), Pose2::new(8.5, 2.0, 0.0), 150));
    assert_eq!(seen.verdict.verdict, Outcome::Good, "{} {drive:#?}", seen.verdict.reason);
    assert_eq!(seen.verdict.avoidable_contacts, 0, "{:?}", seen.verdict.bodies);
    let lowest_m = seen.robot_path.iter().map(|pose| pose.y_m).fold(f32::MAX, f32::min);
    assert!(lowest_m < -1.4, "through the other aisle: {lowest_m} m");
}

/// The judges notice a robot whose costmap holds no obstacle: it wants to go through the shelf, and the guard holds it there.
#[test]
fn robot_with_empty_costmap_fails() {
    let mut plan = drive_plan(aisles("", ""), Pose2::new(8.5, -0.5, 0.0), 60);
    plan.navigation.as_mut().expect("a drive").settings.is_blind = true;
    let (seen, drive) = play(&plan);
    assert_ne!(seen.verdict.verdict, Outcome::Good, "{drive:#?}");
    assert!(!drive.reached, "{drive:#?}");
    assert_eq!(
        seen.verdict.avoidable_contacts, 0,
        "the guard stands above the planner: {:?}",
        seen.verdict.bodies
    );
    // The same drive with its costmap is good: what fails is the costmap.
    plan.navigation.as_mut().expect("a drive").settings.is_blind = false;
    let (seen, drive) = play(&plan);
    assert_eq!(seen.verdict.verdict, Outcome::Good, "{} {drive:#?}", seen.verdict.reason);
}

/// Both aisles were walled up since the map was made: the robot calls for help and says why, and it touched nothing.
#[test]
fn walled_up_aisles_end_with_a_call() {
    let walls = "
  { from_m = [4.0, 1.2], to_m = [4.0, 3.2] },
  { from_m = [4.0, -3.2], to_m = [4.0, -1.2] },
";
    let goal = Pose2::new(8.5, 2.0, 0.0);
    let mut plan = drive_plan(aisles(walls, ""), goal, 240);
    plan.navigation = drive_plan(aisles("", ""), goal, 240).navigation;
    plan.navigation.as_mut().expect("a drive").settings.help_after_s = 15.0;
    let (seen, drive) = play(&plan);
    assert_eq!(seen.verdict.verdict, Outcome::NotFinished, "{} {drive:#?}", seen.verdict.reason);
    assert_eq!((drive.phase.as_str(), drive.false_claim), ("needs help", false), "{drive:#?}");
    assert!(drive.reason.starts_with("calls for help after"), "{drive:#?}");
    assert!(drive.reason.contains("no path") || drive.reason.contains("touch"), "{drive:#?}");
    assert!(drive.unreasoned_s < 3.0, "{drive:#?}");
    assert_eq!(seen.verdict.avoidable_contacts, 0, "{:?}", seen.verdict.bodies);
}

/// A table board that the scanner does not see fills the nearer aisle: the robot sees it from afar by its lidar, takes the other
/// aisle, and never comes near enough for the guard to stop it.
#[test]
fn table_in_an_aisle_is_driven_round() {
    let table = ", { kind = \"box\", at_m = [3.0, 2.2], size_m = [0.8, 1.9], from_m = 0.7, height_m = 0.73 }";
    let plan = drive_plan(
        aisles_with(Scene { furniture: table, ..Scene::default() }),
        Pose2::new(9.0, 2.0, 0.0),
        120,
    );
    let (seen, drive) = play(&plan);
    assert_eq!(seen.verdict.verdict, Outcome::Good, "{} {drive:#?}", seen.verdict.reason);
    assert_eq!(seen.verdict.bodies.counts.while_moving(), 0, "{:?}", seen.verdict.bodies);
    assert!(drive.reached && seen.verdict.stops == 0, "{} stops, {drive:#?}", seen.verdict.stops);
}
