//! Orders of a master that speaks with the agent itself, without a broker, while the robot really drives and cleans in virtual time.

use std::sync::{Arc, Mutex};

use floorguard_configuration::FleetConfiguration;
use floorguard_fleet::{FleetAgent, Topic, VehicleCommand, VehicleMoment};
use floorguard_laboratory::judge::Outcome;
use floorguard_laboratory::world::{Observation, Observer, Plan, run_recorded};
use floorguard_operator::telemetry::RunSinks;
use floorguard_robot::cleaner::CellState;
use floorguard_sim::scenario::Scenario;
use floorguard_types::geometry::Point2;
use serde_json::{Value, json};

use super::super::opening::{CleaningOffer, FleetOpening};
use super::{FleetSide, Joined, describe};

/// What a master does when it has read a state: messages to the robot.
type Reaction = Box<dyn FnMut(&Value) -> Vec<(Topic, Value)> + Send>;

/// A master and the robot's agent in one.
struct Master {
    agent: FleetAgent,
    reaction: Reaction,
    states: Arc<Mutex<Vec<Value>>>,
}

impl FleetSide for Master {
    fn attend(&mut self, moment: VehicleMoment) -> Vec<VehicleCommand> {
        let outcome = self.agent.attend(moment, "2026-11-30T04:00:00.000Z");
        let mut commands = outcome.commands;
        for message in outcome.messages.iter().filter(|message| message.topic == Topic::State) {
            let state: Value = serde_json::from_str(&message.payload).unwrap();
            for (topic, answer) in (self.reaction)(&state) {
                commands.extend(self.agent.receive(topic, answer.to_string().as_bytes()).commands);
            }
            self.states.lock().unwrap().push(state);
        }
        commands
    }

    fn keeps_wall_time(&self) -> bool {
        false
    }
}

fn node(index: usize, x_m: f64, actions: Value) -> Value {
    json!({"nodeId": format!("n{index}"), "sequenceId": 2 * index, "released": true, "actions": actions,
        "nodePosition": {"x": x_m, "y": 0.0, "mapId": "map", "allowedDeviationXY": 0.4}})
}

/// From the door along the aisle; at its middle the robot cleans a piece of the floor, and then it drives on, slowly.
fn order() -> Value {
    let area = json!([{"key": "area", "value": [[2.0, -1.0], [4.0, 1.0]]}]);
    let clean =
        json!([{"actionType": "clean", "actionId": "c1", "blockingType": "HARD", "actionParameters": area}]);
    let edge = |index: usize, limit_mps: f64| {
        json!({"edgeId": format!("e{index}"), "sequenceId": 2 * index + 1, "released": true, "actions": [],
            "startNodeId": format!("n{index}"), "endNodeId": format!("n{}", index + 1), "maxSpeed": limit_mps})
    };
    json!({"headerId": 1, "timestamp": "2026-11-30T04:00:00.000Z", "version": "2.1.0", "manufacturer": "floorguard",
        "serialNumber": "robot-7", "orderId": "o1", "orderUpdateId": 0,
        "nodes": [node(0, 0.0, json!([])), node(1, 2.5, clean), node(2, 8.0, json!([]))],
        "edges": [edge(0, 2.0), edge(1, 0.25)]})
}

fn instant(kind: &str) -> (Topic, Value) {
    let message = json!({"headerId": 1, "timestamp": "2026-11-30T04:00:00.000Z", "version": "2.1.0", "manufacturer": "floorguard",
        "serialNumber": "robot-7", "actions": [{"actionType": kind, "actionId": kind, "blockingType": "NONE"}]});
    (Topic::InstantActions, message)
}

fn status(state: &Value, name: &str) -> String {
    let found = state["actionStates"].as_array().unwrap().iter().find(|one| one["actionId"] == name);
    found.map_or(String::new(), |one| one["actionStatus"].as_str().unwrap().to_owned())
}

/// A robot in the supermarket at night, where nobody walks, and everything that its master read.
fn played(seconds: f64, mut reaction: impl FnMut(&Value) -> Vec<(Topic, Value)> + Send + 'static) -> Played {
    let mut scenario = Scenario::named("supermarket").unwrap();
    scenario.person.clear();
    let plan = Plan::of("supermarket", scenario, 1, (seconds * 1.0e6) as u64).unwrap();
    let plan = plan.ordered().unwrap().cleaning_on_order().unwrap();
    let fleet = FleetConfiguration::at("nowhere".to_owned(), 1_883, "robot-7".to_owned());
    let mission = plan.mission.as_ref().unwrap();
    let opening = FleetOpening {
        fleet: &fleet,
        folder: None,
        robot: &plan.robot,
        settings: plan.navigation_settings,
        orders: plan.drive_orders.clone().unwrap(),
        cleaning: Ok(CleaningOffer::of(mission, plan.cleaning_orders.clone()).unwrap()),
    };
    let mut is_ordered = false;
    let states: Arc<Mutex<Vec<Value>>> = Arc::default();
    let master = Master {
        agent: FleetAgent::open(describe(&opening), None).unwrap(),
        reaction: Box::new(move |state| {
            let first = (!std::mem::replace(&mut is_ordered, true)).then(|| (Topic::Order, order()));
            first.into_iter().chain(reaction(state)).collect()
        }),
        states: states.clone(),
    };
    let mut sinks = RunSinks::default();
    sinks.links.push(Box::new(Joined::new(master, opening)));
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_recorded(&plan, &mut observer, &mut sinks).unwrap();
    let states = std::mem::take(&mut *states.lock().unwrap());
    Played { observation: observer.into_observation(), states }
}

struct Played {
    observation: Observation,
    states: Vec<Value>,
}

impl Played {
    fn statuses(&self, name: &str) -> Vec<String> {
        let mut all: Vec<String> = self.states.iter().map(|state| status(state, name)).collect();
        all.retain(|status| !status.is_empty());
        all.dedup();
        all
    }
}

#[test]
fn ordered_area_is_cleaned_on_the_way() {
    let played = played(240.0, |_| Vec::new());
    assert_eq!(played.statuses("c1"), ["WAITING", "INITIALIZING", "RUNNING", "FINISHED"]);
    let last = played.states.last().unwrap();
    assert_eq!((&last["lastNodeId"], &last["errors"]), (&json!("n2"), &json!([])), "{last}");
    assert!((last["agvPosition"]["x"].as_f64().unwrap() - 8.0).abs() < 0.6, "{last}");
    // The judge looks at what really lies there.
    let verdict = &played.observation.verdict;
    assert_eq!(verdict.verdict, Outcome::Good, "{}", verdict.reason);
    let mission = played.observation.mission.as_ref().unwrap();
    let report = &mission.report;
    assert!(report.finished && report.dirty_cells > 5, "{report:?}");
    assert_eq!((report.claimed_cells, report.falsely_claimed_cells), (report.dirty_cells, 0), "{report:?}");
    let is_own = |place: Point2| (2.0..=4.0).contains(&place.x_m) && (-1.0..=1.0).contains(&place.y_m);
    let cells = mission.progress.cells.iter().enumerate();
    let mut answered = cells.filter(|(_, state)| **state != CellState::OffLimits);
    assert!(answered.all(|(cell, _)| is_own(mission.progress.geometry.centre(cell))));
    let words = last["actionStates"][0]["resultDescription"].as_str().unwrap();
    assert!(words.contains(&format!("{0} of {0} dirty cells are clean", report.dirty_cells)), "{words}");
    assert!(words.contains("5 units at most") && words.contains("99.0 %"), "{words}");
    // The second edge is driven no faster than it may be.
    let after = played.states.iter().filter(|state| status(state, "c1") == "FINISHED");
    let fastest = after.filter_map(|state| state["velocity"]["vx"].as_f64()).fold(0.0, f64::max);
    assert!((0.1..0.28).contains(&fastest), "{fastest} m/s");
}

#[test]
fn paused_cleaning_goes_on_cancelled_one_ends() {
    let (mut running, mut paused) = (0, 0);
    let played = played(150.0, move |state| match status(state, "c1").as_str() {
        "RUNNING" => {
            running += 1;
            match (running, paused) {
                (2, 0) => vec![instant("startPause")],
                (5, 1..) => vec![instant("cancelOrder")],
                _ => Vec::new(),
            }
        }
        "PAUSED" => {
            paused += 1;
            if paused == 2 { vec![instant("stopPause")] } else { Vec::new() }
        }
        _ => Vec::new(),
    });
    assert_eq!(played.statuses("c1"), ["WAITING", "INITIALIZING", "RUNNING", "PAUSED", "RUNNING", "FAILED"]);
    for kind in ["startPause", "stopPause", "cancelOrder"] {
        assert_eq!(played.statuses(kind).last().map(String::as_str), Some("FINISHED"), "{kind}");
    }
    let paused = || played.states.iter().filter(|state| status(state, "c1") == "PAUSED");
    assert!(paused().any(|state| state["paused"] == true && state["driving"] == false));
    assert!(paused().all(|state| state["lastNodeId"] == "n1"));
    let last = played.states.last().unwrap();
    assert_eq!(
        (&last["driving"], &last["lastNodeId"]),
        (&json!(false), &json!("n1")),
        "it stands where it was"
    );
    let words = last["actionStates"][0]["resultDescription"].as_str().unwrap();
    assert!(words.starts_with("the order was cancelled; ") && words.contains("dirty cells"), "{words}");
    let counts = &played.observation.verdict.bodies.counts;
    assert_eq!(counts.went_on, 0);
}
