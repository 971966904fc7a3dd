//! What the book, the README and the safety manual say of `cargo xtask` is what it takes.

use std::path::{Path, PathBuf};

use clap::{CommandFactory, Parser};

use crate::shell;
use crate::{Arguments, citations};
use embedded_audit::sources;

const TEXTS: [&str; 6] = [
    "README.md",
    "BENCHMARKS.md",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "docs/safety-manual.md",
    "docs/requirements.md",
];

fn texts() -> Vec<(String, String)> {
    let chapters = pages(&shell::root().join("docs/src")).into_iter();
    let others = TEXTS.iter().map(|name| shell::root().join(name));
    let read = |path: PathBuf| {
        let text =
            std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        (path.display().to_string(), text)
    };
    chapters.chain(others).map(read).collect()
}

/// All pages below a folder.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let files = citations::files(folder).into_iter();
    files.filter(|path| path.extension().is_some_and(|extension| extension == "md")).collect()
}

/// Every call in a text: lines between fences, without comments, and code between backquotes.
fn calls(text: &str) -> Vec<String> {
    let fenced = text.split("```").skip(1).step_by(2).flat_map(str::lines);
    let fenced = fenced.map(|line| line.split(" #").next().unwrap_or(line));
    let prose = text.split("```").step_by(2).flat_map(|prose| prose.split('`').skip(1).step_by(2));
    let words = |call: &str| call.split_whitespace().collect::<Vec<_>>().join(" ");
    let calls = fenced.chain(prose).map(words);
    calls.filter_map(|call| call.strip_prefix("cargo xtask ").map(str::to_owned)).collect()
}

/// A list, a choice or a placeholder stands in it.
fn is_pattern(call: &str) -> bool {
    let placeholder = |word: &str| word == "N" || word.chars().filter(char::is_ascii_uppercase).count() > 1;
    call.contains([',', '|', '[', '…', '<']) || call.split_whitespace().any(placeholder)
}

fn check(call: &str) -> Result<(), String> {
    let name = call.split([' ', ',']).next().unwrap_or_default();
    let program = Arguments::command();
    let command = program.find_subcommand(name).ok_or_else(|| format!("no command {name}"))?;
    let known: Vec<&str> = command.get_arguments().filter_map(clap::Arg::get_long).collect();
    let named = call.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
    if let Some(option) =
        named.filter_map(|word| word.strip_prefix("--")).find(|option| !known.contains(option))
    {
        return Err(format!("no option --{option}"));
    }
    if is_pattern(call) {
        return Ok(());
    }
    let words = ["cargo xtask"].into_iter().chain(call.split_whitespace());
    Arguments::try_parse_from(words).map_err(|error| error.to_string())?;
    let mut words = call.split_whitespace();
    match (words.next(), words.next()) {
        (Some("campaign"), Some(campaign)) => crate::campaign::exists(campaign),
        _ => Ok(()),
    }
}

#[test]
fn every_call_is_one() {
    let mut found = 0;
    for (path, text) in texts() {
        for call in calls(&text) {
            check(&call).unwrap_or_else(|why| panic!("{path}: `cargo xtask {call}`: {why}"));
            found += 1;
        }
    }
    assert!(found >= 30, "{found}");
}

/// A chapter as mdbook sees it: what it includes stands in its place.
fn chapter(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut parts = text.split("{{#include ");
    let mut whole = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (included, rest) = part.split_once("}}").expect("an include ends");
        let file = path.with_file_name(included.trim());
        let included = std::fs::read_to_string(&file);
        whole += &included
            .unwrap_or_else(|error| panic!("{} includes {}: {error}", path.display(), file.display()));
        whole += rest;
    }
    whole
}

/// Places within the book that a text links to or shows.
fn places(text: &str) -> Vec<String> {
    let prose: String = text.split("```").step_by(2).collect();
    let targets =
        prose.split("](").skip(1).filter_map(|rest| rest.split([')', ' ']).next().map(str::to_owned));
    targets.filter(|target| !target.contains("://") && !target.starts_with('#')).collect()
}

/// A place that a page links to, from the root of the book; `None` outside of it.
fn within_the_book(page: &str, place: &str) -> Option<String> {
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in place.split('#').next().unwrap_or_default().split('/') {
        if part == ".." {
            parts.pop()?;
        } else {
            parts.push(part);
        }
    }
    Some(parts.join("/"))
}

/// mdbook makes pages of what the summary names and of nothing else: a chapter may include a text that lies beside the book,
/// and must not link to it.
#[test]
fn includes_and_links_of_the_book_lead_somewhere() {
    let source = shell::root().join("docs/src").canonicalize().expect("the book");
    let summary = chapter(&source.join("SUMMARY.md"));
    let chapters = places(&summary);
    let mut links = 0;
    for name in &chapters {
        for place in places(&chapter(&source.join(name))) {
            let within = within_the_book(name, &place);
            let within = within
                .unwrap_or_else(|| panic!("{name} links to {place}: a page cannot lead out of the book"));
            assert!(source.join(&within).exists(), "{name} links to {place}, which is not there");
            let is_chapter = chapters.contains(&within);
            assert!(is_chapter || !place.contains(".md"), "{name} links to {place}, which is no chapter");
            links += 1;
        }
    }
    for page in pages(&source) {
        let name = page.strip_prefix(&source).unwrap_or(&page).to_string_lossy().into_owned();
        assert!(chapters.contains(&name) || name == "SUMMARY.md", "{name} is in no summary");
    }
    assert!(chapters.len() >= 15 && links >= 10, "{} chapters, {links} links", chapters.len());
}

/// Who is new looks for crates and modules in ARCHITECTURE.md.
#[test]
fn every_crate_and_module_is_in_the_architecture() {
    let text = std::fs::read_to_string(shell::root().join("ARCHITECTURE.md")).expect("the architecture");
    // What is drawn has everything; a newcomer needs words.
    let text = text.split("<!-- drawn by").next().unwrap_or_default();
    let layers = ["core-nostd", "drivers", "hal-sim", "runtime", "tests"].map(str::to_owned);
    let mut missing = Vec::new();
    for one in sources::crates_below(&shell::root(), &layers).expect("the crates") {
        let folder = format!("{}/src", one.folder);
        let entries = std::fs::read_dir(shell::root().join(&folder)).into_iter().flatten();
        let modules = entries.filter_map(Result::ok).filter(|entry| entry.path().is_dir());
        let names = modules.map(|module| module.file_name().to_string_lossy().into_owned());
        let names = names.filter(|name| !["tests", "bin"].contains(&name.as_str()));
        let absent = names.filter(|name| !text.contains(&format!("`{name}`")));
        missing.extend(absent.map(|name| format!("{folder}/{name}")));
        missing.extend((!text.contains(&one.folder)).then_some(one.folder));
    }
    assert!(missing.is_empty(), "not in ARCHITECTURE.md: {missing:?}");
}
