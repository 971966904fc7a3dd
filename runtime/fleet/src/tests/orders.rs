//! Orders and actions, without a broker.

use std::path::PathBuf;

use serde_json::{Value, json};

use crate::agent::FleetAgent;
use crate::messages::Topic;
use crate::vehicle::{
    Cleaning, CleaningPromise, VehicleCommand, VehicleDescription, VehicleMoment, VehiclePose,
};

pub fn vehicle(serial: &str) -> VehicleDescription {
    VehicleDescription {
        interface: "uagv".to_owned(),
        manufacturer: "floorguard".to_owned(),
        serial: serial.to_owned(),
        map_id: "hall".to_owned(),
        size_m: [1.2, 0.8, 1.1],
        speed_max_mps: 0.8,
        acceleration_max_mps2: [0.5, 0.8],
        outline_m: vec![[-0.3, -0.4], [0.9, -0.4], [0.9, 0.4], [-0.3, 0.4]],
        within_m: 0.25,
        within_rad: 0.17,
        cleaning: Cleaning::Offered(CleaningPromise { tolerated_units: 5, confidence: 0.99 }),
    }
}

/// Nodes along x, one metre apart, from a sequence id on; the last ones are the horizon.
pub fn order(name: &str, update: u32, (first, nodes, horizon): (u32, u32, u32)) -> Value {
    let released = |index: u32| index + horizon < nodes;
    let node = |index: u32| {
        let number = first / 2 + index;
        json!({"nodeId": format!("n{number}"), "sequenceId": first + 2 * index, "released": released(index), "actions": [],
            "nodePosition": {"x": f64::from(number), "y": 0.0, "mapId": "hall", "allowedDeviationXY": 0.3}})
    };
    let edge = |index: u32| {
        let number = first / 2 + index;
        json!({"edgeId": format!("e{number}"), "sequenceId": first + 2 * index + 1, "released": released(index + 1),
            "startNodeId": format!("n{number}"), "endNodeId": format!("n{}", number + 1), "actions": []})
    };
    json!({"headerId": 1, "timestamp": "2026-11-24T04:00:00.00Z", "version": "2.1.0", "manufacturer": "floorguard",
        "serialNumber": "7", "orderId": name, "orderUpdateId": update,
        "nodes": (0..nodes).map(node).collect::<Vec<_>>(), "edges": (0..nodes - 1).map(edge).collect::<Vec<_>>()})
}

pub fn instant(kind: &str, name: &str, parameters: Value) -> Value {
    json!({"headerId": 1, "timestamp": "2026-11-24T04:00:00.00Z", "version": "2.1.0", "manufacturer": "floorguard",
        "serialNumber": "7", "actions": [{"actionType": kind, "actionId": name, "blockingType": "NONE",
        "actionParameters": parameters}]})
}

/// A robot that is where it is ordered to be a moment later.
pub struct Driven {
    pub agent: FleetAgent,
    pub moment: VehicleMoment,
    pub places: Vec<f64>,
    pub commands: Vec<VehicleCommand>,
}

impl Driven {
    pub fn new() -> Self {
        Self::of(vehicle("7"), None)
    }

    pub fn of(vehicle: VehicleDescription, folder: Option<PathBuf>) -> Self {
        let moment = VehicleMoment {
            pose: Some(VehiclePose::default()),
            is_localised: true,
            is_automatic: true,
            ..VehicleMoment::default()
        };
        let agent = FleetAgent::open(vehicle, folder).unwrap();
        let mut robot = Self { agent, moment, places: Vec::new(), commands: Vec::new() };
        robot.step();
        robot
    }

    pub fn send(&mut self, topic: Topic, message: &Value) -> Value {
        let outcome = self.agent.receive(topic, message.to_string().as_bytes());
        self.commands.extend(outcome.commands);
        self.step()
    }

    /// The next state, or null.
    pub fn step(&mut self) -> Value {
        self.moment.now_s += 0.5;
        let outcome = self.agent.attend(self.moment.clone(), "2026-11-24T04:00:00.000Z");
        for command in &outcome.commands {
            if let VehicleCommand::Goto(place) = command {
                self.places.push(place.pose.x_m);
                self.moment.pose = Some(place.pose);
                self.moment.reached = Some(place.number);
            }
        }
        self.commands.extend(outcome.commands);
        let mut states = outcome.messages.iter().filter(|message| message.topic == Topic::State);
        states.next_back().map_or(Value::Null, |message| serde_json::from_str(&message.payload).unwrap())
    }

    pub fn drive(&mut self) -> Value {
        (0..40).map(|_| self.step()).filter(|state| !state.is_null()).last().unwrap_or_default()
    }
}

pub fn errors(state: &Value) -> Vec<&str> {
    state["errors"].as_array().unwrap().iter().map(|error| error["errorType"].as_str().unwrap()).collect()
}

#[test]
fn base_is_driven_and_horizon_waits() {
    let mut robot = Driven::new();
    let taken = robot.send(Topic::Order, &order("a", 0, (0, 5, 2)));
    assert_eq!((&taken["orderId"], &taken["lastNodeId"]), (&json!("a"), &json!("n0")));
    assert_eq!(taken["nodeStates"].as_array().unwrap().len(), 4);
    let state = robot.drive();
    assert_eq!(robot.places, [1.0, 2.0]);
    assert_eq!((&state["lastNodeId"], &state["newBaseRequest"]), (&json!("n2"), &json!(true)));
    // The update begins at the last released node and replaces the horizon.
    robot.send(Topic::Order, &order("a", 1, (4, 3, 0)));
    let state = robot.drive();
    assert_eq!(robot.places, [1.0, 2.0, 3.0, 4.0]);
    assert!(
        state["nodeStates"].as_array().unwrap().is_empty()
            && state["edgeStates"].as_array().unwrap().is_empty()
    );
    assert_eq!((&state["lastNodeSequenceId"], &state["orderUpdateId"]), (&json!(8), &json!(1)));
    // The same once more is not carried out again.
    robot.send(Topic::Order, &order("a", 1, (4, 3, 0)));
    assert!(robot.drive().is_null() || robot.places.len() == 4);
}

#[test]
fn refused_orders_name_standard_errors() {
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut message = order("b", 0, (0, 3, 0));
        change(&mut message);
        message
    };
    let cases: [(&str, Value); 11] = [
        ("validationError", changed(&|order| order["edges"] = json!([]))),
        ("validationError", changed(&|order| order["nodes"][1]["sequenceId"] = json!(3))),
        ("validationError", changed(&|order| order["nodes"][0]["released"] = json!(false))),
        ("validationError", changed(&|order| order["nodes"][1]["nodePosition"]["x"] = json!("far"))),
        ("validationError", changed(&|order| order["edges"][0]["endNodeId"] = json!("elsewhere"))),
        ("orderError", changed(&|order| order["nodes"][1]["nodePosition"]["mapId"] = json!("roof"))),
        ("orderError", changed(&|order| order["edges"][0]["trajectory"] = json!({"degree": 1}))),
        ("orderError", changed(&|order| order["edges"][0]["maxSpeed"] = json!(0.05))),
        ("orderError", changed(&|order| order["edges"][0]["maxRotationSpeed"] = json!(0.0))),
        ("orderError", changed(&|order| order["edges"][0]["rotationAllowed"] = json!(false))),
        ("orderError", changed(&|order| order["nodes"][0]["nodePosition"]["x"] = json!(50.0))),
    ];
    for (expected, message) in cases {
        let mut robot = Driven::new();
        let state = robot.send(Topic::Order, &message);
        assert_eq!((errors(&state), &state["orderId"]), (vec![expected], &json!("")), "{message}");
        assert!(robot.places.is_empty());
        // An order that is taken ends the report.
        assert!(errors(&robot.send(Topic::Order, &order("c", 0, (0, 2, 0)))).is_empty());
    }
}

#[test]
fn updates_follow_sequence_rules() {
    let mut robot = Driven::new();
    robot.moment.is_automatic = false;
    robot.send(Topic::Order, &order("a", 3, (0, 3, 0)));
    let older = robot.send(Topic::Order, &order("a", 2, (0, 3, 0)));
    assert_eq!((errors(&older), &older["orderUpdateId"]), (vec!["orderUpdateError"], &json!(3)));
    let gap = robot.send(Topic::Order, &order("a", 4, (6, 2, 0)));
    assert_eq!(errors(&gap), ["orderUpdateError", "orderUpdateError"]);
    let other = robot.send(Topic::Order, &order("b", 0, (0, 2, 0)));
    assert_eq!((errors(&other).last(), &other["orderId"]), (Some(&"orderError"), &json!("a")));
}

#[test]
fn cancelled_order_ends_once() {
    let mut robot = Driven::new();
    let state = robot.send(Topic::InstantActions, &instant("cancelOrder", "c0", json!([])));
    assert_eq!(
        (errors(&state), &state["actionStates"][0]["actionStatus"]),
        (vec!["noOrderToCancel"], &json!("FAILED"))
    );
    robot.moment.is_driving = true;
    robot.send(Topic::Order, &order("a", 0, (0, 4, 0)));
    let running = robot.send(Topic::InstantActions, &instant("cancelOrder", "c1", json!([])));
    assert_eq!(running["actionStates"][1]["actionStatus"], "RUNNING");
    robot.moment.is_driving = false;
    let state = robot.step();
    assert_eq!(
        (&state["actionStates"][1]["actionStatus"], &state["orderId"]),
        (&json!("FINISHED"), &json!("a"))
    );
    assert!(
        state["nodeStates"].as_array().unwrap().is_empty() && robot.commands.contains(&VehicleCommand::Stand)
    );
    let update = robot.send(Topic::Order, &order("a", 1, (6, 2, 0)));
    assert_eq!(errors(&update).last(), Some(&"orderUpdateError"));
}

#[test]
fn instant_actions_are_done_once() {
    let mut robot = Driven::new();
    let pause = instant("startPause", "p", json!([]));
    assert_eq!(robot.send(Topic::InstantActions, &pause)["actionStates"][0]["actionStatus"], "RUNNING");
    robot.moment.is_paused = true;
    let state = robot.step();
    assert_eq!(
        (&state["actionStates"][0]["actionStatus"], &state["paused"]),
        (&json!("FINISHED"), &json!(true))
    );
    robot.send(Topic::InstantActions, &pause);
    assert_eq!(robot.commands.iter().filter(|command| **command == VehicleCommand::Pause).count(), 1);
    let place = json!([{"key": "x", "value": 3.0}, {"key": "y", "value": 1.0}, {"key": "theta", "value": 0.5},
        {"key": "mapId", "value": "hall"}, {"key": "lastNodeId", "value": "n9"}]);
    let state = robot.send(Topic::InstantActions, &instant("initPosition", "i", place));
    let here = VehiclePose { x_m: 3.0, y_m: 1.0, heading_rad: 0.5 };
    assert_eq!(
        (&state["lastNodeId"], robot.commands.last()),
        (&json!("n9"), Some(&VehicleCommand::Relocate(here)))
    );
    let state = robot.send(Topic::InstantActions, &instant("fly", "f", json!([])));
    assert_eq!(errors(&state), ["instantActionError"]);
}

#[test]
fn node_actions_block_the_drive() {
    let mut robot = Driven::new();
    let mut message = order("w", 0, (0, 3, 0));
    message["nodes"][1]["actions"] = json!([{"actionType": "wait", "actionId": "w1", "blockingType": "HARD",
        "actionParameters": [{"key": "duration", "value": 2.0}]}]);
    assert_eq!(robot.send(Topic::Order, &message)["actionStates"][0]["actionStatus"], "WAITING");
    robot.step();
    assert_eq!(robot.places, [1.0]);
    let state = robot.step();
    assert_eq!((&state["actionStates"][0]["actionStatus"], robot.places.len()), (&json!("RUNNING"), 1));
    let state = robot.drive();
    assert_eq!((&state["actionStates"][0]["actionStatus"], robot.places.len()), (&json!("FINISHED"), 2));
}

#[test]
fn order_and_queue_outlive_the_program() {
    use crate::queue::{OfflineQueue, Waiting};
    let folder = tempfile::tempdir().unwrap();
    let path = Some(folder.path().to_path_buf());
    let mut agent = FleetAgent::open(vehicle("7"), path.clone()).unwrap();
    let here = VehicleMoment { pose: Some(VehiclePose::default()), ..VehicleMoment::default() };
    agent.attend(here, "");
    agent.receive(Topic::Order, order("a", 0, (0, 3, 0)).to_string().as_bytes());
    let again = FleetAgent::open(vehicle("7"), path).unwrap();
    assert_eq!((again.held().order_id.as_str(), again.held().nodes.len()), ("a", 2));
    let message = |number: u32| Waiting { topic: Topic::State, payload: number.to_string() };
    let mut queue = OfflineQueue::open(Some(folder.path())).unwrap();
    (0..5).for_each(|number| assert!(!queue.push(message(number)).unwrap()));
    queue.leave().unwrap();
    drop(queue);
    // The power went in the middle of a line.
    let file = folder.path().join("queue.log");
    let text = std::fs::read_to_string(&file).unwrap() + "{\"Message\":{\"topic\":\"st";
    std::fs::write(&file, text).unwrap();
    let queue = OfflineQueue::open(Some(folder.path())).unwrap();
    assert_eq!((queue.get(0), queue.get(3), queue.get(4)), (Some(&message(1)), Some(&message(4)), None));
}
