//! The proof of cleaning: what was cleaned, claimed with which confidence, what not and why; for other programs as JSON and CSV.

use std::fmt::Write as _;

use floorguard_robot::environment::Calendar;
use floorguard_runtime::digest::Fnv64;
use serde::Serialize;

use super::history::History;
use crate::words::Language;
use floorguard_recording::decode::Grid;
use floorguard_recording::mission::DOUBTS;
use floorguard_recording::replay::MISSION;
use floorguard_recording::topics;

/// Version of the fields; see `docs/report.schema.json`.
pub const VERSION: u32 = 1;
/// A cell with less than this share of its dirt before was cleaned, even if it was claimed at the beginning.
const LESS: f32 = 0.9;

/// What the recording does not know: who, which robot, when.
#[derive(Clone, Debug, Default)]
pub struct Circumstances {
    /// Name of the file.
    pub recording: String,
    /// When it was recorded, or when its file was written, in words.
    pub date: String,
    /// Name of the robot, as its owner calls it.
    pub robot: Option<String>,
    /// Who operated it.
    pub operator: Option<String>,
}

/// Why floor is not claimed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct NotClaimed {
    /// In plain words.
    pub reason: String,
    /// Cells of the mission's grid.
    pub cells: u64,
}

/// What the mission came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cleaning {
    /// What it was doing at the end.
    pub phase: String,
    /// Probability with which a cell that is claimed holds no more than what is tolerated, percent.
    pub confidence_percent: Option<f64>,
    /// Dirt that may stay in a cell that is claimed, units.
    pub tolerated_units: Option<u64>,
    /// Cleaned in this mission and claimed, m².
    pub cleaned_m2: f64,
    /// Claimed because no dirt was expected there, m².
    pub assumed_m2: f64,
    /// Not claimed, m².
    pub to_do_m2: f64,
    /// Of the expected dirt, gone, percent.
    pub dirt_gone_percent: f64,
    /// Waited for people, seconds.
    pub waited_s: f64,
    /// Why floor is not claimed.
    pub not_claimed: Vec<NotClaimed>,
}

/// A stop of the run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProofStop {
    /// Seconds since the beginning.
    pub at_s: f64,
    /// Cause in words.
    pub cause: String,
}

/// The report for other programs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Proof {
    /// [`VERSION`].
    pub version: u32,
    /// Name of the recording.
    pub recording: String,
    /// When.
    pub date: String,
    /// Robot: its name, or the fingerprint of its configuration.
    pub robot: String,
    /// Who operated it; empty if unknown.
    pub operator: String,
    /// Software.
    pub software: String,
    /// Map: its size and fingerprint; empty without a mission.
    pub map: String,
    /// Length of the run, seconds.
    pub duration_s: f64,
    /// Driven, metres.
    pub driven_m: f64,
    /// Every stop.
    pub stops: Vec<ProofStop>,
    /// The mission, if there was one.
    pub cleaning: Option<Cleaning>,
}

/// Of a recording; names of robot, software and map in the language, causes and reasons in English, as the recording has them.
#[must_use]
pub fn proof(history: &History, circumstances: &Circumstances, language: Language) -> Proof {
    let text = |key: &str| history.texts.get(key).map(String::as_str);
    let fingerprint = text("robot.toml").map(|toml| language.fill("configuration {}", &[&digest(toml)]));
    Proof {
        version: VERSION,
        recording: circumstances.recording.clone(),
        date: circumstances.date.clone(),
        robot: match (&circumstances.robot, fingerprint) {
            (Some(name), Some(fingerprint)) => format!("{name} ({fingerprint})"),
            (Some(name), None) => name.clone(),
            (None, fingerprint) => fingerprint.unwrap_or_else(|| language.say("unknown").to_owned()),
        },
        operator: circumstances.operator.clone().unwrap_or_default(),
        software: format!("floorguard {}", text("version").unwrap_or(language.say("of an unknown version"))),
        map: text(MISSION).and_then(|mission| map_words(mission, language)).unwrap_or_default(),
        duration_s: history.duration_s,
        driven_m: history.driven_m,
        stops: history
            .stops
            .iter()
            .map(|stop| ProofStop { at_s: stop.at_s, cause: stop.status.name.clone() })
            .collect(),
        cleaning: cleaning(history),
    }
}

fn digest(text: &str) -> String {
    let mut digest = Fnv64::new();
    digest.add(text.as_bytes());
    format!("{:016x}", digest.value())
}

fn map_words(mission: &str, language: Language) -> Option<String> {
    let mission: serde_json::Value = serde_json::from_str(mission).ok()?;
    let map = mission.get("map")?;
    let number = |value: &serde_json::Value| value.as_f64();
    let (width, height) = (number(map.get("size")?.get(0)?)?, number(map.get("size")?.get(1)?)?);
    let edge_m = number(map.get("resolution_m")?)?;
    let size = [(width * edge_m, 1), (height * edge_m, 1), (edge_m, 2)];
    let [width, height, edge] = size.map(|(metres, digits)| language.number(metres, digits));
    let fingerprint = digest(&map.to_string());
    Some(language.fill("{} m x {} m, cells of {} m, fingerprint {}", &[&width, &height, &edge, &fingerprint]))
}

fn cleaning(history: &History) -> Option<Cleaning> {
    let (_, last) = history.mission.last()?;
    let value = |name: &str| last.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str());
    let number = |name: &str| value(name).and_then(|text| text.parse::<f64>().ok()).unwrap_or(0.0);
    let plan: Option<serde_json::Value> =
        history.texts.get(MISSION).and_then(|text| serde_json::from_str(text).ok());
    let planned = |key: &str| plan.as_ref().and_then(|plan| plan.get(key));
    let cells = cells(history);
    let area_m2 = |wanted: &str| {
        let edge_m = history.grids.get(topics::CLAIMED).map_or(0.0, |(_, last)| f64::from(last.resolution_m));
        cells.iter().filter(|cell| cell.state == wanted).count() as f64 * edge_m * edge_m
    };
    let doubts = DOUBTS.iter().map(|(key, words)| (number(key) as u64, (*words).to_owned()));
    let out_of_reach = (number("unreachable_cells") as u64, "dirty, but out of reach".to_owned());
    let not_claimed = doubts.chain([out_of_reach]).filter(|(cells, _)| *cells > 0);
    Some(Cleaning {
        phase: value("state").unwrap_or_default().to_owned(),
        confidence_percent: planned("delta")
            .and_then(serde_json::Value::as_f64)
            .map(|delta| 100.0 * (1.0 - delta)),
        tolerated_units: planned("tolerated_units").and_then(serde_json::Value::as_u64),
        cleaned_m2: area_m2(CLEANED),
        assumed_m2: area_m2(ASSUMED),
        to_do_m2: area_m2(UNSURE) + area_m2(TO_DO),
        dirt_gone_percent: 100.0 * (1.0 - number("dirt_now_units") / number("dirt_before_units").max(1.0e-6)),
        waited_s: number("waited_s"),
        not_claimed: not_claimed.map(|(cells, reason)| NotClaimed { reason, cells }).collect(),
    })
}

pub(super) const CLEANED: &str = "cleaned";
pub(super) const ASSUMED: &str = "assumed clean";
const UNSURE: &str = "not sure";
pub(super) const TO_DO: &str = "to do";

/// A cell of the mission's floor.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Its centre in the map of the mission, metres.
    pub x_m: f32,
    /// See `x_m`.
    pub y_m: f32,
    /// What is claimed of it.
    pub state: &'static str,
    /// Dirt expected before the mission, percent of the dirtiest cell.
    pub before_percent: i8,
    /// Dirt expected at the end, in the same measure.
    pub after_percent: i8,
}

/// Every cell that the mission answers for, row by row from below; none for a run without a mission.
#[must_use]
pub fn cells(history: &History) -> Vec<Cell> {
    let Some((first, last)) = history.grids.get(topics::CLAIMED) else { return Vec::new() };
    let dirt = history.grids.get(topics::DIRT);
    let at = |grid: Option<&Grid>, index: usize| {
        grid.and_then(|grid| grid.cells.get(index)).copied().unwrap_or(-1)
    };
    let cells = last.cells.iter().enumerate().filter(|(_, claimed)| **claimed >= 0);
    cells
        .map(|(index, claimed)| {
            let (before, after) = (at(dirt.map(|it| &it.0), index), at(dirt.map(|it| &it.1), index));
            let was_claimed = at(Some(first), index) >= 100;
            let has_less = before > 0 && f32::from(after) < LESS * f32::from(before);
            let state = match claimed {
                100 if !was_claimed || has_less => CLEANED,
                100 => ASSUMED,
                0 => TO_DO,
                _ => UNSURE,
            };
            let (column, row) = (index % last.width.max(1), index / last.width.max(1));
            let centre = |step: usize| (step as f32 + 0.5) * last.resolution_m;
            Cell {
                x_m: last.origin.x_m + centre(column),
                y_m: last.origin.y_m + centre(row),
                state,
                before_percent: before,
                after_percent: after,
            }
        })
        .collect()
}

impl Proof {
    /// Who, when, with what: names from the table of words, and what is known of each.
    #[must_use]
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let all = [
            ("date", day_and_time(&self.date)),
            ("robot", self.robot.clone()),
            ("operator", self.operator.clone()),
            ("software", self.software.clone()),
            ("map", self.map.clone()),
            ("recording", self.recording.clone()),
        ];
        all.into_iter().filter(|(_, text)| !text.is_empty()).collect()
    }
}

/// The first facts of a page that is made right after its run: date, software, and the robot's fingerprint if there is one.
#[must_use]
pub fn made_now(robot_toml: Option<&str>) -> Vec<(&'static str, String)> {
    let date = Calendar::of_this_computer().iso(Calendar::now());
    let mut rows = vec![
        ("date", day_and_time(&date)),
        ("software", format!("floorguard {}", env!("CARGO_PKG_VERSION"))),
    ];
    rows.extend(robot_toml.map(|toml| ("robot", format!("configuration {}", digest(toml)))));
    rows
}

/// A moment of ISO 8601 for people: day, hour and minute, and how far the clock is from UTC. Anything else stays as it is.
#[must_use]
pub fn day_and_time(iso: &str) -> String {
    let parts = || {
        let (day, rest) = iso.split_once('T')?;
        let (time, zone) = (rest.get(..5)?, rest.get(8..)?);
        let zone = if zone == "+00:00" || zone == "Z" { "" } else { zone };
        Some(format!("{day} {time} UTC{zone}"))
    };
    parts().unwrap_or_else(|| iso.to_owned())
}

/// The cells as comma-separated values with a line of names.
#[must_use]
pub fn cells_csv(cells: &[Cell]) -> String {
    let mut text = "x_m,y_m,state,expected_before_percent,expected_after_percent\n".to_owned();
    for Cell { x_m, y_m, state, before_percent, after_percent } in cells {
        let _ = writeln!(text, "{x_m:.3},{y_m:.3},{state},{before_percent},{after_percent}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_recording::decode::Header;
    use floorguard_types::geometry::Pose2;
    use floorguard_types::time::Stamp;

    fn grid(cells: [i8; 5]) -> Grid {
        Grid {
            header: Header { stamp: Stamp::ZERO, frame: "map".to_owned() },
            resolution_m: 0.5,
            width: 5,
            height: 1,
            origin: Pose2::default(),
            cells: cells.to_vec(),
        }
    }

    fn history() -> History {
        let values = [
            ("state", "done"),
            ("doubt_obstructed_cells", "1"),
            ("dirt_before_units", "100"),
            ("dirt_now_units", "40"),
        ];
        let values = values.map(|(name, value)| (name.to_owned(), value.to_owned())).to_vec();
        let mut history = History { mission: vec![(1.0, values)], ..History::default() };
        let both = |first, last| (grid(first), grid(last));
        history.grids.insert(topics::CLAIMED.to_owned(), both([-1, 100, 100, 0, 0], [-1, 100, 100, 100, 50]));
        history.grids.insert(topics::DIRT.to_owned(), both([-1, 0, 50, 90, 90], [-1, 0, 5, 2, 90]));
        history.texts.insert(MISSION.to_owned(), r#"{"delta":0.01,"tolerated_units":5}"#.to_owned());
        history
    }

    #[test]
    fn dates_are_written_for_people() {
        assert_eq!(day_and_time("2026-11-24T18:00:37+00:00"), "2026-11-24 18:00 UTC");
        assert_eq!(day_and_time("2026-11-24T18:00:37+01:00"), "2026-11-24 18:00 UTC+01:00");
        assert_eq!(day_and_time("on a Tuesday"), "on a Tuesday");
    }

    #[test]
    fn assumed_floor_is_not_sold_as_cleaned() {
        let cells = cells(&history());
        let states: Vec<_> = cells.iter().map(|cell| cell.state).collect();
        assert_eq!(states, [ASSUMED, CLEANED, CLEANED, UNSURE]);
        let proof = proof(&history(), &Circumstances::default(), Language::English);
        let cleaning = proof.cleaning.expect("a mission");
        assert_eq!((cleaning.cleaned_m2, cleaning.assumed_m2, cleaning.to_do_m2), (0.5, 0.25, 0.25));
        assert_eq!(cleaning.confidence_percent, Some(99.0));
        assert_eq!(cleaning.not_claimed.len(), 1);
        assert!(cells_csv(&cells).contains("0.750,0.250,assumed clean,0,0\n"));
    }

    /// The schema in the documents names every field and no other.
    #[test]
    fn schema_names_the_fields() {
        let schema: serde_json::Value =
            serde_json::from_str(include_str!("../../../../docs/report.schema.json")).expect("JSON");
        let proof = serde_json::to_value(proof(&history(), &Circumstances::default(), Language::English))
            .expect("JSON");
        let names = |value: &serde_json::Value| -> Vec<String> {
            let mut names: Vec<_> = value.as_object().expect("an object").keys().cloned().collect();
            names.sort();
            names
        };
        assert_eq!(names(&schema["properties"]), names(&proof));
        let cleaning = &schema["$defs"]["cleaning"]["properties"];
        assert_eq!(names(cleaning), names(&proof["cleaning"]));
    }
}
