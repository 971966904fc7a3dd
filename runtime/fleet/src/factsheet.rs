//! What the vehicle is (VDA 5050 2.1.0, chapter 6.15).

use serde_json::{Value, json};

use super::cleaning::described;
use super::rules::{IDENTIFIER_MAX, INSTANT_ACTIONS, NODE_ACTIONS_MAX, NODES_MAX, WAIT_ACTION};
use super::vehicle::{Cleaning, VehicleDescription};

/// The factsheet without its header.
pub fn factsheet(vehicle: &VehicleDescription) -> Value {
    let [length_m, width_m, height_m] = vehicle.size_m;
    let [acceleration, deceleration] = vehicle.acceleration_max_mps2;
    let corners: Vec<Value> = vehicle.outline_m.iter().map(|[x, y]| json!({"x": x, "y": y})).collect();
    json!({
        "typeSpecification": {
            "seriesName": "floorguard",
            "seriesDescription": "a robot that scrubs floors among people",
            "agvKinematic": "THREEWHEEL", "agvClass": "CARRIER", "maxLoadMass": 0.0,
            "localizationTypes": ["NATURAL"], "navigationTypes": ["AUTONOMOUS"],
        },
        "physicalParameters": {
            "speedMin": 0.0, "speedMax": vehicle.speed_max_mps, "accelerationMax": acceleration,
            "decelerationMax": deceleration, "heightMin": height_m, "heightMax": height_m, "width": width_m,
            "length": length_m,
        },
        "protocolLimits": {
            "maxStringLens": {"idLen": IDENTIFIER_MAX},
            "maxArrayLens": {
                "order.nodes": NODES_MAX, "order.edges": NODES_MAX - 1, "node.actions": NODE_ACTIONS_MAX,
                "edge.actions": 0, "trajectory.knotVector": 0, "trajectory.controlPoints": 0,
            },
            "timing": {"minOrderInterval": 0.1, "minStateInterval": 0.1, "defaultStateInterval": 10.0, "visualizationInterval": 1.0},
        },
        "protocolFeatures": {"optionalParameters": optional_parameters(), "agvActions": actions(vehicle)},
        "agvGeometry": {"envelopes2d": [{"set": "body", "polygonPoints": corners}]},
        "loadSpecification": {},
    })
}

fn optional_parameters() -> Value {
    json!([
        {"parameter": "order.nodes.nodePosition", "support": "REQUIRED"},
        {"parameter": "order.nodes.nodePosition.theta", "support": "SUPPORTED"},
        {"parameter": "order.nodes.nodePosition.allowedDeviationXY", "support": "SUPPORTED"},
        {"parameter": "order.nodes.nodePosition.allowedDeviationTheta", "support": "SUPPORTED"},
        {"parameter": "order.edges.maxSpeed", "support": "SUPPORTED"},
        {"parameter": "order.edges.maxRotationSpeed", "support": "SUPPORTED"},
        {"parameter": "order.edges.maxHeight", "support": "SUPPORTED"},
    ])
}

fn actions(vehicle: &VehicleDescription) -> Vec<Value> {
    let instant = INSTANT_ACTIONS.iter().map(|kind| json!({"actionType": kind, "actionScopes": ["INSTANT"]}));
    let wait = json!({
        "actionType": WAIT_ACTION, "actionDescription": "stands for some seconds", "actionScopes": ["NODE"],
        "actionParameters": [{"key": "duration", "valueDataType": "NUMBER", "description": "seconds"}],
    });
    let clean = match &vehicle.cleaning {
        Cleaning::Offered(promise) => Some(described(*promise)),
        Cleaning::Refused(_) => None,
    };
    instant.chain(std::iter::once(wait)).chain(clean).collect()
}
