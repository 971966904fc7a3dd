//! Instructions of each stage on the emulated Cortex-M7, in words that need no knowledge of the code.

use serde_json::Value;

use super::table::{Table, code, escape, grouped, verdict};
use crate::facts::{Firmware, facts};

/// What is counted under a name.
fn reported(name: &str) -> String {
    let Some(firmware) = &facts().firmware else { return String::new() };
    let of = |name: &str| firmware.stages.get(name).cloned();
    let suffixed = |(suffix, words): (&String, &String)| {
        Some(format!("{}{words}", of(name.strip_suffix(suffix.as_str())?)?))
    };
    of(name).or_else(|| firmware.suffixes.iter().find_map(suffixed)).unwrap_or_default()
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
    let budgets = facts().firmware.as_ref().map(|firmware: &Firmware| &firmware.budgets);
    let mut table =
        Table::new(&["stage", "what it is", "times", "mean", "most", "worst input", "searched in", "budget"]);
    for (name, cost) in firmware["instructions"].as_object().into_iter().flatten() {
        let (searched, how) = worst_of(worst, name).unzip();
        let most = searched.unwrap_or(0).max(cost["max"].as_u64().unwrap_or(0));
        let budget = budgets.and_then(|budgets| budgets.get(name)).copied();
        table.row(&[
            code(name),
            escape(&reported(name)),
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
        let path = crate::shell::root().join(&facts().records.instructions);
        let golden: Value =
            serde_json::from_str(&std::fs::read_to_string(path).expect("a file")).expect("JSON");
        let names = golden["instructions"].as_object().expect("stages").keys();
        let silent: Vec<_> = names.filter(|name| reported(name).is_empty()).collect();
        assert!(silent.is_empty(), "{silent:?}");
        assert!(kept(5, 5).contains("5, kept") && kept(6, 5).contains("5, missed"));
        assert!(reported("sweep-12-people").ends_with("twelve people around"));
    }

    #[test]
    fn a_record_cannot_break_the_page() {
        let worst = serde_json::json!([{"stage": "tick", "instructions": 7, "trials": "<i>", "seed": 1}]);
        let (_, how) = worst_of(Some(&worst), "tick").expect("it is kept");
        assert_eq!(how, "&quot;&lt;i&gt;&quot; scenes, seed 1");
    }
}
