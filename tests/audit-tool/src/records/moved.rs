//! `cargo xtask moved --since COMMIT`: records follow code that only moved.
//!
//! A record of counted loops or of mutants names a file. Where the file has another name since the commit, the record follows if
//! the function is the same: its syntax without layout, remarks, visibility, and without the modules before a name, which
//! a move changes. Otherwise it is dropped, and the loop or mutant is a new one. The fingerprints of whole runs follow only if
//! all audited code is the same in that way.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail};
use clap::Args;
use serde_json::Value;

use crate::facts::facts;
use crate::loops;
use crate::mutants::{EQUIVALENT, Equivalent, RECORD as MUTANTS, Record};
use crate::sources::same_code::Functions;
use crate::sources::{SourceFile, same_code};
use crate::{shell, sources};

const CAMPAIGNS: &str = "docs/evidence/campaigns.json";

/// Since when.
#[derive(Args)]
pub struct Options {
    /// The commit before the moves.
    #[arg(long)]
    since: String,
}

/// Both sides of a move.
struct Moves {
    /// New name by old name, of files that have another.
    names: BTreeMap<String, String>,
    old: Functions,
    new: Functions,
}

/// Rewrites the records. Always good: what cannot follow is reported.
pub fn run(options: &Options) -> Result<bool> {
    let root = shell::root();
    let names = renamed(&git(&["diff", "--name-status", "-M40%", "-l0", &options.since])?);
    let folders = &facts().sources;
    let (old, new) = (tree_at(&options.since, &folders.audited)?, sources::read_audited(&root)?);
    let moves = Moves { names, old: same_code::functions(&old), new: same_code::functions(&new) };
    println!("moved: {} files have another name since {}", moves.names.len(), options.since);
    for record in [loops::RECORD, EQUIVALENT] {
        rewrite(&root.join(record), |entries| follow(entries, &moves, record))?;
    }
    rewrite(&root.join(MUTANTS), |parts| {
        for part in parts.iter_mut() {
            let survivors = part["survivors"].as_array_mut().context("a record without survivors")?;
            follow(survivors, &moves, MUTANTS)?;
            survivors.iter_mut().for_each(|survivor| find_line(&root, survivor));
        }
        Ok(())
    })?;
    sign("code", (&old, &new), &moves.names)?;
    let robot = (tree_at(&options.since, &folders.robot)?, sources::read_robot(&root)?);
    sign("whole", (&robot.0, &robot.1), &moves.names)?;
    Ok(true)
}

/// Lets the fingerprints of records follow if all of the code is the same.
fn sign(
    field: &str,
    (old, new): (&[SourceFile], &[SourceFile]),
    names: &BTreeMap<String, String>,
) -> Result<()> {
    let different = same_code::differences(old, new, names);
    if !different.is_empty() {
        println!("moved: `{field}`: {} files say something else, so that it stays:", different.len());
        different.iter().for_each(|name| println!("  {name}"));
        return Ok(());
    }
    let (old, new) = (sources::fingerprint(old), sources::fingerprint(new));
    for record in [MUTANTS, CAMPAIGNS] {
        rewrite(&shell::root().join(record), |entries| {
            for entry in entries.iter_mut().filter(|entry| entry[field].as_str() == Some(&old)) {
                entry[field] = Value::from(new.clone());
            }
            Ok(())
        })?;
    }
    println!("moved: `{field}`: {old} is {new} now");
    Ok(())
}

fn git(arguments: &[&str]) -> Result<String> {
    let mut command = Command::new("git");
    command.current_dir(shell::root()).args(arguments);
    shell::output(&mut command).with_context(|| format!("git {} fails", arguments.join(" ")))
}

/// Lines of three fields, parted by tabs: `R100`, the old name, the new one.
fn renamed(status: &str) -> BTreeMap<String, String> {
    let lines = status.lines().filter(|line| line.starts_with('R'));
    let pairs = lines.filter_map(|line| {
        let mut parts = line.split('\t').skip(1);
        Some((parts.next()?.to_owned(), parts.next()?.to_owned()))
    });
    pairs.collect()
}

/// Sources as they were, in the order of their paths.
fn tree_at(commit: &str, folders: &[String]) -> Result<Vec<SourceFile>> {
    let mut listing = vec!["ls-tree", "-r", "--name-only", commit, "--"];
    listing.extend(folders.iter().map(String::as_str));
    let names = git(&listing)?;
    let is_source = |name: &&str| name.ends_with(".rs") && !sources::is_test_file(Path::new(name));
    let mut names: Vec<&str> = names.lines().filter(is_source).collect();
    names.sort_by_key(|name| Path::new(*name));
    let read = |name: &str| sources::parse(name, git(&["show", &format!("{commit}:{name}")])?);
    names.into_iter().map(read).collect()
}

/// Reads a list, changes it, and writes it if anything is another now.
fn rewrite(path: &Path, change: impl FnOnce(&mut Vec<Value>) -> Result<()>) -> Result<()> {
    let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let mut entries: Vec<Value> = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
    let before = entries.clone();
    change(&mut entries)?;
    if entries == before {
        return Ok(());
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    fs::write(path, written(&name, entries)?).with_context(|| format!("cannot write {}", path.display()))
}

/// A record as its command writes it: fields in their order, one loop a line.
fn written(name: &str, entries: Vec<Value>) -> Result<String> {
    let is = |record: &str| record.ends_with(name);
    let entries = Value::from(entries);
    let pretty = match () {
        () if is(loops::RECORD) => {
            return loops::written(&serde_json::from_value::<Vec<loops::Record>>(entries)?);
        }
        () if is(MUTANTS) => serde_json::to_string_pretty(&serde_json::from_value::<Vec<Record>>(entries)?)?,
        () if is(EQUIVALENT) => {
            serde_json::to_string_pretty(&serde_json::from_value::<Vec<Equivalent>>(entries)?)?
        }
        () => serde_json::to_string_pretty(&entries)?,
    };
    Ok(pretty + "\n")
}

/// Gives the entries of moved files their new name, and drops those whose function is another one.
fn follow(entries: &mut Vec<Value>, moves: &Moves, record: &str) -> Result<()> {
    let before = entries.len();
    let mut moved = 0;
    let mut kept = Vec::new();
    for mut entry in std::mem::take(entries) {
        let Some(file) = entry["file"].as_str().map(str::to_owned) else {
            bail!("{record}: an entry of no file")
        };
        match moves.place_of(&file, &entry) {
            Some(place) => {
                moved += usize::from(place != file);
                entry["file"] = Value::from(place);
                kept.push(entry);
            }
            None => println!("moved: {record}: {file}: {} is another one now", words(&entry)),
        }
    }
    *entries = kept;
    println!("moved: {record}: {moved} of {before} entries follow, {} are dropped", before - entries.len());
    Ok(())
}

fn words(entry: &Value) -> &str {
    ["function", "mutation"].iter().find_map(|name| entry[*name].as_str()).unwrap_or("?")
}

impl Moves {
    /// Where the entry's code is now; its file's own name where that did not move, nothing where the function changed.
    fn place_of(&self, file: &str, entry: &Value) -> Option<String> {
        let Some(new) = self.names.get(file) else {
            // Of an older move, or not moved at all: nobody asks what changed within.
            return Some(file.to_owned());
        };
        let names = match entry["function"].as_str() {
            Some(name) => vec![name.to_owned()],
            None => self.old.holding(file, entry["source"].as_str().unwrap_or_default()),
        };
        let same = |place: &str| {
            names.iter().all(|name| {
                let before = self.old.named(file, name);
                before.is_some() && before == self.new.named(place, name)
            })
        };
        if same(new) {
            return Some(new.clone());
        }
        let mut others = self.new.files().filter(|place| same(place));
        others.next().map(str::to_owned).filter(|_| others.next().is_none())
    }
}

/// A survivor keeps its text; its line may be another one.
fn find_line(root: &Path, survivor: &mut Value) {
    let text = survivor["file"].as_str().and_then(|file| fs::read_to_string(root.join(file)).ok());
    let source = survivor["source"].as_str().unwrap_or_default().to_owned();
    let old = survivor["line"].as_u64().unwrap_or(0);
    let text = text.unwrap_or_default();
    let lines = text.lines().enumerate().filter(|(_, line)| line.trim() == source);
    let near = lines.map(|(at, _)| at as u64 + 1).min_by_key(|line| line.abs_diff(old));
    if let Some(line) = near {
        survivor["line"] = Value::from(line);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn tree(files: &[(&str, &str)]) -> Functions {
        let parse =
            |(name, text): &(&str, &str)| sources::parse(name, (*text).to_owned()).expect("it parses");
        same_code::functions(&files.iter().map(parse).collect::<Vec<_>>())
    }

    #[test]
    fn record_follows_moves_not_changes() {
        let old = tree(&[("a/src/x.rs", "fn f() { crate::g(1) }\nfn h() { 2 }\nfn k() { 3 }")]);
        let new = tree(&[
            ("b/src/y.rs", "/// Moved.\npub(crate) fn f() { other::place::g(1) }\nfn h() { 4 }"),
            ("b/src/z.rs", "fn k() { 3 }"),
        ]);
        let names = renamed("R090\ta/src/x.rs\tb/src/y.rs\nM\tc/src/z.rs\n");
        let moves = Moves { names, old, new };
        let place = |name: &str| moves.place_of("a/src/x.rs", &json!({ "function": name }));
        assert_eq!(place("f").as_deref(), Some("b/src/y.rs"));
        assert_eq!(place("h"), None);
        assert_eq!(place("k").as_deref(), Some("b/src/z.rs"), "it is in another file than the rest");
        assert_eq!(moves.place_of("c/src/z.rs", &json!({ "function": "?" })).as_deref(), Some("c/src/z.rs"));
        let mut entries = vec![json!({ "file": "a/src/x.rs", "mutation": "m", "source": "2" })];
        follow(&mut entries, &moves, "a record").expect("it is read");
        assert!(entries.is_empty(), "the function around the line changed");
    }
}
