//! A robot that stands close before something, without a world around it.

use floorguard_configuration::{EXAMPLE, NavigationConfiguration, parse};
use floorguard_mapping::{Grid, GridGeometry, Occupancy};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::{Gear, Waypoint};

use super::drive::Navigator;
use super::plan::{Journey, NavigationPlan};
use super::setup::NavigationSetup;

/// On the way between two poses of an empty hall of 9 × 6 m with walls around.
pub(super) fn navigator(start_in_map: Pose2, goal_in_map: Pose2) -> Navigator {
    let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
    let geometry = GridGeometry::new(180, 120, 0.05, Point2::default()).unwrap();
    let pixel = |cell| {
        let place = geometry.centre(cell);
        let is_floor = (0.1..8.9).contains(&place.x_m) && (0.1..5.9).contains(&place.y_m);
        if is_floor { Occupancy::Free } else { Occupancy::Occupied }
    };
    let map = Grid::new(geometry, (0..geometry.cell_count()).map(pixel).collect()).unwrap();
    let settings = (&NavigationConfiguration::of_limits(&robot.limits)).into();
    let journey = Journey { start_in_map, goal_in_map };
    let plan = NavigationPlan::on_map(settings, journey, (&map, 1));
    let mut navigator = NavigationSetup::new(plan).begin(&robot).unwrap();
    navigator.maps.refresh();
    navigator.maps.roll(Point2::new(start_in_map.x_m, start_in_map.y_m), &[]);
    navigator
}

/// Farthest from the line straight back, and farthest back, metres.
fn aside_and_back(way: &[Waypoint], pose: Pose2) -> (f32, f32) {
    assert!(way.iter().all(|at| at.gear == Gear::Back), "{way:?}");
    let places = way.iter().map(|at| pose.inverse().compose(at.pose_in_map));
    places.fold((0.0, 0.0), |(aside, back), at| (at.y_m.abs().max(aside), (-at.x_m).max(back)))
}

#[test]
fn robot_from_nowhere_backs_straight() {
    let pose = Pose2::new(7.6, 3.0, 0.0);
    let mut parked = navigator(pose, Pose2::new(2.0, 3.0, 0.0));
    parked.begin_backing(pose);
    let (aside_m, back_m) = aside_and_back(&parked.back, pose);
    assert!(aside_m < 1.0e-3 && (back_m - 1.0).abs() < 1.0e-3, "{:?}", parked.back);
    // Half a metre behind it is a wall.
    let pose = Pose2::new(1.2, 3.0, 0.0);
    let mut enclosed = navigator(pose, Pose2::new(2.0, 3.0, 0.0));
    enclosed.begin_backing(pose);
    let (_, back_m) = aside_and_back(&enclosed.back, pose);
    assert!((0.3..0.7).contains(&back_m), "{:?}", enclosed.back);
}

#[test]
fn refused_way_back_becomes_straight() {
    let pose = Pose2::new(6.0, 3.0, 0.0);
    let mut navigator = navigator(pose, Pose2::new(2.0, 3.0, 0.0));
    for step in 0_u8..10 {
        // It came round a bend.
        let ahead_m = 5.0 + 0.1 * f32::from(step);
        navigator.trail.note(Pose2::new(ahead_m, 3.0 + (6.0 - ahead_m).powi(2), 0.0));
    }
    navigator.begin_backing(pose);
    let (aside_m, _) = aside_and_back(&navigator.back, pose);
    assert!(aside_m > 0.5, "the way that it came: {:?}", navigator.back);
    navigator.held_s = 1.0;
    navigator.straighten_backing(pose);
    assert_eq!(aside_and_back(&navigator.back, pose).0, aside_m, "it waits a little");
    navigator.held_s = 2.5;
    navigator.straighten_backing(pose);
    let (aside_m, back_m) = aside_and_back(&navigator.back, pose);
    assert!(aside_m < 1.0e-3 && back_m > 0.9, "{:?}", navigator.back);
}

/// The goal lies nearer before a wall than the guard's field: there is no path with room for it, and one for the body.
#[test]
fn goal_before_a_wall_has_a_path() {
    let (pose, goal) = (Pose2::new(3.0, 3.0, 0.0), Pose2::new(7.75, 3.0, 0.0));
    let mut navigator = navigator(pose, goal);
    navigator.plan_anew(pose, 0.0);
    assert!(navigator.failure.is_none() && navigator.course.gear() == Some(Gear::Ahead));
    let last = navigator.course.rest().last().copied().unwrap();
    assert_eq!(last.pose_in_map, goal);
}
