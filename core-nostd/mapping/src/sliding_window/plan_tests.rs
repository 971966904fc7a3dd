use super::super::{
    CellPolicy, OccupancyScale, PersonBox, PersonBoxes, SlidingWindow, WindowGeometry, WindowOptions,
};
use super::*;
use floorguard_types::geometry::Point3;
use std::vec;
use std::vec::Vec;

fn window() -> SlidingWindow<Vec<WindowCell>> {
    let geometry = WindowGeometry::of_resolution(0.05).unwrap();
    let buffers = [0, 1].map(|_| vec![WindowCell::EMPTY; geometry.cells()]);
    SlidingWindow::new(geometry, WindowOptions::published(CellPolicy::Nearest), buffers).unwrap()
}

fn plan() -> Plan<Vec<PlanCell>> {
    Plan::square(50, Point2::default(), vec![PlanCell::UNKNOWN; 2_500]).unwrap().unwrap()
}

const LIMITS: SightLimits = SightLimits::of_threshold(0.6);

fn cell(plan: &Plan<Vec<PlanCell>>, x_m: f32, y_m: f32) -> PlanCell {
    let index = plan.grid().geometry().cell_at(Point2::new(x_m, y_m)).unwrap();
    plan.grid().values()[index]
}

/// A wall of points at a distance ahead.
fn wall(x_m: f32, z_m: f32) -> Vec<Point3> {
    (-40..=40).map(|step| Point3::new(x_m, 0.024 * step as f32, z_m)).collect()
}

#[test]
fn heights_enter_floor_or_ceiling() {
    let (mut window, mut plan) = (window(), plan());
    let points = [
        Point3::new(1.1, 0.1, 0.3),
        Point3::new(1.12, 0.12, 0.5),
        Point3::new(1.5, 0.1, 0.75),
        Point3::new(1.52, 0.12, 2.0),
        Point3::new(2.1, 0.1, 0.02),
        Point3::new(2.1, 1.1, 0.02),
    ];
    window.insert_points(&points, Pose2::default(), Stamp::ZERO).unwrap();
    plan.enter((&window, Pose2::default()), SweptWedge::ALL, (&LIMITS, Stamp::ZERO));
    let seen = cell(&plan, 1.1, 0.1);
    assert!((seen.floor_m().unwrap() - 0.5).abs() < 1e-3 && seen.ceiling_m().is_none(), "the highest");
    let seen = cell(&plan, 1.5, 0.1);
    assert!(seen.floor_m().is_none() && (seen.ceiling_m().unwrap() - 0.75).abs() < 1e-3, "the lowest");
    assert_eq!(cell(&plan, 2.1, 1.1).floor_m(), Some(0.0));
    assert_eq!(cell(&plan, 2.1, 0.1).floor_m(), None, "floor below what hangs too low");
    assert_eq!(cell(&plan, -1.0, 0.0), PlanCell::UNKNOWN);
}

#[test]
fn sight_clears_what_was_removed() {
    let (mut window, mut plan) = (window(), plan());
    window.insert_points(&[Point3::new(1.5, 0.1, 0.4)], Pose2::default(), Stamp::ZERO).unwrap();
    let change = plan.enter((&window, Pose2::default()), SweptWedge::ALL, (&LIMITS, Stamp::ZERO));
    assert_eq!((change.obstacles, change.outside), (1, 0));
    assert!(cell(&plan, 1.5, 0.1).floor_m().unwrap() > 0.3);
    // Now the wall behind it is seen, in its direction.
    window.clear();
    window.insert_points(&wall(2.5, 0.4), Pose2::default(), Stamp::ZERO).unwrap();
    let left = SweptWedge { from_rad: 0.5, to_rad: 1.0 };
    plan.enter((&window, Pose2::default()), left, (&LIMITS, Stamp::ZERO));
    assert!(cell(&plan, 1.5, 0.1).floor_m().unwrap() > 0.3, "not swept");
    plan.enter((&window, Pose2::default()), SweptWedge::ALL, (&LIMITS, Stamp::ZERO));
    assert_eq!(cell(&plan, 1.5, 0.1).floor_m(), Some(0.0));
    assert!(cell(&plan, 2.5, 0.1).floor_m().unwrap() > 0.3, "the wall stays");
    assert_eq!(cell(&plan, 2.9, 0.1).floor_m(), None, "behind the wall nothing is known");
    // A pose that is not finite changes nothing.
    let nowhere = Pose2 { x_m: f32::NAN, ..Pose2::default() };
    let change = plan.enter((&window, nowhere), SweptWedge::ALL, (&LIMITS, Stamp::ZERO));
    assert_eq!(change, PlanChange::default());
}

/// `grid_map` numbers cells column by column of a matrix whose first row has the largest x and whose first column the
/// largest y, and its conversion writes cell `n − 1 − number`.
#[test]
fn exports_in_the_order_of_grid_map() {
    let (mut window, mut plan) = (window(), plan());
    window.insert_points(&[Point3::new(1.1, 0.3, 0.4)], Pose2::default(), Stamp::ZERO).unwrap();
    plan.enter((&window, Pose2::default()), SweptWedge::ALL, (&LIMITS, Stamp::ZERO));
    let scale = OccupancyScale::Scaled { lower_m: 0.0, upper_m: 0.6 };
    let mut message = vec![7_i8; 2_500];
    assert_eq!(plan.export(scale, Stamp::ZERO, &mut message), 2_500);
    let mut expected = vec![7_i8; 2_500];
    for row in 0..50 {
        for column in 0..50 {
            let place = Point2::new(4.9 - 0.2 * row as f32, 4.9 - 0.2 * column as f32);
            let height = cell(&plan, place.x_m, place.y_m).floor_m();
            let number = column * 50 + row;
            expected[2_500 - 1 - number] =
                height.map_or(-1, |height| ((height / 0.6).clamp(0.0, 1.0) * 100.0) as i8);
        }
    }
    assert_eq!(message, expected);
    assert_eq!(message.iter().filter(|percent| **percent > 0).count(), 1);
    assert_eq!(plan.export(scale, Stamp::ZERO, &mut message[..10]), 10);
}

#[test]
fn people_block_until_they_expire() {
    let (mut window, mut plan) = (window(), plan());
    let stamp = Stamp::from_micros(10_000_000);
    let boxes = [PersonBox {
        azimuth_min_rad: -0.2,
        azimuth_max_rad: 0.2,
        elevation_min_rad: -1.0,
        elevation_max_rad: 1.0,
    }];
    let pose = Pose2::default();
    window.insert_points(&wall(1.1, 0.5), pose, stamp).unwrap();
    window.take_people(&PersonBoxes { stamp, base_in_odometry: pose, boxes: &boxes }, stamp).unwrap();
    plan.enter((&window, pose), SweptWedge::ALL, (&LIMITS, stamp));
    let index = plan.grid().geometry().cell_at(Point2::new(1.1, 0.1)).unwrap();
    let percent = |now: Stamp| {
        let mut message = vec![0; 2_500];
        plan.export(OccupancyScale::PUBLISHED, now, &mut message);
        message[index]
    };
    assert_eq!(percent(stamp.plus_micros(1_900_000)), 100);
    assert_eq!(percent(stamp.plus_micros(2_000_000)), -1, "no person, and what is there is not known");
}
