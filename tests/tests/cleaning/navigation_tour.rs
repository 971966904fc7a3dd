//! Tours: the robot looks from one place after another, judged by where it truly stood.

use floorguard_laboratory::judge::{NavigationReport, Outcome};
use floorguard_laboratory::world::{Observation, Observer, Plan, run_virtual};
use floorguard_types::geometry::Pose2;

/// In the empty hall.
fn tour(places: &[Pose2], seconds: u64) -> (Observation, NavigationReport) {
    let plan = Plan::named("empty", 1, seconds * 1_000_000).unwrap().touring(places).unwrap();
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer).unwrap();
    let seen = observer.into_observation();
    let drive = seen.verdict.navigation.clone().expect("the drive is judged");
    (seen, drive)
}

#[test]
fn robot_observes_from_every_place() {
    let places = [Pose2::new(5.0, 0.0, 0.0), Pose2::new(9.0, 3.0, 1.5), Pose2::new(6.0, 7.0, 3.0)];
    let (seen, drive) = tour(&places, 180);
    assert_eq!(seen.verdict.verdict, Outcome::Good, "{} {drive:#?}", seen.verdict.reason);
    let report = drive.tour.expect("a tour");
    assert_eq!((report.places, report.stood_at, report.claimed, report.left_out), (3, 3, 3, 0));
    // Each place has a look of three seconds, and no stand is without a reason.
    assert!(drive.standing_share * drive.took_s > 8.5 && drive.unreasoned_s < 3.0, "{drive:#?}");
}

#[test]
fn place_behind_walls_is_left_out() {
    let places = [Pose2::new(4.0, 0.0, 0.0), Pose2::new(30.0, 0.0, 0.0), Pose2::new(8.0, 2.0, 0.0)];
    let (seen, drive) = tour(&places, 180);
    assert_eq!(seen.verdict.verdict, Outcome::NotFinished, "{} {drive:#?}", seen.verdict.reason);
    let report = drive.tour.expect("a tour");
    assert_eq!((report.places, report.stood_at, report.claimed, report.left_out), (3, 2, 2, 1));
    assert!(drive.reason.contains("no way was found to 1"), "{}", drive.reason);
    assert!(seen.verdict.reason.contains("stood at 2 of 3 places"), "{}", seen.verdict.reason);
}
