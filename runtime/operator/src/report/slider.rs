//! A slider over the run: it moves the robot and the people on the map of the report, and shows what surrounded the robot.

use floorguard_types::geometry::Point2;

use super::close_up;
use super::history::History;
use super::sketch;
use crate::words::Language;

/// Moves what is drawn in the group `now` of the map, and draws the moment's picture beside the slider; without scripts the map
/// shows the whole run.
const SCRIPT: &str = include_str!("slider.js");

/// The slider with its script; nothing for a recording without odometry.
pub fn slider(history: &History, footprint: &[Point2], language: Language) -> String {
    if history.sightings.len() < 2 {
        return String::new();
    }
    let stops: Vec<(f64, String)> =
        history.stops.iter().map(|stop| (stop.at_s, language.begin(&stop.status.name))).collect();
    // Nothing in the texts may end the script.
    let stops = serde_json::to_string(&stops).unwrap_or_default().replace('<', "\\u003c");
    let last = serde_json::to_string(language.say("last stop: {}")).unwrap_or_default();
    let (moments, pixels_per_m) = sketch::moments(history);
    format!(
        "<div class=slide><label for=moment>{}</label><input id=moment type=range min=0 value=0 step=1><output \
         for=moment></output><svg id=close viewBox=\"0 0 300 300\" role=img aria-label=\"{}\"></svg></div><script>const \
         MOMENTS={moments},PX={pixels_per_m:.3},FIELDS={},BODY={},STOPS={stops},LAST={last};{SCRIPT}</script>",
        language.say("moment"),
        language.say("what surrounded the robot at this moment"),
        close_up::outlines(&history.fields),
        close_up::outline(footprint),
    )
}
