//! The pages of the book are what the records give, and can be read.

use std::collections::BTreeSet;

use regex_lite::Regex;

use super::{RECORDS, differing, page, pages, schema};
use crate::shell;

/// Longest cell of a table, characters.
const CELL_MAX: usize = 240;
/// Longest item of a list, characters.
const ITEM_MAX: usize = 500;

const EXAMPLE: &str = r#"{"order": 1, "title": "T", "about": "A.", "experiments": [{
    "title": "E", "data": "D", "seed": "1", "n": "9 runs", "command": "cargo xtask bench",
    "record": {"measured_on": "not recorded", "printed_on": "2026-11-21", "commit": "abc", "machine": "M", "load": "24"},
    "figures": [
        {"metric": "m", "result": "3", "interval": "2–4 (95 %)", "target": "2", "met": "no"},
        {"metric": "o", "result": "5", "seed": "2", "command": "–"}],
    "misses": ["too many"], "tried": ["less"]}]}"#;

#[test]
fn pages_are_what_the_records_give() {
    let differing = differing(&shell::root()).expect("the records");
    assert!(differing.is_empty(), "run `cargo xtask figures`: {differing:?}");
    let subjects = schema::read(&shell::root().join(RECORDS)).expect("the records");
    assert!(subjects.len() >= 10, "{} subjects", subjects.len());
}

#[test]
fn every_page_is_in_the_summary() {
    let summary = std::fs::read_to_string(shell::root().join("docs/src/SUMMARY.md")).expect("the summary");
    for subject in schema::read(&shell::root().join(RECORDS)).expect("the records") {
        assert!(summary.contains(&format!("(figures/{}.md)", subject.name)), "{}", subject.name);
    }
}

/// Numbers of a text, as they are written.
fn numbers(text: &str) -> BTreeSet<String> {
    let pattern = Regex::new(r"\d[\d,]*(\.\d+)?").expect("a pattern");
    pattern.find_iter(text).map(|found| found.as_str().trim_end_matches(',').to_owned()).collect()
}

#[test]
fn the_readme_quotes_numbers_of_the_pages() {
    let readme = std::fs::read_to_string(shell::root().join("README.md")).expect("the README");
    let table = readme.split("| measured | figure |").nth(1).and_then(|rest| rest.split("\n\n").next());
    let quoted = numbers(table.expect("the table of measured figures"));
    let pages: String =
        pages(&shell::root()).expect("the records").into_iter().map(|page| page.text).collect();
    let missing: Vec<_> = quoted.difference(&numbers(&pages)).cloned().collect();
    assert!(quoted.len() >= 15 && missing.is_empty(), "on no page: {missing:?}");
}

#[test]
fn cells_and_items_are_short() {
    for page in pages(&shell::root()).expect("the records") {
        let rows = page.text.lines().filter_map(|line| line.strip_prefix("| ")?.strip_suffix(" |"));
        for cell in rows.flat_map(|row| row.split(" | ")) {
            assert!(cell.chars().count() <= CELL_MAX, "{}: {cell}", page.path.display());
        }
        for item in page.text.lines().filter(|line| line.starts_with("* ")) {
            assert!(item.chars().count() <= ITEM_MAX, "{}: {item}", page.path.display());
        }
    }
}

#[test]
fn rows_show_their_experiment_once() {
    let text = page::text(&schema::parse("t", EXAMPLE).expect("a record"));
    assert!(
        text.contains("| m | D; seed: 1 | 9 runs | 3; 2–4 (95 %) | 2 | **no** | `cargo xtask bench` |"),
        "{text}"
    );
    assert!(text.contains("| o | as above; seed: 2 | as above | 5 | – | – | – |"), "{text}");
    assert!(text.contains("First printed: 2026-11-21. Commit: abc. Machine: M. Load: 24."), "{text}");
    assert!(text.contains("\nMissed:\n\n* too many\n\nTried without gain:\n\n* less\n"), "{text}");
}

#[test]
fn records_that_contradict_themselves_are_refused() {
    let refused = |from: &str, to: &str| {
        let broken = EXAMPLE.replace(from, to);
        assert_ne!(broken, EXAMPLE, "{from}");
        schema::parse("t", &broken).map(|_| ()).expect_err(to);
    };
    refused(r#""target": "2", "#, "");
    refused(r#""met": "no""#, r#""met": "nearly""#);
    refused(r#"["too many"]"#, "[]");
    refused(r#""load": "24""#, r#""load": """#);
    refused(r#", "load": "24""#, "");
    refused(r#""interval""#, r#""range""#);
}
