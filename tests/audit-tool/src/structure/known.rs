//! What broke a rule on the day that it was made: a list that can only shrink.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, Result};
use serde::Deserialize;

/// Where the list is.
pub const FILE: &str = "tests/structure-known.toml";

/// What breaks a rule: today, or on the day that the list was written.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Offenders {
    /// Lines of files that are too long.
    pub files: BTreeMap<String, usize>,
    /// Lines of modules that are too long.
    pub modules: BTreeMap<String, usize>,
    /// Modules in a cycle, by the folder of their crate.
    pub cycles: BTreeMap<String, BTreeSet<String>>,
    /// Crates that know another against the table, and these.
    pub arrows: BTreeMap<String, BTreeSet<String>>,
}

/// Reads the list; without a file nothing is known.
pub fn read(root: &Path) -> Result<Offenders> {
    match std::fs::read_to_string(root.join(FILE)) {
        Ok(text) => toml::from_str(&text).with_context(|| format!("{FILE} is broken")),
        Err(_) => Ok(Offenders::default()),
    }
}

/// What differs: name, and whether it is new or has grown (else it is gone or has shrunk, and the list must, too).
pub type Difference = (String, bool);

/// Files or modules that are longer than they were, or shorter than the list says.
pub fn compare_lines(now: &BTreeMap<String, usize>, known: &BTreeMap<String, usize>) -> Vec<Difference> {
    let grown = now.iter().filter(|(name, lines)| known.get(*name).is_none_or(|known| *lines > known));
    let shrunk = known.iter().filter(|(name, known)| now.get(*name).is_none_or(|lines| lines < *known));
    let grown = grown.map(|(name, _)| (name.clone(), true));
    grown.chain(shrunk.map(|(name, _)| (name.clone(), false))).collect()
}

/// Pairs `owner`, `name` that are new, or gone.
pub fn compare_sets(
    now: &BTreeMap<String, BTreeSet<String>>,
    known: &BTreeMap<String, BTreeSet<String>>,
) -> Vec<(String, Difference)> {
    let pairs = |sets: &BTreeMap<String, BTreeSet<String>>| {
        let each = |(owner, names): (&String, &BTreeSet<String>)| {
            names.iter().map(|name| (owner.clone(), name.clone())).collect::<Vec<_>>()
        };
        sets.iter().flat_map(each).collect::<BTreeSet<_>>()
    };
    let (now, known) = (pairs(now), pairs(known));
    let new = now.difference(&known).cloned().map(|(owner, name)| (owner, (name, true)));
    new.chain(known.difference(&now).cloned().map(|(owner, name)| (owner, (name, false)))).collect()
}

impl Offenders {
    /// The list, shrunk to what still breaks a rule; nothing is added, and no length grows.
    pub fn shrunk(&self, now: &Self) -> Self {
        let lines = |known: &BTreeMap<String, usize>, now: &BTreeMap<String, usize>| {
            let both = known.iter().filter_map(|(name, lines)| Some((name, lines.min(now.get(name)?))));
            both.map(|(name, lines)| (name.clone(), *lines)).collect()
        };
        let sets = |known: &BTreeMap<String, BTreeSet<String>>, now: &BTreeMap<String, BTreeSet<String>>| {
            let both = known.iter().filter_map(|(owner, names)| {
                let left: BTreeSet<String> = names.intersection(now.get(owner)?).cloned().collect();
                (!left.is_empty()).then(|| (owner.clone(), left))
            });
            both.collect()
        };
        Self {
            files: lines(&self.files, &now.files),
            modules: lines(&self.modules, &now.modules),
            cycles: sets(&self.cycles, &now.cycles),
            arrows: sets(&self.arrows, &now.arrows),
        }
    }

    /// As it is kept.
    pub fn written(&self) -> String {
        let mut text = String::from(
            "# What breaks a rule of `cargo xtask structure` and did so when the rule was made. The list only shrinks: nothing new may\n\
             # be added, no length may grow, and what no longer breaks its rule goes (`cargo xtask structure --write` does that).\n",
        );
        for (heading, lines) in [("files", &self.files), ("modules", &self.modules)] {
            let _ = writeln!(text, "\n[{heading}]");
            lines.iter().for_each(|(name, lines)| {
                let _ = writeln!(text, "\"{name}\" = {lines}");
            });
        }
        for (heading, sets) in [("cycles", &self.cycles), ("arrows", &self.arrows)] {
            let _ = writeln!(text, "\n[{heading}]");
            for (owner, names) in sets {
                let names = names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
                let _ = writeln!(text, "\"{owner}\" = [{names}]");
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(entries: &[(&str, usize)]) -> BTreeMap<String, usize> {
        entries.iter().map(|(name, lines)| ((*name).to_owned(), *lines)).collect()
    }

    fn sets(entries: &[(&str, &[&str])]) -> BTreeMap<String, BTreeSet<String>> {
        let set = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        entries.iter().map(|(owner, names)| ((*owner).to_owned(), set(names))).collect()
    }

    #[test]
    fn the_list_only_shrinks() {
        let known = Offenders {
            files: lines(&[("long.rs", 500), ("gone.rs", 450), ("grown.rs", 410)]),
            cycles: sets(&[("a", &["x", "y"])]),
            ..Offenders::default()
        };
        let now = Offenders {
            files: lines(&[("long.rs", 420), ("grown.rs", 430), ("new.rs", 401)]),
            cycles: sets(&[("a", &["y", "z"]), ("b", &["u"])]),
            ..Offenders::default()
        };
        let shrunk = known.shrunk(&now);
        assert_eq!(shrunk.files, lines(&[("grown.rs", 410), ("long.rs", 420)]));
        assert_eq!(shrunk.cycles, sets(&[("a", &["y"])]));
        let different = |name: &str, new: bool| (name.to_owned(), new);
        assert_eq!(
            compare_lines(&now.files, &shrunk.files),
            [different("grown.rs", true), different("new.rs", true)]
        );
        assert_eq!(compare_lines(&shrunk.files, &known.files).len(), 2, "one is gone, one is shorter");
        assert!(compare_lines(&known.files, &known.files).is_empty());
        let of = |owner: &str, name: &str, new: bool| (owner.to_owned(), different(name, new));
        assert_eq!(
            compare_sets(&now.cycles, &known.cycles),
            [of("a", "z", true), of("b", "u", true), of("a", "x", false)]
        );
        let read: Offenders = toml::from_str(&known.written()).expect("it is read again");
        assert_eq!(read, known);
    }
}
