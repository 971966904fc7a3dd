//! Whether an order can be carried out: its form, and what this vehicle can do (VDA 5050 2.1.0, chapters 6.6.2 and 6.6.4).

use std::collections::BTreeSet;

use super::cleaning::{CLEAN_ACTION, refused_cleaning};
use super::messages::{Action, Node, Order, OrderEdge, Reference, Report};
use super::vehicle::VehicleDescription;

/// What this vehicle does at nodes: it stands for so many seconds, parameter `duration`.
pub const WAIT_ACTION: &str = "wait";
/// Instant actions that this vehicle knows.
pub const INSTANT_ACTIONS: [&str; 7] = [
    "startPause",
    "stopPause",
    "cancelOrder",
    "initPosition",
    "stateRequest",
    "factsheetRequest",
    "logReport",
];
/// An order has at most so many nodes, as the factsheet says.
pub const NODES_MAX: usize = 1_000;
/// Actions at a node at most.
pub const NODE_ACTIONS_MAX: usize = 16;
/// Longest identifier, characters.
pub const IDENTIFIER_MAX: usize = 256;
/// Farther from the origin is no place, metres.
const PLACE_MAX_M: f64 = 1.0e5;
/// Fields of edges that this vehicle, which finds its own way, cannot use.
const UNUSABLE: [&str; 5] = ["trajectory", "corridor", "orientation", "orientationType", "direction"];
/// More slowly this vehicle cannot drive, m/s, and turn, rad/s: it would count as standing.
const SLOWEST: (f64, f64) = (0.1, 0.1);

/// An error of the vehicle with what it is about.
pub fn report(kind: &str, words: impl Into<String>, references: &[(&str, &str)]) -> Report {
    let reference = |(key, value): &(&str, &str)| Reference {
        reference_key: (*key).to_owned(),
        reference_value: (*value).to_owned(),
    };
    Report {
        error_type: kind.to_owned(),
        error_level: "WARNING".to_owned(),
        error_references: references.iter().map(reference).collect(),
        error_description: words.into(),
    }
}

/// A refusal of an order, which is named.
pub fn refusal(kind: &str, order: &Order, words: impl Into<String>, more: &[(&str, &str)]) -> Report {
    let update = order.order_update_id.to_string();
    let named =
        [("topic", "order"), ("orderId", order.order_id.as_str()), ("orderUpdateId", update.as_str())];
    report(kind, words, &[&named[..], more].concat())
}

/// The form of an order.
///
/// # Errors
/// `validationError` with what is wrong.
pub fn validate(order: &Order) -> Result<(), Report> {
    let wrong = |words: String| Err(refusal("validationError", order, words, &[]));
    if order.nodes.is_empty() || order.nodes.len() > NODES_MAX {
        return wrong(format!("an order has 1 to {NODES_MAX} nodes, this one {}", order.nodes.len()));
    }
    if order.edges.len() + 1 != order.nodes.len() {
        return wrong(format!("{} nodes need {} edges", order.nodes.len(), order.nodes.len() - 1));
    }
    if !order.nodes.first().is_some_and(|node| node.released) {
        return wrong("the first node is not released".to_owned());
    }
    let first = order.nodes.first().map_or(0, |node| node.sequence_id);
    if !first.is_multiple_of(2) {
        return wrong(format!("the sequenceId {first} of a node is odd"));
    }
    let sequence = order.nodes.iter().map(|node| node.sequence_id).zip((first..).step_by(2));
    if let Some((found, expected)) = sequence.into_iter().find(|(found, expected)| found != expected) {
        return wrong(format!("a node has the sequenceId {found} where {expected} comes"));
    }
    for (edge, ends) in order.edges.iter().zip(order.nodes.windows(2)) {
        let [start, end] = ends else { continue };
        if edge.sequence_id != start.sequence_id + 1 {
            return wrong(format!("the edge {} has the sequenceId {}", edge.edge_id, edge.sequence_id));
        }
        if edge.start_node_id != start.node_id || edge.end_node_id != end.node_id {
            return wrong(format!(
                "the edge {} does not join {} and {}",
                edge.edge_id, start.node_id, end.node_id
            ));
        }
        if edge.released != end.released || (end.released && !start.released) {
            return wrong(format!("{} is released and what leads there is not, or the reverse", end.node_id));
        }
    }
    let mut names = BTreeSet::new();
    let actions = order.nodes.iter().flat_map(|node| &node.actions);
    match actions.map(|action| action.action_id.as_str()).find(|name| !names.insert(*name)) {
        Some(name) => wrong(format!("the actionId {name} comes twice")),
        None => Ok(()),
    }
}

/// What this vehicle can do of an order.
///
/// # Errors
/// `orderError` with the field that it cannot use.
pub fn usable(order: &Order, vehicle: &VehicleDescription) -> Result<(), Report> {
    order.nodes.iter().try_for_each(|node| usable_node(order, node, vehicle))?;
    order.edges.iter().try_for_each(|edge| usable_edge(order, edge, vehicle))
}

fn usable_node(order: &Order, node: &Node, vehicle: &VehicleDescription) -> Result<(), Report> {
    let wrong = |words: String, field: &str| {
        Err(refusal("orderError", order, words, &[("nodeId", &node.node_id), ("field", field)]))
    };
    if node.node_id.len() > IDENTIFIER_MAX || node.actions.len() > NODE_ACTIONS_MAX {
        return wrong("more than the factsheet permits".to_owned(), "nodeId");
    }
    let Some(position) = &node.node_position else {
        return wrong(
            "this vehicle has no nodes of its own: it needs nodePosition".to_owned(),
            "nodePosition",
        );
    };
    if position.map_id != vehicle.map_id {
        return wrong(format!("this vehicle is on the map {}", vehicle.map_id), "mapId");
    }
    let numbers = [position.x, position.y, position.theta.unwrap_or(0.0)];
    if numbers.iter().any(|number| !number.is_finite() || number.abs() > PLACE_MAX_M) {
        return wrong("no place on a map".to_owned(), "nodePosition");
    }
    let refused = |action: &Action| Some((action.action_id.clone(), refused_action(action, vehicle)?));
    match node.actions.iter().find_map(refused) {
        Some((name, words)) => {
            let of = [("nodeId", node.node_id.as_str()), ("field", "actions"), ("actionId", &name)];
            Err(refusal("orderError", order, words, &of))
        }
        None => Ok(()),
    }
}

/// Why this vehicle does not do an action at a node.
fn refused_action(action: &Action, vehicle: &VehicleDescription) -> Option<String> {
    let kind = action.action_type.as_str();
    if !matches!(action.blocking_type.as_str(), "NONE" | "SOFT" | "HARD") {
        return Some(format!("{} is no blockingType", action.blocking_type));
    }
    match kind {
        CLEAN_ACTION => refused_cleaning(action, &vehicle.cleaning),
        WAIT_ACTION => {
            let is_given =
                action.number("duration").is_some_and(|seconds| (0.0..=86_400.0).contains(&seconds));
            (!is_given).then(|| "wait needs duration, seconds up to 86400".to_owned())
        }
        _ => Some(format!("this vehicle does no {kind} at a node; it does {CLEAN_ACTION} and {WAIT_ACTION}")),
    }
}

fn usable_edge(order: &Order, edge: &OrderEdge, vehicle: &VehicleDescription) -> Result<(), Report> {
    let wrong = |words: &str, field: &str| {
        Err(refusal("orderError", order, words, &[("edgeId", &edge.edge_id), ("field", field)]))
    };
    if !edge.actions.is_empty() {
        return wrong("this vehicle does nothing on edges; put the action at a node", "actions");
    }
    let is_under = |limit: Option<f64>, least: f64| limit.is_some_and(|limit| limit < least);
    if is_under(edge.max_speed, SLOWEST.0) {
        return wrong("more slowly than 0.1 m/s this vehicle cannot drive", "maxSpeed");
    }
    if is_under(edge.max_rotation_speed, SLOWEST.1) {
        return wrong("more slowly than 0.1 rad/s this vehicle cannot turn", "maxRotationSpeed");
    }
    if edge.rotation_allowed == Some(false) {
        return wrong("this vehicle cannot drive to a place without turning", "rotationAllowed");
    }
    if edge.max_height.is_some_and(|limit_m| limit_m < vehicle.size_m[2]) {
        return wrong("this vehicle is taller", "maxHeight");
    }
    let given = |field: &&&str| edge.other.get(**field).is_some_and(|value| !value.is_null());
    match UNUSABLE.iter().find(given) {
        Some(field) => wrong("this vehicle finds its own way between nodes", field),
        None => Ok(()),
    }
}
