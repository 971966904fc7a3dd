//! Everything that the page can say, it can say in five languages.

use std::collections::BTreeMap;

use floorguard_guard::{Action, Cause, CauseRecord, Health, ResetRefusal, Source, Unit};
use floorguard_robot::cleaner::MissionPhase;
use floorguard_types::time::Stamp;
use serde_json::Value;

use super::pieces;

const LANGUAGES: usize = 5;
const ACTIONS: [Action; 5] =
    [Action::None, Action::Limit, Action::Category2, Action::Category1, Action::Category0];

/// What the page carries with it.
fn table() -> BTreeMap<String, Vec<String>> {
    let [page, _] = crate::words::parts();
    of_rows(page)
}

fn of_rows(rows: crate::words::Rows) -> BTreeMap<String, Vec<String>> {
    let count = rows.len();
    assert!(count > 100, "the table is read: {count} rows");
    let table: BTreeMap<_, _> = rows.into_iter().map(|row| (row[0].clone(), row)).collect();
    assert_eq!(table.len(), count, "a row stands there twice");
    table
}

/// The text between two marks, each time.
fn between<'a>(text: &'a str, open: &str, close: char) -> impl Iterator<Item = &'a str> {
    text.split(open).skip(1).filter_map(move |rest| rest.split(close).next())
}

/// What a script hands to the translation: calls of `t` and of nothing whose name ends so.
fn spoken_by(script: &str) -> impl Iterator<Item = &str> {
    let calls = script
        .match_indices("t(\"")
        .filter(|(at, _)| !script[..*at].ends_with(|before: char| before.is_alphanumeric() || before == '.'));
    calls.filter_map(|(at, call)| script[at + call.len()..].split('"').next())
}

/// String literals of a Rust source that are whole sentences.
fn sentences(source: &str) -> Vec<String> {
    let code = source.split("#[cfg(test)]").next().unwrap_or_default();
    let pieces = code.split('"').skip(1).step_by(2);
    let joined =
        pieces.map(|piece| piece.split("\\\n").map(|line| line.trim_start().to_owned()).collect::<String>());
    joined.filter(|text| text.ends_with('.') && text.contains(' ')).collect()
}

#[test]
fn each_row_has_five_languages_and_their_gaps() {
    let rows = crate::words::parts().concat();
    for (english, row) in of_rows(rows) {
        assert_eq!(row.len(), LANGUAGES, "{english}");
        for words in &row {
            assert!(!words.trim().is_empty(), "{english}");
            assert_eq!(words.matches("{}").count(), english.matches("{}").count(), "{english}: {words}");
        }
    }
}

/// What the page says of a cause and of a refused reset, with everything that they can hold.
fn pieces_of_causes() -> Vec<String> {
    let whole = CauseRecord {
        health: Health::Stale,
        ahead_us: 5,
        ..CauseRecord::new(Cause::ScanProtective, Stamp::ZERO).metres(1.0, 2.0).aged(5)
    };
    let code = CauseRecord::new(Cause::DriveFault, Stamp::ZERO).measured(1.0, 0.0, Unit::Code);
    let refusals = [
        ResetRefusal::Present(Cause::DriveFault),
        ResetRefusal::NotHealthy(Source::Lidar, Health::Stale),
        ResetRefusal::Moving,
    ];
    let refused = refusals.map(|refusal| pieces::of_refusal(Some(refusal), ""));
    let all = [pieces::of_cause(&whole), pieces::of_cause(&code)].into_iter().chain(refused).flatten();
    all.map(|piece| piece.key).collect()
}

#[test]
fn robot_speaks_five_languages() {
    let table = table();
    let causes = Cause::all().into_iter().map(|cause| cause.to_string());
    let health =
        [Health::Healthy, Health::Stale, Health::Frozen, Health::Blind, Health::Faulty, Health::Absent];
    let phases = [
        MissionPhase::Starting,
        MissionPhase::Cleaning,
        MissionPhase::Waiting,
        MissionPhase::Paused,
        MissionPhase::Done,
        MissionPhase::Cancelled,
    ];
    let words = causes
        .chain(health.map(|health| health.to_string()))
        .chain(phases.map(|phase| phase.name().to_owned()))
        .chain(ACTIONS.map(|action| action.to_string()))
        .chain(pieces_of_causes())
        .chain(sentences(include_str!("plain.rs")));
    let missing: Vec<String> = words.filter(|words| !table.contains_key(words)).collect();
    assert!(missing.is_empty(), "{missing:#?}");
}

#[test]
fn page_speaks_five_languages() {
    let table = table();
    let html = include_str!("page/page.html");
    let labels = between(html, "data-label=\"", '"');
    let marked = html.split(" data-t>").skip(1).filter_map(|rest| rest.split('<').next());
    let scripts = [
        include_str!("page/state.js"),
        include_str!("page/map.js"),
        include_str!("page/areas.js"),
        include_str!("page/records.js"),
        include_str!("page/upkeep.js"),
        include_str!("page/main.js"),
    ];
    let spoken = scripts.iter().flat_map(|script| spoken_by(script));
    let missing: Vec<&str> =
        labels.chain(marked).chain(spoken).filter(|words| !table.contains_key(*words)).collect();
    assert!(missing.is_empty(), "{missing:#?}");
    let holders: Value = serde_json::json!(["a person", "an obstacle", "behind", "ahead on the right"]);
    assert!(
        holders
            .as_array()
            .into_iter()
            .flatten()
            .all(|words| table.contains_key(words.as_str().unwrap_or("")))
    );
}
