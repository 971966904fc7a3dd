//! Orders to drive and to clean, without a world around them.

use std::sync::Arc;

use floorguard_configuration::{EXAMPLE, NavigationConfiguration, parse};
use floorguard_runtime::shared::StampedPose;
use floorguard_runtime::tasks::{Mission, MissionMoment};
use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::time::Stamp;

use super::OrderedWork;
use crate::cleaner::{
    Area, AreaKind, CellState, CleaningCommand, CleaningOrder, CleaningOrders, CleaningStage, CleaningStatus,
    MissionOrder, MissionPhase, MissionPlan, MissionSetup, Store,
};
use crate::navigator::{DriveOrder, DriveOrders, Journey, NavigationPlan, NavigationSetup};

/// A robot in the supermarket that a master orders.
struct Robot {
    drive: NavigationSetup,
    setup: MissionSetup,
    orders: CleaningOrders,
    work: OrderedWork,
    now_ms: u64,
}

impl Robot {
    fn new(store: Store) -> Self {
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let plan = MissionPlan::supermarket();
        let settings = (&NavigationConfiguration::of_limits(&robot.limits)).into();
        let start = plan.start_pose();
        let journey = Journey { start_in_map: start, goal_in_map: start };
        let drive = NavigationPlan::on_map(settings, journey, (&plan.occupancy().unwrap(), 1));
        let drive = NavigationSetup::new(drive).ordered_by(Some(DriveOrders::default()));
        let orders = CleaningOrders::default();
        let setup = MissionSetup::new(plan, store).ordered_by(Some(orders.clone()));
        assert!(OrderedWork::is_meant(&drive, &setup));
        let work = OrderedWork::new((&drive, &setup), &robot).unwrap();
        Self { drive, setup, orders, work, now_ms: 0 }
    }

    fn step(&mut self, is_paused: bool) -> Twist2 {
        self.now_ms += 100;
        let now = Stamp::from_micros(self.now_ms * 1_000);
        let pose = StampedPose { stamp: now, ..StampedPose::default() };
        let (scan, dirt, decision, people, floor) = (None, None, None, None, None);
        self.work.step(&MissionMoment { now, pose, scan, dirt, decision, people, floor, is_paused })
    }

    /// Somebody orders; the robot has heard it.
    fn order(&mut self, command: CleaningCommand) -> CleaningStatus {
        assert!(self.orders.push(command));
        self.step(false);
        self.orders.status().expect("a status")
    }
}

/// A square of the floor between the shelves: three metres from (1, -1.5) on.
fn square(number: u32) -> CleaningOrder {
    let corners_m = vec![[1.0, -1.5], [4.0, -1.5], [4.0, 1.5], [1.0, 1.5]];
    CleaningOrder { number, corners_m, tolerated_units: None, delta: None, goes_on: false }
}

#[test]
fn ordered_square_alone_is_cleaned() {
    let mut robot = Robot::new(Store::None);
    assert_eq!(
        (robot.step(false), robot.orders.status()),
        (Twist2::ZERO, None),
        "it begins nothing by itself"
    );
    let status = robot.order(CleaningCommand::Clean(square(7)));
    assert_eq!((status.number, &status.stage), (7, &CleaningStage::Cleaning));
    let counts = status.counts.unwrap();
    assert!(counts.dirty_cells > 0 && counts.clean_cells == 0, "{counts:?}");
    let requested: Vec<Twist2> = (0..30).map(|_| robot.step(false)).collect();
    assert!(requested.iter().any(|twist| *twist != Twist2::ZERO), "it asks to move");
    let progress = robot.setup.watch.get().unwrap();
    let own = progress.cells.iter().enumerate().filter(|(_, state)| **state != CellState::OffLimits);
    let places: Vec<_> = own.map(|(cell, _)| progress.geometry.centre(cell)).collect();
    assert!(!places.is_empty());
    let is_inside = |x_m: f32, y_m: f32| (1.0..4.0).contains(&x_m) && (-1.5..1.5).contains(&y_m);
    assert!(places.iter().all(|place| is_inside(place.x_m, place.y_m)));
    // The promise of the order, not that of the mission.
    let lenient = CleaningOrder { tolerated_units: Some(50), delta: Some(0.5), ..square(8) };
    let counts = robot.order(CleaningCommand::Clean(lenient)).counts.unwrap();
    assert_eq!((counts.tolerated_units, counts.delta), (50, 0.5));
}

#[test]
fn pause_and_end_stop_the_robot() {
    let mut robot = Robot::new(Store::None);
    robot.order(CleaningCommand::Clean(square(1)));
    assert!((0..30).map(|_| robot.step(false)).any(|twist| twist != Twist2::ZERO));
    assert!((0..10).map(|_| robot.step(true)).all(|twist| twist == Twist2::ZERO), "paused");
    assert!((0..30).map(|_| robot.step(false)).any(|twist| twist != Twist2::ZERO), "it goes on");
    let ended = robot.order(CleaningCommand::End);
    assert_eq!((ended.number, ended.stage), (1, CleaningStage::Failed("it was given up".to_owned())));
    assert_eq!(robot.setup.watch.get().unwrap().phase, MissionPhase::Cancelled, "for the panel, too");
    assert!((0..30).map(|_| robot.step(false)).all(|twist| twist == Twist2::ZERO));
}

#[test]
fn impossible_cleaning_fails_with_a_reason() {
    let mut robot = Robot::new(Store::None);
    let shelf = vec![[4.5, 2.05], [5.5, 2.05], [5.5, 2.15], [4.5, 2.15]];
    for (corners_m, why) in
        [(shelf, "cannot clean anything there"), (vec![[0.0, 0.0], [1.0, 0.0]], "corners")]
    {
        let status = robot.order(CleaningCommand::Clean(CleaningOrder { corners_m, ..square(3) }));
        let CleaningStage::Failed(words) = &status.stage else { panic!("{status:?}") };
        assert!(words.contains(why), "{words}");
        assert_eq!(robot.step(false), Twist2::ZERO);
    }
    // A place to drive to that comes meanwhile ends it: the robot does one of both at a time.
    robot.order(CleaningCommand::Clean(square(4)));
    let goal = crate::navigator::OrderedGoal {
        number: 1,
        goal_in_map: Pose2::new(3.0, 0.0, 0.0),
        within_m: 0.3,
        within_rad: 3.2,
        way: crate::navigator::WayLimits::NONE,
    };
    assert!(robot.drive.orders.as_ref().unwrap().push(DriveOrder::Goto(goal)));
    robot.step(false);
    let stage = robot.orders.status().unwrap().stage;
    assert_eq!(stage, CleaningStage::Failed("a place to drive to was ordered meanwhile".to_owned()));
}

/// The computer loses its power: a cleaning that goes on knows what was clean, one that begins does not.
#[test]
fn saved_cells_stay_clean_over_a_restart() {
    let store = Store::Memory(Arc::default());
    let mut robot = Robot::new(store.clone());
    robot.order(CleaningCommand::Clean(square(1)));
    let before = robot.setup.plan.clone();
    let dirty = robot.orders.status().unwrap().counts.unwrap().dirty_cells;
    robot.work.clean_half();
    (0..12).for_each(|_| _ = robot.step(false));
    let mut again = Robot::new(store.clone());
    assert_eq!(again.setup.plan, before);
    again.step(false);
    assert_eq!(again.orders.status(), None, "what ran before the restart runs no more");
    let went_on = CleaningOrder { goes_on: true, ..square(1) };
    let counts = again.order(CleaningCommand::Clean(went_on)).counts.unwrap();
    assert!(counts.dirty_cells == dirty && counts.clean_cells > dirty / 4, "{counts:?} of {dirty}");
    let anew = again.order(CleaningCommand::Clean(square(2))).counts.unwrap();
    assert_eq!(anew.clean_cells, counts.clean_cells, "what was cleaned a moment ago is clean");
    again.now_ms += 4_000_000;
    let later = again.order(CleaningCommand::Clean(square(3))).counts.unwrap();
    assert_eq!((later.dirty_cells, later.clean_cells), (dirty, 0), "an hour later it counts as dirty again");
}

#[test]
fn operator_gives_up_and_draws_areas() {
    let mut robot = Robot::new(Store::None);
    let spill = vec![[3.0, -1.5], [4.0, -1.5], [4.0, 1.5], [3.0, 1.5]];
    let drawn = Area { name: "spill".to_owned(), kind: AreaKind::NoGo, corners_m: spill };
    let open = robot.order(CleaningCommand::Clean(square(1))).counts.unwrap();
    robot.setup.orders.push(MissionOrder::Areas { areas: vec![drawn] });
    (0..12).for_each(|_| _ = robot.step(false));
    let closed = robot.orders.status().unwrap().counts.unwrap();
    assert!(closed.dirty_cells < open.dirty_cells, "{closed:?} of {open:?}");
    robot.setup.orders.push(MissionOrder::Begin { name: "own".to_owned(), areas: Vec::new() });
    robot.step(false);
    assert!(robot.setup.orders.status().refused.contains("fleet's master"));
    robot.setup.orders.push(MissionOrder::Cancel { place: 0 });
    (0..2).for_each(|_| _ = robot.step(false));
    let stage = robot.orders.status().unwrap().stage;
    assert_eq!(stage, CleaningStage::Failed("the operator has given it up at the robot".to_owned()));
}
