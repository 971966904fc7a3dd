//! Orders to the missions without a world around them.

use super::super::areas::AreaKind;
use super::super::progress::CellState;
use super::*;
use floorguard_configuration::{EXAMPLE, parse};
use floorguard_runtime::shared::StampedPose;
use floorguard_types::geometry::Point2;
use floorguard_types::time::Stamp;

fn begun() -> (MissionSetup, MissionQueue) {
    let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
    let setup = MissionSetup::new(MissionPlan::supermarket(), Store::None);
    let queue = setup.begin_queue(&robot).unwrap();
    (setup, queue)
}

fn step(queue: &mut MissionQueue, ms: u64) {
    let now = Stamp::from_micros(ms * 1_000);
    let pose = StampedPose { stamp: now, ..StampedPose::default() };
    let (scan, dirt, decision, people, floor) = (None, None, None, None, None);
    queue.step(&MissionMoment { now, pose, scan, dirt, decision, people, floor, is_paused: false });
}

fn square(name: &str, kind: AreaKind, (left_m, low_m, edge_m): (f32, f32, f32)) -> Area {
    let (right_m, high_m) = (left_m + edge_m, low_m + edge_m);
    let corners_m = vec![[left_m, low_m], [right_m, low_m], [right_m, high_m], [left_m, high_m]];
    Area { name: name.to_owned(), kind, corners_m }
}

fn floor_cells(setup: &MissionSetup) -> Vec<Point2> {
    let progress = setup.watch.get().expect("a progress");
    let cells = progress.cells.iter().enumerate().filter(|(_, state)| **state != CellState::OffLimits);
    cells.map(|(cell, _)| progress.geometry.centre(cell)).collect()
}

#[test]
fn mission_waits_begins_and_is_cancelled() {
    let (setup, mut queue) = begun();
    step(&mut queue, 0);
    let whole = floor_cells(&setup).len();
    let near = square("till", AreaKind::Clean, (1.0, -1.5, 3.0));
    let begin = MissionOrder::Begin { name: "till".to_owned(), areas: vec![near.clone()] };
    assert!(setup.orders.push(begin.clone()) && setup.orders.push(begin));
    step(&mut queue, 50);
    assert_eq!(setup.orders.status().waiting, ["till", "till"]);
    setup.orders.push(MissionOrder::Cancel { place: 2 });
    setup.orders.push(MissionOrder::Cancel { place: 0 });
    step(&mut queue, 100);
    let status = setup.orders.status();
    assert_eq!((status.name.as_str(), status.waiting.len(), status.refused.as_str()), ("till", 0, ""));
    step(&mut queue, 150);
    let zone = floor_cells(&setup);
    assert!(!zone.is_empty() && zone.len() < whole / 2, "{} of {whole}", zone.len());
    assert!(zone.iter().all(|place| near.contains(*place)));
    setup.orders.push(MissionOrder::Cancel { place: 0 });
    step(&mut queue, 200);
    assert_eq!(setup.watch.get().unwrap().phase, MissionPhase::Cancelled);
    setup.orders.push(MissionOrder::Cancel { place: 0 });
    step(&mut queue, 250);
    assert_eq!(setup.orders.status().refused, "no mission runs");
}

#[test]
fn no_go_area_closes_its_floor_only() {
    let (setup, mut queue) = begun();
    step(&mut queue, 0);
    let before = floor_cells(&setup);
    let closed = square("spill", AreaKind::NoGo, (6.0, -2.0, 4.0));
    assert!(before.iter().any(|place| closed.contains(*place)));
    setup.orders.push(MissionOrder::Areas { areas: vec![closed.clone()] });
    step(&mut queue, 2_000);
    let after = floor_cells(&setup);
    assert_eq!(setup.orders.status().refused, "");
    assert!(after.len() > 100 && !after.iter().any(|place| closed.contains(*place)), "{}", after.len());
    // Where the robot stands itself it cannot be closed in.
    let around = square("here", AreaKind::NoGo, (-20.0, -20.0, 60.0));
    setup.orders.push(MissionOrder::Areas { areas: vec![around] });
    step(&mut queue, 4_000);
    assert!(setup.orders.status().refused.contains("cannot"), "{:?}", setup.orders.status());
}

#[test]
fn operator_says_where_the_robot_stands() {
    let (setup, mut queue) = begun();
    step(&mut queue, 0);
    setup.orders.push(MissionOrder::Locate { x_m: 3.0, y_m: 0.1, heading_rad: 0.5 });
    step(&mut queue, 50);
    let pose = queue.current.pose();
    assert!((pose.x_m - 3.0).abs() < 1e-3 && (pose.heading_rad - 0.5).abs() < 1e-3, "{pose:?}");
    assert!(!queue.current.localiser.is_trusted(), "the scans decide");
    setup.orders.push(MissionOrder::Locate { x_m: 5.0, y_m: 2.1, heading_rad: 0.0 });
    step(&mut queue, 100);
    assert!(setup.orders.status().refused.contains("does not fit"), "a shelf stands there");
}

#[test]
fn robot_is_slow_in_a_slow_area() {
    let (_, mut queue) = begun();
    let fast = Twist2 { linear_mps: 0.6, angular_radps: 0.3 };
    assert_eq!(queue.current.slowed(fast), fast);
    let pose = queue.current.pose();
    queue.current.plan.areas = vec![square("ramp", AreaKind::Slow, (pose.x_m - 2.0, pose.y_m - 2.0, 4.0))];
    let slow = queue.current.slowed(fast);
    assert!((slow.linear_mps - 0.2).abs() < 1e-6 && (slow.angular_radps - 0.1).abs() < 1e-6, "{slow:?}");
}

#[test]
fn orders_survive_text_and_damage_is_refused() {
    let areas = vec![square("till", AreaKind::Clean, (1.0, -1.5, 3.0))];
    let order = MissionOrder::Begin { name: "till".to_owned(), areas };
    assert_eq!(MissionOrder::from_text(order.to_text().as_bytes()).unwrap(), order);
    for wrong in [
        "",
        "{}",
        r#"{"do":"begin","name":"a"}"#,
        r#"{"do":"begin","name":"a","areas":[{"name":"a","kind":"clean","corners_m":[]}]}"#,
        r#"{"do":"cancel","place":99}"#,
        r#"{"do":"locate","x_m":1e39,"y_m":0,"heading_rad":0}"#,
    ] {
        assert!(MissionOrder::from_text(wrong.as_bytes()).is_err(), "{wrong}");
    }
}
