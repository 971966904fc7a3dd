//! Orders to clean, and how fast an edge is driven; without a broker.

use serde_json::{Value, json};

use super::orders::{Driven, errors, instant, order, vehicle};
use crate::messages::Topic;
use crate::vehicle::{
    Cleaning, CleaningMoment, CleaningPlace, CleaningStage, VehicleCommand, VehicleDescription,
};

/// The action, with its parameters.
pub fn clean(name: &str, parameters: Value) -> Value {
    json!({"actionType": "clean", "actionId": name, "blockingType": "HARD", "actionParameters": parameters})
}

fn rectangle() -> Value {
    json!([{"key": "area", "value": [[1.0, -1.0], [3.0, 1.0]]}])
}

/// Three nodes; at the middle one the vehicle cleans.
fn order_to_clean(name: &str, parameters: Value) -> Value {
    let mut message = order(name, 0, (0, 3, 0));
    message["nodes"][1]["actions"] = json!([clean("c1", parameters)]);
    message
}

fn reported(robot: &mut Driven, stage: CleaningStage, words: &str) -> Value {
    let number = cleanings(robot).last().map_or(0, |place| place.number);
    robot.moment.cleaning = Some(CleaningMoment { number, stage, words: words.to_owned() });
    robot.step()
}

fn cleanings(robot: &Driven) -> Vec<CleaningPlace> {
    let places = robot.commands.iter().filter_map(|command| match command {
        VehicleCommand::Clean(place) => Some(place.clone()),
        _ => None,
    });
    places.collect()
}

fn action(state: &Value) -> (&str, &str) {
    let found = &state["actionStates"][0];
    (
        found["actionStatus"].as_str().unwrap_or_default(),
        found["resultDescription"].as_str().unwrap_or_default(),
    )
}

/// A vehicle that stands at the node where it cleans, and has begun.
fn begun(parameters: Value) -> Driven {
    let mut robot = Driven::new();
    assert_eq!(action(&robot.send(Topic::Order, &order_to_clean("a", parameters))).0, "WAITING");
    (0..3).for_each(|_| _ = robot.step());
    assert_eq!((robot.places.as_slice(), cleanings(&robot).len()), ([1.0].as_slice(), 1));
    robot
}

#[test]
fn cleaning_runs_before_the_drive_goes_on() {
    let mut robot = Driven::new();
    robot.send(Topic::Order, &order_to_clean("a", rectangle()));
    let states: Vec<Value> = (0..3).map(|_| robot.step()).collect();
    assert!(states.iter().any(|state| action(state).0 == "INITIALIZING"), "{states:?}");
    let place = cleanings(&robot).remove(0);
    assert_eq!(place.corners_m, [[1.0, -1.0], [3.0, -1.0], [3.0, 1.0], [1.0, 1.0]]);
    assert_eq!((place.tolerated_units, place.confidence, place.goes_on), (None, None, false));
    let running = reported(&mut robot, CleaningStage::Running, "0 of 9 dirty cells");
    assert_eq!(action(&running), ("RUNNING", "0 of 9 dirty cells"));
    // How far it is makes no state of its own, of which none may be lost: it goes out with the next.
    assert!(reported(&mut robot, CleaningStage::Running, "4 of 9 dirty cells").is_null());
    let later = robot.drive();
    assert_eq!((action(&later), robot.places.len()), (("RUNNING", "4 of 9 dirty cells"), 1));
    let done = reported(&mut robot, CleaningStage::Finished, "9 of 9 dirty cells");
    assert_eq!(action(&done), ("FINISHED", "9 of 9 dirty cells"));
    robot.drive();
    assert_eq!((robot.places.as_slice(), cleanings(&robot).len()), ([1.0, 2.0].as_slice(), 1), "once");
}

#[test]
fn failed_cleaning_lets_the_order_go_on() {
    let mut robot = begun(rectangle());
    reported(&mut robot, CleaningStage::Running, "");
    let failed = reported(&mut robot, CleaningStage::Failed("no floor".to_owned()), "3 of 9 dirty cells");
    assert_eq!(action(&failed), ("FAILED", "no floor; 3 of 9 dirty cells"));
    assert_eq!(errors(&failed), ["cleanError"]);
    let references = failed["errors"][0]["errorReferences"].as_array().unwrap();
    assert!(references.contains(&json!({"referenceKey": "actionId", "referenceValue": "c1"})));
    robot.drive();
    assert_eq!(robot.places, [1.0, 2.0]);
}

#[test]
fn paused_and_cancelled_cleaning_says_so() {
    let mut robot = begun(rectangle());
    reported(&mut robot, CleaningStage::Running, "4 of 9 dirty cells");
    robot.send(Topic::InstantActions, &instant("startPause", "p", json!([])));
    robot.moment.is_paused = true;
    let paused = robot.step();
    assert_eq!(action(&paused), ("PAUSED", "4 of 9 dirty cells"));
    assert_eq!(paused["actionStates"][1]["actionStatus"], "FINISHED");
    robot.send(Topic::InstantActions, &instant("stopPause", "q", json!([])));
    robot.moment.is_paused = false;
    assert_eq!(action(&robot.step()).0, "RUNNING");
    let cancelled = robot.send(Topic::InstantActions, &instant("cancelOrder", "x", json!([])));
    assert_eq!(action(&cancelled), ("FAILED", "the order was cancelled; 4 of 9 dirty cells"));
    assert_eq!(robot.commands.last(), Some(&VehicleCommand::Stand));
    let cancel = |state: &Value| state["actionStates"][3]["actionStatus"].as_str().map(str::to_owned);
    assert_eq!(cancel(&cancelled).as_deref(), Some("RUNNING"), "it stands by chance, and still cleans");
    let stood = reported(&mut robot, CleaningStage::Failed("it was given up".to_owned()), "");
    assert_eq!(cancel(&stood).as_deref(), Some("FINISHED"));
    robot.drive();
    assert_eq!(robot.places, [1.0], "nothing more is driven to");
}

#[test]
fn late_or_silent_cleaning_fails_with_a_reason() {
    let mut robot = begun(json!([{"key": "maxDuration", "value": 3.0}]));
    reported(&mut robot, CleaningStage::Running, "4 of 9 dirty cells");
    robot.moment.is_paused = true;
    (0..40).for_each(|_| _ = robot.step());
    robot.moment.is_paused = false;
    assert_eq!(action(&robot.step()).0, "RUNNING", "a pause does not count");
    let late = (0..10).map(|_| robot.step()).find(|state| action(state).0 == "FAILED").unwrap();
    assert_eq!(action(&late).1, "maxDuration is over; 4 of 9 dirty cells");
    assert!(robot.commands.contains(&VehicleCommand::EndCleaning));
    let mut deaf = begun(rectangle());
    let state = (0..150).map(|_| deaf.step()).find(|state| action(state).0 == "FAILED").unwrap();
    assert!(action(&state).1.contains("has not begun it within 60 s"));
}

#[test]
fn restarted_program_goes_on_cleaning() {
    let folder = tempfile::tempdir().unwrap();
    let open = || Driven::of(vehicle("7"), Some(folder.path().to_path_buf()));
    let mut robot = open();
    robot.send(Topic::Order, &order_to_clean("a", rectangle()));
    (0..3).for_each(|_| _ = robot.step());
    reported(&mut robot, CleaningStage::Running, "4 of 9 dirty cells");
    let number = cleanings(&robot)[0].number;
    drop(robot);
    let mut again = open();
    again.step();
    let place = cleanings(&again).remove(0);
    assert_eq!((place.number, place.goes_on), (number, true));
    // The vehicle's own computer may lose its power while this program runs on.
    reported(&mut again, CleaningStage::Running, "5 of 9 dirty cells");
    again.moment.cleaning = None;
    (0..3).for_each(|_| _ = again.step());
    let ordered = cleanings(&again);
    assert_eq!((ordered.len(), ordered[1].goes_on), (2, true));
    reported(&mut again, CleaningStage::Finished, "9 of 9 dirty cells");
    again.drive();
    assert_eq!((again.places.as_slice(), cleanings(&again).len()), ([2.0].as_slice(), 2));
}

#[test]
fn unusable_cleanings_are_refused_with_reason() {
    let no_mission = Cleaning::Refused("robot.toml has no [mission]".to_owned());
    let refused = |vehicle: VehicleDescription, action: Value| {
        let mut robot = Driven::of(vehicle, None);
        let mut message = order("a", 0, (0, 3, 0));
        message["nodes"][2]["actions"] = json!([action]);
        let state = robot.send(Topic::Order, &message);
        assert_eq!((errors(&state), &state["orderId"]), (vec!["orderError"], &json!("")), "{message}");
        state["errors"][0]["errorDescription"].as_str().unwrap().to_owned()
    };
    let parameter = |key: &str, value: Value| clean("c", json!([{"key": key, "value": value}]));
    for (action, why) in [
        (parameter("area", json!([[0.0, 0.0]])), "area is"),
        (parameter("area", json!([[0.0, 0.0], [0.0, 2.0]])), "area is"),
        (parameter("area", json!([[0.0, 0.0], [1.0, "2"], [3.0, 0.0]])), "area is"),
        (parameter("toleratedUnits", json!(2.5)), "whole number"),
        (parameter("confidence", json!(99.0)), "confidence is 99"),
        (parameter("maxDuration", json!(0)), "maxDuration is 0"),
        (parameter("zone", json!("till")), "zone is no parameter"),
        (json!({"actionType": "clean", "actionId": "c", "blockingType": "NONE"}), "HARD, not NONE"),
        (json!({"actionType": "polish", "actionId": "c", "blockingType": "HARD"}), "clean and wait"),
    ] {
        let words = refused(vehicle("7"), action.clone());
        assert!(words.contains(why), "{action}: {words}");
    }
    let words = refused(VehicleDescription { cleaning: no_mission, ..vehicle("7") }, clean("c", json!([])));
    assert!(words.contains("no [mission]"), "{words}");
    let mut on_edge = order("e", 0, (0, 3, 0));
    on_edge["edges"][0]["actions"] = json!([clean("c", json!([]))]);
    assert_eq!(errors(&Driven::new().send(Topic::Order, &on_edge)), ["orderError"]);
}

#[test]
fn slower_edge_limits_its_drive_alone() {
    let mut robot = Driven::new();
    let mut message = order("a", 0, (0, 4, 0));
    message["edges"][1]["maxSpeed"] = json!(0.3);
    message["edges"][1]["maxRotationSpeed"] = json!(0.2);
    message["edges"][2]["maxSpeed"] = json!(2.0);
    robot.send(Topic::Order, &message);
    robot.drive();
    let ways = robot.commands.iter().filter_map(|command| match command {
        VehicleCommand::Goto(place) => Some((place.speed_max_mps, place.turn_max_radps)),
        _ => None,
    });
    let limits: Vec<(Option<f64>, Option<f64>)> = ways.collect();
    assert_eq!(limits, [(None, None), (Some(0.3), Some(0.2)), (None, None)]);
}

/// A node before a slower edge is not passed at speed.
#[test]
fn vehicle_stands_before_a_slower_edge() {
    let passes = |speeds: [f64; 2]| {
        let mut robot = Driven::new();
        let mut message = order("a", 0, (0, 3, 0));
        for (edge, speed_mps) in speeds.into_iter().enumerate() {
            message["edges"][edge]["maxSpeed"] = json!(speed_mps);
        }
        robot.send(Topic::Order, &message);
        // Near the node, and the drive does not call it reached yet.
        robot.moment.reached = None;
        robot.step()["lastNodeId"] == "n1"
    };
    assert!(passes([0.3, 0.3]) && passes([0.3, 0.5]) && passes([0.8, 0.9]));
    assert!(!passes([0.5, 0.3]) && !passes([2.0, 0.5]));
}
