//! A robot in short, for the page of another one.

use serde_json::{Value, json};

use super::frame::Frame;

/// State, headline as on the panel, how far the mission is, charge, and how many alerts wait to be acknowledged.
pub fn brief(frame: &Frame, alerts: usize) -> Value {
    let mission = frame.mission.as_ref().map(|mission| {
        json!({"phase": mission.phase, "cleaned_m2": mission.cleaned_m2, "to_do_m2": mission.remaining_m2})
    });
    json!({
        "title": frame.title,
        "state": frame.state,
        "paused": frame.paused,
        "headline_parts": frame.headline_parts,
        "holder": frame.holder,
        "stops_itself": frame.limit_mps <= 0.0,
        "mission": mission,
        "charge_percent": frame.supplies.as_ref().and_then(|supplies| supplies.charge_percent),
        "alerts": alerts,
    })
}
