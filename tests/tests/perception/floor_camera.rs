//! A robot with a rendered floor camera: dirt is seen where it lies, and a low object that neither lidar nor scanner
//! sees is not driven over.

use floorguard_laboratory::world::{Observation, Observer, Plan, run_virtual};
use floorguard_robot::cleaner::MissionStrategy;
use floorguard_sim::scenario::Scenario;
use floorguard_types::geometry::Point2;

/// A hall with a spill ahead, and a brick of 5 cm beside the straight path to another.
const HALL: &str = r#"
title = "a hall with a brick on the floor"
start = { at_m = [0.0, 0.0] }
route = { speed_mps = 0.6, waypoints_m = [[6.0, 0.0]] }
[scene]
wall = [
  { from_m = [-3.0, -4.0], to_m = [9.0, -4.0] },
  { from_m = [-3.0, 4.0], to_m = [9.0, 4.0] },
  { from_m = [-3.0, -4.0], to_m = [-3.0, 4.0] },
  { from_m = [9.0, -4.0], to_m = [9.0, 4.0] },
]
furniture = [{ kind = "box", at_m = [3.2, 0.1], size_m = [0.12, 0.12], height_m = 0.05 }]
[dirt]
spill = [
  { at_m = [1.8, 0.3], radius_m = 0.15, units = 14.0 },
  { at_m = [5.5, 0.0], radius_m = 0.2, units = 14.0 },
]
"#;
const BRICK: Point2 = Point2 { x_m: 3.2, y_m: 0.1 };

fn drive(has_camera: bool, (strategy, seconds): (MissionStrategy, u64)) -> (Plan, Observation) {
    let empty: String =
        HALL.lines().filter(|line| !line.starts_with("furniture")).collect::<Vec<_>>().join("\n");
    let scenario = Scenario::from_toml(&empty).expect("a scenario");
    let plan = Plan::of("hall", scenario, 5, seconds * 1_000_000).expect("a plan");
    let mut plan = plan.cleaning(Some(strategy)).expect("a mission");
    // The mission's map was made before somebody lost the brick.
    plan.scenario = Scenario::from_toml(HALL).expect("a scenario");
    plan.has_camera = has_camera;
    let mut show = |_: f64, _: &_, _: usize, _: &_| ();
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer).expect("it runs");
    (plan, observer.into_observation())
}

/// The path brought the robot's outline over the brick.
fn drove_over(plan: &Plan, seen: &Observation) -> bool {
    let corners = || plan.robot.geometry.footprint.iter();
    let bound = |pick: fn(&Point2) -> f32| {
        corners().map(pick).fold((f32::MAX, f32::MIN), |(low, high), value| (low.min(value), high.max(value)))
    };
    let ((rear, front), (right, left)) = (bound(|corner| corner.x_m), bound(|corner| corner.y_m));
    seen.robot_path.iter().any(|pose| {
        let brick = pose.inverse().transform(BRICK);
        (rear..front).contains(&brick.x_m) && (right..left).contains(&brick.y_m)
    })
}

#[test]
fn dirt_is_mapped_and_brick_is_avoided() {
    let straight_on = (MissionStrategy::Route, 12);
    let (plan, blind) = drive(false, straight_on);
    assert!(drove_over(&plan, &blind), "the experiment shows nothing: the path does not lead over the brick");
    let (plan, seen) = drive(true, straight_on);
    assert!(!drove_over(&plan, &seen) && seen.verdict.distance_m > 0.8, "{} m", seen.verdict.distance_m);
    let (plan, seen) = drive(true, (MissionStrategy::Guarantee, 30));
    assert!(!drove_over(&plan, &seen));
    assert!(
        seen.verdict.distance_m > 3.0,
        "it does not stand still before it: {} m",
        seen.verdict.distance_m
    );
    let dirt = seen.seen_dirt.expect("a camera");
    let spots: Vec<Point2> = dirt.spots.spots.iter().map(|spot| spot.centre_in_map).collect();
    assert!(spots.iter().any(|spot| spot.distance(Point2::new(1.8, 0.3)) < 0.1), "{spots:?}");
    let spilled = [Point2::new(1.8, 0.3), Point2::new(5.5, 0.0)];
    let is_true = |spot: &Point2| spilled.iter().any(|spill| spill.distance(*spot) < 0.3);
    assert!(spots.iter().filter(|spot| !is_true(spot)).count() <= 1, "{spots:?}");
    assert!(dirt.seen_m2 > 3.0 && dirt.frames.0 > 100, "{} m², {:?}", dirt.seen_m2, dirt.frames);
}
