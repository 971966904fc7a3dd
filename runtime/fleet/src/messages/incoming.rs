//! What a master sends: orders and instant actions (chapters 6.6.6 and 6.9). Fields that this vehicle cannot use are read all the same,
//! so that an order with them can be refused.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// An order, or an update of one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Order {
    /// For whom it is.
    pub serial_number: String,
    /// For whom it is.
    pub manufacturer: String,
    /// Its name.
    pub order_id: String,
    /// Counts the updates of it.
    pub order_update_id: u32,
    /// Places, in order.
    pub nodes: Vec<Node>,
    /// Ways between them.
    pub edges: Vec<OrderEdge>,
}

/// A place of an order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Node {
    /// Its name.
    pub node_id: String,
    /// Its place in the order: even.
    pub sequence_id: u32,
    /// In words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node_description: Option<String>,
    /// Of the base: it may be driven to.
    pub released: bool,
    /// Where it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node_position: Option<NodePosition>,
    /// What to do there.
    #[serde(default)]
    pub actions: Vec<Action>,
}

/// Where a node is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct NodePosition {
    /// Metres.
    pub x: f64,
    /// Metres.
    pub y: f64,
    /// Radians; without it any heading.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub theta: Option<f64>,
    /// Reached within, metres.
    #[serde(default, skip_serializing, rename = "allowedDeviationXY")]
    pub allowed_deviation_xy: Option<f64>,
    /// And within, radians.
    #[serde(default, skip_serializing)]
    pub allowed_deviation_theta: Option<f64>,
    /// Of which map.
    pub map_id: String,
}

/// A way between two nodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct OrderEdge {
    /// Its name.
    pub edge_id: String,
    /// Its place in the order: odd.
    pub sequence_id: u32,
    /// Of the base.
    pub released: bool,
    /// Where it begins.
    pub start_node_id: String,
    /// Where it ends.
    pub end_node_id: String,
    /// Greatest speed, m/s.
    #[serde(default)]
    pub max_speed: Option<f64>,
    /// Greatest height of the vehicle, metres.
    #[serde(default)]
    pub max_height: Option<f64>,
    /// Greatest turning rate, rad/s.
    #[serde(default)]
    pub max_rotation_speed: Option<f64>,
    /// Turning on it is allowed.
    #[serde(default)]
    pub rotation_allowed: Option<bool>,
    /// What to do on it.
    #[serde(default)]
    pub actions: Vec<Action>,
    /// Everything else.
    #[serde(flatten)]
    pub other: serde_json::Map<String, Value>,
}

/// Something to do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Action {
    /// Its kind.
    pub action_type: String,
    /// Its name, unique.
    pub action_id: String,
    /// NONE, SOFT or HARD.
    pub blocking_type: String,
    /// Values by name.
    #[serde(default)]
    pub action_parameters: Vec<Parameter>,
}

/// A value of an action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Its name.
    pub key: String,
    /// The value.
    pub value: Value,
}

impl Action {
    /// A value by its name.
    pub fn value(&self, key: &str) -> Option<&Value> {
        self.action_parameters.iter().find(|parameter| parameter.key == key).map(|parameter| &parameter.value)
    }

    /// A number by its name.
    pub fn number(&self, key: &str) -> Option<f64> {
        self.value(key)?.as_f64()
    }
}

/// Actions to carry out at once.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct InstantActions {
    /// For whom they are.
    pub serial_number: String,
    /// The actions.
    pub actions: Vec<Action>,
}
