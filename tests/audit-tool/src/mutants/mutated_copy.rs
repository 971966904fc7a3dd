//! The copy of the workspace with all mutants in it, and what the compiler refuses of them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use serde_json::Value;

use super::list::{Genre, Mutant};
use super::{branches, edits};
use crate::facts::facts;
use crate::{copied_tree, shell};

const SWITCH: &str = include_str!("switch.rs.in");

/// Rounds in which the compiler may refuse mutants.
const ROUNDS: usize = 25;

/// What the compiler refuses.
#[derive(Debug, Default)]
pub struct Refused {
    /// Mutants whose value is not of the function's type: they do not compile by themselves either.
    pub unviable: BTreeSet<usize>,
    /// Mutants that cannot be branches beside the others.
    pub alone: BTreeSet<usize>,
    /// Functions that the compiler evaluates.
    constant: BTreeSet<String>,
}

/// The copy.
pub struct MutatedCopy {
    /// Holds `tree` and `target`.
    pub folder: PathBuf,
}

impl MutatedCopy {
    /// Copies the workspace, writes all mutants into it that compile there, and tells which do not.
    pub fn make(package: &str, mutants: &[Mutant]) -> Result<(Self, Refused)> {
        let mutated = Self { folder: copied_tree::copy("mutants")? };
        let mut refused = Refused::default();
        for _ in 0..ROUNDS {
            let files = mutated.write(mutants, &refused)?;
            let mistakes = mutated.mistakes(package)?;
            if mistakes.is_empty() {
                refused.alone.extend(without_branch(mutants, &files, &refused));
                return Ok((mutated, refused));
            }
            if !blame(&mistakes, &files, mutants, &mut refused) {
                bail!("the copy with the mutants does not compile: {:?}", mistakes.first());
            }
        }
        bail!("the compiler still refuses mutants after {ROUNDS} rounds");
    }

    /// The copied workspace.
    pub fn sources(&self) -> PathBuf {
        self.folder.join("tree")
    }

    /// A cargo that builds there, fast and without warnings about mutated code.
    pub fn cargo(&self) -> Command {
        let mut command = shell::cargo();
        command.current_dir(self.sources()).env("CARGO_TARGET_DIR", self.folder.join("target"));
        command.env("RUSTFLAGS", "--cap-lints=allow").env_remove("RUSTC_WRAPPER");
        command.env("CARGO_PROFILE_DEV_DEBUG", "0");
        command.args(["--config", "profile.dev.package.\"*\".opt-level=1"]);
        command
    }

    fn write(&self, mutants: &[Mutant], refused: &Refused) -> Result<Files> {
        let mut files = Files::new();
        let names: BTreeSet<&str> = mutants.iter().map(|mutant| mutant.file.as_str()).collect();
        for name in names {
            let text = std::fs::read_to_string(shell::root().join(name))?;
            let syntax = syn::parse_file(&text).with_context(|| format!("{name} does not parse"))?;
            let own: Vec<(usize, &Mutant)> = mutants
                .iter()
                .enumerate()
                .filter(|(number, mutant)| {
                    mutant.file == name
                        && !refused.unviable.contains(number)
                        && !refused.alone.contains(number)
                })
                .collect();
            let edited = edits::apply(&text, branches::of_file((&text, &syntax), &own, &refused.constant));
            copied_tree::write(&self.sources().join(name), &edited.text)?;
            files.insert(name.to_owned(), edited);
        }
        let switch = SWITCH.replace("ENVIRONMENT", &facts().environment);
        let switch = format!("{switch}\nconst MUTANTS: usize = {};\n", mutants.len());
        copied_tree::add_module(&self.sources(), branches::MODULE, &switch)?;
        Ok(files)
    }

    fn mistakes(&self, package: &str) -> Result<Vec<Mistake>> {
        let mut check = self.cargo();
        check.args(["check", "--quiet", "--message-format=json", "--lib", "--package", package]);
        // With the tests, which may want constants of functions.
        let output = check
            .args(["--profile", "test"])
            .stderr(Stdio::null())
            .output()
            .context("cannot start cargo check")?;
        let text = String::from_utf8_lossy(&output.stdout);
        let mistakes: Vec<Mistake> = text.lines().filter_map(Mistake::parse).collect();
        if !output.status.success() && mistakes.is_empty() {
            bail!("the copy with the mutants does not compile, and the compiler names no place");
        }
        Ok(mistakes)
    }
}

/// The mutated files by name.
type Files = BTreeMap<String, edits::Edited>;

/// An error of the compiler.
#[derive(Debug)]
struct Mistake {
    message: String,
    /// Files and bytes that it points at first.
    spans: Vec<(String, std::ops::Range<usize>)>,
}

impl Mistake {
    fn parse(line: &str) -> Option<Self> {
        let message = serde_json::from_str::<Value>(line).ok()?;
        let message = message.get("message").filter(|message| message["level"] == "error")?;
        let spans = message["spans"].as_array()?.iter().filter(|span| span["is_primary"] == true);
        let place = |span: &Value| {
            let byte = |name: &str| span[name].as_u64().map(|at| at as usize);
            Some((span["file_name"].as_str()?.to_owned(), byte("byte_start")?..byte("byte_end")?))
        };
        let spans: Vec<_> = spans.filter_map(place).collect();
        let text = message["message"].as_str().unwrap_or_default().to_owned();
        (!spans.is_empty()).then_some(Self { message: text, spans })
    }

    /// The function that must stay constant, if that is the mistake.
    fn constant(&self) -> Option<String> {
        let called = self.message.strip_prefix("cannot call non-const ")?.split('`').nth(1)?;
        let mut depth = 0;
        let without_types: String = called
            .chars()
            .filter(|letter| {
                depth += i32::from(*letter == '<');
                let kept = depth == 0;
                depth -= i32::from(*letter == '>');
                kept
            })
            .collect();
        without_types.rsplit("::").next().map(str::to_owned)
    }
}

/// Refuses what the compiler points at. False if that is nothing of ours.
fn blame(mistakes: &[Mistake], files: &Files, mutants: &[Mutant], refused: &mut Refused) -> bool {
    let mut changed = false;
    for mistake in mistakes {
        if let Some(name) = mistake.constant() {
            changed |= refused.constant.insert(name);
            continue;
        }
        for (file, span) in &mistake.spans {
            let Some(edited) = files.get(file) else { continue };
            let (numbers, within) = at(edited, span);
            for number in numbers {
                let by_itself =
                    within && mutants.get(number).is_some_and(|mutant| mutant.genre == Genre::FnValue);
                let list = if by_itself { &mut refused.unviable } else { &mut refused.alone };
                changed |= list.insert(number);
            }
        }
    }
    changed
}

/// The mutants that a span points at, and whether it lies within what was written for them: else those whose text it
/// touches, else those last before it.
fn at(edited: &edits::Edited, span: &std::ops::Range<usize>) -> (Vec<usize>, bool) {
    let own = || edited.pieces.iter().filter(|(_, mutants)| !mutants.is_empty());
    if let Some((_, mutants)) = own().find(|(piece, _)| piece.start <= span.start && span.end <= piece.end) {
        return (mutants.clone(), true);
    }
    let touched: BTreeSet<usize> = own()
        .filter(|(piece, _)| piece.start < span.end && span.start < piece.end)
        .flat_map(|(_, mutants)| mutants.iter().copied())
        .collect();
    if !touched.is_empty() {
        return (touched.into_iter().collect(), false);
    }
    let before = own().filter(|(piece, _)| piece.end <= span.start).max_by_key(|(piece, _)| piece.end);
    (before.map(|(_, mutants)| mutants.clone()).unwrap_or_default(), false)
}

/// Mutants that nothing was written for.
fn without_branch(mutants: &[Mutant], files: &Files, refused: &Refused) -> Vec<usize> {
    let written: BTreeSet<usize> = files
        .values()
        .flat_map(|file| &file.pieces)
        .flat_map(|(_, mutants)| mutants.iter().copied())
        .collect();
    (0..mutants.len())
        .filter(|number| !written.contains(number) && !refused.unviable.contains(number))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_compiler_points_at_a_mutant() {
        let edited =
            edits::Edited { text: String::new(), pieces: vec![(10..20, vec![1]), (30..40, vec![2, 3])] };
        assert_eq!(at(&edited, &(12..15)), (vec![1], true));
        assert_eq!(at(&edited, &(15..35)), (vec![1, 2, 3], false));
        assert_eq!(at(&edited, &(50..55)), (vec![2, 3], false));
        assert_eq!(at(&edited, &(1..2)), (vec![], false));
    }

    #[test]
    fn compiler_names_functions_that_stay_constant() {
        let named = |message: &str| Mistake { message: message.to_owned(), spans: vec![] }.constant();
        let message = "cannot call non-const associated function `CobId::<3>::of` in constants";
        assert_eq!(named(message).as_deref(), Some("of"));
        let message = "cannot call non-const function `can::slcan::nibble` in constant functions";
        assert_eq!(named(message).as_deref(), Some("nibble"));
        assert_eq!(named("mismatched types"), None);
    }
}
