//! What the structure must keep to.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context, Result};

use super::crates::Package;
use super::graph::Graph;
use super::known::{self, Offenders};
use super::modules::Modules;
use super::sizes::{self, Lines};
use super::{allowed, crates, drawing, modules};
use crate::claim::{Claim, Finding};
use crate::facts::{Structure, facts};
use crate::sources;

/// Everything that is judged.
pub struct Found {
    pub packages: Vec<Package>,
    /// By the folder of the crate.
    pub modules: BTreeMap<String, Modules>,
    pub files: Lines,
    pub document: String,
    pub known: Offenders,
}

/// Reads the tree.
pub fn read(root: &Path) -> Result<Found> {
    let packages = crates::read(root)?;
    let mut found = BTreeMap::new();
    for package in &packages {
        let folder = format!("{}/src", package.folder);
        if root.join(&folder).is_dir() {
            let files = sources::read_folders(root, std::slice::from_ref(&folder))?;
            let ident = sources::ident_of(&package.name);
            found.insert(package.folder.clone(), modules::read(&ident, &folder, &files));
        }
    }
    let document = &facts().structure.document;
    Ok(Found {
        modules: found,
        files: sizes::files(root, &facts().structure.folders)?,
        document: std::fs::read_to_string(root.join(document))
            .with_context(|| format!("cannot read {document}"))?,
        known: known::read(root)?,
        packages,
    })
}

/// Reads and judges.
pub fn judge(root: &Path) -> Result<Vec<Claim>> {
    Ok(claims(&read(root)?))
}

impl Found {
    /// What breaks a rule today.
    pub fn offenders(&self) -> Offenders {
        let limits = &facts().structure;
        let long = |lines: &Lines, limit: usize| {
            lines
                .iter()
                .filter(|(_, lines)| **lines > limit)
                .map(|(name, lines)| (name.clone(), *lines))
                .collect()
        };
        let cycles = self.modules.iter().filter_map(|(folder, modules)| {
            let members: BTreeSet<String> = modules.graph.cycles().into_iter().flatten().collect();
            (!members.is_empty()).then(|| (folder.clone(), members))
        });
        let mut arrows = BTreeMap::<String, BTreeSet<String>>::new();
        for one in allowed::forbidden(&self.packages, &allowed::rows_in(&self.document)) {
            arrows.entry(one.from).or_default().insert(one.to);
        }
        Offenders {
            files: long(&self.files, limits.file_lines),
            modules: long(&self.module_lines(), limits.module_lines),
            cycles: cycles.collect(),
            arrows,
        }
    }

    fn module_lines(&self) -> Lines {
        let folders: Vec<String> = self.packages.iter().map(|package| package.folder.clone()).collect();
        sizes::modules(&self.files, &folders)
    }

    /// What is to be drawn.
    pub fn drawing(&self) -> String {
        let graphs: Vec<(String, Graph)> =
            self.modules.iter().map(|(folder, modules)| (folder.clone(), modules.graph.clone())).collect();
        drawing::draw(&crates::graph(&self.packages), &graphs)
    }
}

/// Judges.
pub fn claims(found: &Found) -> Vec<Claim> {
    let now = found.offenders();
    vec![arrows(found, &now), cycles(found, &now), lengths(found, &now), drawn(found)]
}

fn at(place: &str, line: usize, message: String) -> Finding {
    Finding { place: place.to_owned(), line, message }
}

/// The list still has what no longer breaks its rule.
fn stale(name: &str) -> Finding {
    at(
        known::FILE,
        0,
        format!("{name} is better than this list says: `{} structure --write` shortens it", facts().command),
    )
}

fn arrows(found: &Found, now: &Offenders) -> Claim {
    let structure = &facts().structure;
    let graph = crates::graph(&found.packages);
    let mut findings = Vec::new();
    for (from, (to, new)) in known::compare_sets(&now.arrows, &found.known.arrows) {
        findings.push(match (new, to.as_str()) {
            (true, "") => at(&structure.document, 0, format!("no row says what {from} may depend on")),
            (true, _) => at(
                &format!("{from}/Cargo.toml"),
                0,
                format!("must not know {to}, says the table of {}", structure.document),
            ),
            (false, _) => stale(&format!("{from} → {to}")),
        });
    }
    for cycle in graph.cycles() {
        let members = cycle.into_iter().collect::<Vec<_>>().join(", ");
        findings.push(at("Cargo.toml", 0, format!("these crates know one another in a circle: {members}")));
    }
    let known: usize = found.known.arrows.values().map(BTreeSet::len).sum();
    let count: usize = graph.names().map(|name| graph.of(name).count()).sum();
    Claim {
        id: "crates-layered",
        text: "Each crate knows only what the table of the architecture allows, and no crates know one another in a circle.",
        evidence: format!(
            "{} crates, {count} arrows between them; {known} still to go",
            found.packages.len()
        ),
        findings,
    }
}

fn cycles(found: &Found, now: &Offenders) -> Claim {
    let mut findings = Vec::new();
    for (folder, (module, new)) in known::compare_sets(&now.cycles, &found.known.cycles) {
        let Some(modules) = found.modules.get(&folder).filter(|_| new) else {
            findings.push(stale(&format!("{folder}: {module}")));
            continue;
        };
        let cycle =
            modules.graph.cycles().into_iter().find(|cycle| cycle.contains(&module)).unwrap_or_default();
        let places = modules.places.iter().filter(|((from, to), _)| *from == module && cycle.contains(to));
        for ((from, to), (file, line)) in places {
            let members = cycle.iter().cloned().collect::<Vec<_>>().join(", ");
            findings.push(at(
                file,
                *line,
                format!("`{from}` names `{to}` here and is on the cycle {members}"),
            ));
        }
    }
    let count: usize = found.modules.values().map(|modules| modules.graph.names().count()).sum();
    let known: usize = found.known.cycles.values().map(BTreeSet::len).sum();
    Claim {
        id: "modules-acyclic",
        text: "No top modules of a crate name one another in a circle.",
        evidence: format!("{count} modules of {} crates; {known} still on a cycle", found.modules.len()),
        findings,
    }
}

fn lengths(found: &Found, now: &Offenders) -> Claim {
    let Structure { file_lines, module_lines, median_lines, .. } = &facts().structure;
    let mut findings = Vec::new();
    let judged = [
        (&now.files, &found.known.files, file_lines, "file"),
        (&now.modules, &found.known.modules, module_lines, "module"),
    ];
    for (now, known, limit, what) in judged {
        for (name, new) in known::compare_lines(now, known) {
            let lines = now.get(&name).copied().unwrap_or(0);
            let message = match known.get(&name) {
                Some(known) => {
                    format!("has {lines} lines; it had {known} when the rule was made and must not grow")
                }
                None => format!("has {lines} lines; a {what} has at most {limit}"),
            };
            findings.push(if new { at(&name, 0, message) } else { stale(&name) });
        }
    }
    let median = sizes::median(&found.files);
    if median > *median_lines {
        findings.push(at(
            ".",
            0,
            format!("half of the files have more than {median} lines; {median_lines} are wanted"),
        ));
    }
    Claim {
        id: "files-short",
        text: "Files and modules are short enough to be read; clippy watches over functions.",
        evidence: format!(
            "{} files, the median has {median} lines, the longest {}; still too long: {} files, {} modules",
            found.files.len(),
            found.files.values().max().copied().unwrap_or(0),
            found.known.files.len(),
            found.known.modules.len()
        ),
        findings,
    }
}

fn drawn(found: &Found) -> Claim {
    let document = &facts().structure.document;
    let message = match drawing::within(&found.document) {
        None => Some("has no markers between which the graph is drawn"),
        Some(drawn) if drawn != found.drawing() => {
            Some("draws another graph than that of today; `structure --write` draws it again")
        }
        Some(_) => None,
    };
    Claim {
        id: "structure-drawn",
        text: "The graph of crates and modules in the architecture is that of today.",
        evidence: format!("drawn from Cargo's metadata and from the paths of {} crates", found.modules.len()),
        findings: message.map(|message| at(document, 0, message.to_owned())).into_iter().collect(),
    }
}
