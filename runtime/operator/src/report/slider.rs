//! A slider over the run: it moves the robot and the people on the map of the report.

use super::history::History;
use super::sketch;
use crate::words::Language;

/// Moves what is drawn in the group `now` of the map; without scripts the map shows the whole run.
const SCRIPT: &str = r##"
const slide = document.querySelector(".slide input"), shown = document.querySelector(".slide output"), now = document.getElementById("now");
const number = (value, digits) => value.toLocaleString(document.documentElement.lang, {minimumFractionDigits: digits, maximumFractionDigits: digits});
function at(i) {
  const [t, x, y, turn, v, people] = MOMENTS[i];
  let svg = `<g transform="translate(${x} ${y}) rotate(${turn})"><path d="M-12 -9H8L18 0L8 9H-12z" fill="#0b5394" stroke="#fff" stroke-width="2"/></g>`;
  for (let k = 0; k < people.length; k += 3) svg += `<circle cx="${people[k]}" cy="${people[k + 1]}" r="9" fill="#b34700" stroke="#fff" stroke-width="2"/>`;
  now.innerHTML = svg;
  let held = "";
  for (const [from, cause] of STOPS) if (from <= t) held = cause;
  shown.textContent = number(t, 1) + " s, " + number(v, 2) + " m/s" + (Math.abs(v) < 0.02 && held ? ", " + LAST.replace("{}", held) : "");
  slide.setAttribute("aria-valuetext", shown.textContent);
}
slide.max = MOMENTS.length - 1;
slide.oninput = () => at(+slide.value);
at(0);
"##;

/// The slider with its script; nothing for a recording without odometry.
pub fn slider(history: &History, language: Language) -> String {
    if history.sightings.len() < 2 {
        return String::new();
    }
    let stops: Vec<(f64, String)> =
        history.stops.iter().map(|stop| (stop.at_s, language.begin(&stop.status.name))).collect();
    // Nothing in the texts may end the script.
    let stops = serde_json::to_string(&stops).unwrap_or_default().replace('<', "\\u003c");
    let last = serde_json::to_string(language.say("last stop: {}")).unwrap_or_default();
    format!(
        "<div class=slide><label for=moment>{}</label><input id=moment type=range min=0 value=0 step=1><output \
         for=moment></output></div><script>const MOMENTS={},STOPS={stops},LAST={last};{SCRIPT}</script>",
        language.say("moment"),
        sketch::moments(history)
    )
}
