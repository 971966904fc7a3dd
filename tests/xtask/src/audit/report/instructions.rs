//! Instructions of each stage on the emulated Cortex-M7, in words that need no knowledge of the code.

use serde_json::Value;

use super::table::{Table, code, escape, grouped, verdict};
use crate::firmware::BUDGETS;

/// What is counted.
const STAGES: &[(&str, &str)] = &[
    ("can-frame", "a frame of the bus, from its arrival to the guard's answer"),
    ("imu-bytes", "a sample of the inertial sensor, decoded and given to odometry and guard"),
    (
        "lidar-packet",
        "a packet of the lidar, decoded and judged by the guard: the longest step of a stop by the lidar",
    ),
    ("scanner-bytes", "a portion of the scanner's line, with all telegrams that end in it"),
    ("stage-build", "a packet entered into the picture of the whole turn"),
    ("stage-decode", "a packet checked and turned into distances"),
    ("stage-features", "all clusters of a turn measured and judged: person or not"),
    ("stage-floor", "the floor found in a turn"),
    ("stage-floor-clusters", "the floor found, and what stands on it parted into clusters"),
    ("stage-guard-packet", "the guard's decision on a packet: is the protective field free?"),
    ("stage-guard-scan", "the guard's decision on a scan of the safety scanner"),
    ("stage-track", "people followed from turn to turn"),
    ("sweep", "all perception of a turn of the lidar, ten times a second"),
    ("tick", "the guard's clock: ages of all sources, limits, order to the drives"),
];
/// Ends the names of what is counted with twelve people around the robot.
const CROWD: &str = "-12-people";

/// What is counted under a name.
fn told(name: &str) -> String {
    let (plain, crowd) =
        name.strip_suffix(CROWD).map_or((name, ""), |plain| (plain, ", twelve people around"));
    STAGES
        .iter()
        .find(|(stage, _)| *stage == plain)
        .map_or_else(String::new, |(_, words)| format!("{words}{crowd}"))
}

/// Most instructions of the worst input that was searched for a stage, with the seed of the search.
fn worst_of(worst: Option<&Value>, stage: &str) -> Option<(u64, String)> {
    let kept = worst?.as_array()?.iter().find(|kept| kept["stage"] == stage)?;
    let search = format!("{} scenes, seed {}", kept["trials"], kept["seed"]);
    Some((kept["instructions"].as_u64()?, escape(&search)))
}

/// A budget, and whether the most that was seen or searched keeps to it: in words, not in colours alone.
fn kept(most: u64, budget: u64) -> String {
    let good = most <= budget;
    verdict(good, &format!("{}, {}", grouped(budget), if good { "kept" } else { "missed" }))
}

/// A row for each stage.
pub fn section(firmware: Option<&Value>, worst: Option<&Value>) -> String {
    let Some(firmware) = firmware else {
        return String::from(
            "<p>No record of them: <code>cargo xtask firmware --update</code> measures.</p>",
        );
    };
    let number = |value: &Value| value.as_u64().map_or_else(|| String::from("?"), grouped);
    let mut table =
        Table::new(&["stage", "what it is", "times", "mean", "most", "worst input", "searched in", "budget"]);
    for (name, cost) in firmware["instructions"].as_object().into_iter().flatten() {
        let (searched, how) = worst_of(worst, name).unzip();
        let most = searched.unwrap_or(0).max(cost["max"].as_u64().unwrap_or(0));
        let budget = BUDGETS.iter().find(|(stage, _)| stage == name).map(|(_, budget)| *budget);
        table.row(&[
            code(name),
            escape(&told(name)),
            number(&cost["count"]),
            number(&cost["mean"]),
            number(&cost["max"]),
            searched.map_or_else(String::new, grouped),
            how.unwrap_or_default(),
            budget.map_or_else(|| String::from("none"), |budget| kept(most, budget)),
        ]);
    }
    format!(
        "<p>Instructions, not cycles, of one recorded mission. Host and Cortex-M7 gave the same outputs, with the fingerprint \
         {}; <code>cargo xtask firmware</code> repeats both and fails when the fingerprints differ, or a count differs by more \
         than 0.5 % from the recorded one.</p><p>A worst input is a room that a search made as costly as it could, climbing on \
         these very counts: it proves no bound. A budget is missed where the most \
         of the mission or the worst input is above it; budgets are aims and no claim. \
         What has none is part of a stage that has one, or perception, which the guard never waits for: a turn that comes too \
         late is left out, and a source that falls silent stops the robot (FG-HAZ-02).</p>{}",
        code(firmware["digest"].as_str().unwrap_or("?")),
        table.finish()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_that_is_counted_is_explained() {
        let path = crate::shell::root().join("tests/goldens/firmware.json");
        let golden: Value =
            serde_json::from_str(&std::fs::read_to_string(path).expect("a file")).expect("JSON");
        let names = golden["instructions"].as_object().expect("stages").keys();
        let silent: Vec<_> = names.filter(|name| told(name).is_empty()).collect();
        assert!(silent.is_empty(), "{silent:?}");
        assert!(kept(5, 5).contains("5, kept") && kept(6, 5).contains("5, missed"));
        assert!(told("sweep-12-people").ends_with("twelve people around"));
    }

    #[test]
    fn a_record_cannot_break_the_page() {
        let worst = serde_json::json!([{"stage": "tick", "instructions": 7, "trials": "<i>", "seed": 1}]);
        let (_, how) = worst_of(Some(&worst), "tick").expect("it is kept");
        assert_eq!(how, "&quot;&lt;i&gt;&quot; scenes, seed 1");
    }
}
