//! What the vehicle sends: state, visualization and connection (chapters 6.10, 6.13 and 6.14).

use serde::{Deserialize, Serialize};

use super::incoming::NodePosition;
use super::topics::Header;

/// How the vehicle is.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct State {
    #[serde(flatten)]
    pub header: Header,
    pub maps: Vec<MapState>,
    pub order_id: String,
    pub order_update_id: u32,
    pub last_node_id: String,
    pub last_node_sequence_id: u32,
    pub node_states: Vec<NodeState>,
    pub edge_states: Vec<EdgeState>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub agv_position: Option<AgvPosition>,
    pub velocity: Velocity,
    pub driving: bool,
    pub paused: bool,
    pub new_base_request: bool,
    pub action_states: Vec<ActionState>,
    pub battery_state: BatteryState,
    pub operating_mode: &'static str,
    pub errors: Vec<Report>,
    pub information: Vec<Information>,
    pub safety_state: SafetyState,
}

/// A map that the vehicle has.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct MapState {
    pub map_id: String,
    pub map_version: String,
    pub map_status: &'static str,
}

/// A node that is still to be reached.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct NodeState {
    pub node_id: String,
    pub sequence_id: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node_position: Option<NodePosition>,
    pub released: bool,
}

/// An edge that is still to be driven.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct EdgeState {
    pub edge_id: String,
    pub sequence_id: u32,
    pub released: bool,
}

/// How far an action is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ActionState {
    pub action_id: String,
    pub action_type: String,
    pub action_status: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub result_description: Option<String>,
}

/// Where the vehicle is.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct AgvPosition {
    pub x: f64,
    pub y: f64,
    pub theta: f64,
    pub map_id: String,
    pub position_initialized: bool,
}

/// How it moves, in its own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Velocity {
    pub vx: f64,
    pub vy: f64,
    pub omega: f64,
}

/// Its battery.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct BatteryState {
    pub battery_charge: f64,
    pub charging: bool,
}

/// An error or warning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Report {
    pub error_type: String,
    pub error_level: String,
    pub error_references: Vec<Reference>,
    pub error_description: String,
}

/// What an error is about.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Reference {
    pub reference_key: String,
    pub reference_value: String,
}

/// Something worth knowing that is no error.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Information {
    pub info_type: String,
    pub info_level: &'static str,
    pub info_description: String,
    pub info_references: Vec<Reference>,
}

/// Emergency stop and fields.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SafetyState {
    pub e_stop: &'static str,
    pub field_violation: bool,
}

/// Where the vehicle is, often.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Visualization {
    #[serde(flatten)]
    pub header: Header,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub agv_position: Option<AgvPosition>,
    pub velocity: Velocity,
}

/// Whether the vehicle is there.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Connection {
    #[serde(flatten)]
    pub header: Header,
    pub connection_state: &'static str,
}
