//! What the book, the README and the safety manual say of `cargo xtask` is what it takes.

use clap::{CommandFactory, Parser};

use crate::Arguments;
use crate::shell;

const TEXTS: [&str; 6] = [
    "README.md",
    "BENCHMARKS.md",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "docs/safety-manual.md",
    "docs/requirements.md",
];

fn texts() -> Vec<(String, String)> {
    let book = std::fs::read_dir(shell::root().join("docs/src")).expect("the book");
    let chapters = book.map(|entry| entry.expect("a file").path());
    let chapters = chapters.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    let others = TEXTS.iter().map(|name| shell::root().join(name));
    let read = |path: std::path::PathBuf| {
        let text =
            std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        (path.display().to_string(), text)
    };
    chapters.chain(others).map(read).collect()
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
