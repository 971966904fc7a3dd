//! Every requirement on the stop path has code and a test, and nothing names a requirement that does not exist.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.map(|entry| entry.expect("readable").path()) {
        if path.is_dir() {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// The three digits after each `marker`.
fn numbers(text: &str, marker: &str) -> BTreeSet<String> {
    let after = text.split(marker).skip(1);
    after
        .map(|rest| rest.chars().take(3).collect::<String>())
        .filter(|id| id.parse::<u16>().is_ok())
        .collect()
}

fn listed(document: &str) -> BTreeSet<String> {
    document
        .lines()
        .flat_map(|line| numbers(line.split(" | ").next().unwrap_or_default(), "| FG-REQ-"))
        .collect()
}

/// What is wrong, one sentence each.
fn findings(document: &str, code: &str, tests: &str) -> Vec<String> {
    let (listed, in_code, in_tests) =
        (listed(document), numbers(code, "FG-REQ-"), numbers(tests, "fn fg_req_"));
    let mut findings = Vec::new();
    for id in &listed {
        if !in_code.contains(id) {
            findings.push(format!("FG-REQ-{id} is listed and no code names it"));
        }
        if !in_tests.contains(id) {
            findings.push(format!("FG-REQ-{id} is listed and no test is named fg_req_{id}_…"));
        }
    }
    for id in in_code.union(&in_tests).filter(|id| !listed.contains(*id)) {
        findings
            .push(format!("FG-REQ-{id} is named by code or a test and not listed in docs/requirements.md"));
    }
    findings
}

fn sources() -> (String, String) {
    let mut files = Vec::new();
    rust_files(&root().join("core-nostd/guard/src"), &mut files);
    rust_files(&root().join("drivers/src"), &mut files);
    rust_files(&root().join("runtime/configuration/src"), &mut files);
    rust_files(&root().join("runtime/src"), &mut files);
    rust_files(&root().join("tests/tests"), &mut files);
    let this = Path::new(file!()).file_name().expect("a file name");
    let (mut code, mut tests) = (String::new(), String::new());
    for path in files.iter().filter(|path| path.file_name() != Some(this)) {
        let text = fs::read_to_string(path).expect("readable");
        let inside = path.strip_prefix(root()).expect("below the root");
        let is_test = |part: &str| part.ends_with("tests") || part.ends_with("tests.rs");
        if inside.components().any(|part| part.as_os_str().to_str().is_some_and(is_test)) {
            tests.push_str(&text);
        } else {
            code.push_str(&text);
        }
    }
    (code, tests)
}

#[test]
fn every_requirement_has_code_and_a_test() {
    let document = fs::read_to_string(root().join("docs/requirements.md")).expect("docs/requirements.md");
    assert!(listed(&document).len() >= 30);
    let (code, tests) = sources();
    assert!(!code.is_empty() && !tests.is_empty());
    let findings = findings(&document, &code, &tests);
    assert!(findings.is_empty(), "{}", findings.join("\n"));
}

#[test]
fn missing_tests_code_and_identifiers_are_found() {
    let document = "| FG-REQ-901 | text | code | hazard |\n| FG-REQ-902 | text | code | hazard |";
    assert_eq!(
        findings(document, "FG-REQ-901 FG-REQ-902", "fn fg_req_901_a fn fg_req_902_b"),
        Vec::<String>::new()
    );
    assert!(findings(document, "FG-REQ-901 FG-REQ-902", "fn fg_req_901_a")[0].contains("no test"));
    assert!(findings(document, "FG-REQ-901", "fn fg_req_901_a fn fg_req_902_b")[0].contains("no code"));
    assert!(
        findings(document, "FG-REQ-901 FG-REQ-902 FG-REQ-903", "fn fg_req_901_a fn fg_req_902_b")[0]
            .contains("not listed")
    );
}

/// Files of the crate that decides, without its tests and without `protection` and `people`, on which it stands: path and code lines.
fn guard_code() -> Vec<(PathBuf, Vec<String>)> {
    let mut files = Vec::new();
    rust_files(&root().join("core-nostd/guard/src"), &mut files);
    files.retain(|path| path.parent().is_some_and(|folder| folder.ends_with("guard/src")));
    files.retain(|path| !path.to_string_lossy().ends_with("_tests.rs"));
    let code_lines = |path: &PathBuf| {
        let text = fs::read_to_string(path).expect("readable");
        // A test module declared in one line has its code in `tests`; any other ends the file.
        let text = ["extern crate std;", "mod drive_tests;", "mod people_tests;", "mod tests;"]
            .iter()
            .fold(text, |text, declared| text.replace(&format!("#[cfg(test)]\n{declared}"), ""));
        let code = text.split("#[cfg(test)]").next().unwrap_or_default().to_string();
        let is_code = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
        code.lines().filter(is_code).map(str::to_string).collect::<Vec<_>>()
    };
    files.iter().map(|path| (path.clone(), code_lines(path))).collect()
}

#[test]
fn the_guard_has_at_most_1600_code_lines() {
    let lines: usize = guard_code().iter().map(|(_, lines)| lines.len()).sum();
    assert!((800..=1_600).contains(&lines), "{lines} code lines");
}

/// Logical operators of the statement with the most of them. A closure without arguments is no operator.
fn most_operators(code: &str) -> (usize, String) {
    let code = code.replace("= ||", "= ").replace("(||", "(").replace("=\n            || ", "= ");
    let statements = code.split([';', '{', '}', ',']);
    let counted =
        statements.map(|text| (text.matches("&&").count() + text.matches("||").count(), text.to_string()));
    counted.max_by_key(|(count, _)| *count).unwrap_or_default()
}

#[test]
fn guard_decisions_have_at_most_four_conditions() {
    for (path, lines) in guard_code() {
        let (operators, statement) = most_operators(&lines.join("\n"));
        assert!(operators <= 3, "{}: {operators} operators in {statement}", path.display());
    }
    assert_eq!(most_operators("if a && b || c && d && e { x }").0, 4);
}
