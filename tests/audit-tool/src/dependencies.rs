//! What is linked into the safety image besides our own code: each crate with its licence and the reason for it.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};
use serde::Serialize;

use crate::claim::{Claim, Finding};
use crate::facts::facts;
use crate::shell;

const MANIFEST: &str = "Cargo.toml";
/// Licences that let anybody build and sell the image.
const LICENCES: [&str; 6] = ["MIT", "Apache-2.0", "BSD-3-Clause", "Unlicense", "Zlib", "0BSD"];

/// A crate of the image.
#[derive(Debug, Serialize)]
pub struct Dependency {
    /// Name and version.
    pub name: String,
    /// As its manifest says.
    pub licence: String,
    /// Why it is there: our words for a crate of the table, otherwise who needs it.
    pub reason: String,
}

/// Asks cargo for the tree of the safety image.
pub fn read(root: &Path) -> Result<(Vec<Dependency>, Claim)> {
    let manifest = std::fs::read_to_string(root.join(MANIFEST)).context("cannot read Cargo.toml")?;
    let reasons = reasons_in(&manifest);
    let mut command: Command = shell::cargo();
    command.args(["tree", "--package", &facts().image.package, "--target", &facts().image.target]);
    command.args(["--edges", "normal", "--prefix", "depth", "--format", "|{p}|{l}", "--no-dedupe"]);
    let text = shell::output(&mut command).context("cargo tree fails")?;
    let dependencies = dependencies_in(&text, &reasons);
    let findings = dependencies.iter().filter_map(|found| complaint(found, &manifest)).collect();
    let claim = Claim {
        id: "dependencies-known",
        text: "Every crate of the safety image has a reason and a licence that permits its use.",
        evidence: format!("{} crates besides our own, from cargo tree", dependencies.len()),
        findings,
    };
    Ok((dependencies, claim))
}

/// `name = …  # reason` of the workspace table.
fn reasons_in(manifest: &str) -> BTreeMap<String, String> {
    let table = manifest.split("[workspace.dependencies]").nth(1).unwrap_or_default();
    let lines = table.lines().take_while(|line| !line.starts_with('['));
    let reasons = lines.filter_map(|line| {
        let (name, rest) = line.split_once(" = ")?;
        let (_, reason) = rest.rsplit_once("# ")?;
        Some((name.trim().to_owned(), reason.trim().to_owned()))
    });
    reasons.collect()
}

/// Lines `DEPTH|NAME vVERSION (…)|LICENCE`.
fn dependencies_in(tree: &str, reasons: &BTreeMap<String, String>) -> Vec<Dependency> {
    let mut found = BTreeMap::new();
    let mut path: Vec<String> = Vec::new();
    for line in tree.lines() {
        let mut parts = line.split('|');
        let depth: usize = parts.next().and_then(|depth| depth.trim().parse().ok()).unwrap_or(0);
        let (package, licence) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
        let name = package.split(' ').next().unwrap_or_default();
        path.truncate(depth);
        path.push(name.to_owned());
        if name.starts_with(&facts().own_packages) || name.is_empty() {
            continue;
        }
        let parent = path.len().checked_sub(2).and_then(|at| path.get(at)).cloned().unwrap_or_default();
        let reason = match reasons.get(name) {
            Some(reason) => reason.clone(),
            None if !parent.starts_with(&facts().own_packages) => format!("needed by {parent}"),
            None => String::new(),
        };
        let full = package.split(' ').take(2).collect::<Vec<_>>().join(" ");
        let licence = licence.trim().trim_end_matches(" (*)").to_owned();
        found.entry(full.clone()).or_insert(Dependency { name: full, licence, reason });
    }
    found.into_values().collect()
}

fn complaint(found: &Dependency, manifest: &str) -> Option<Finding> {
    let allowed = LICENCES.iter().any(|licence| found.licence.contains(licence));
    let what = match (found.reason.is_empty(), allowed) {
        (false, true) => return None,
        (true, _) => "has no reason: write one behind it in the table of the workspace",
        (false, false) => "has an unreviewed licence",
    };
    let name = found.name.split(' ').next().unwrap_or_default();
    let line =
        manifest.lines().position(|line| line.starts_with(&format!("{name} ="))).map_or(0, |at| at + 1);
    Some(Finding {
        place: MANIFEST.to_owned(),
        line,
        message: format!("{} ({}) {what}", found.name, found.licence),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_and_licences_are_asked_for() {
        let manifest = "[workspace.dependencies]\nlibm = { version = \"0.2\" }   # same bits\ncrc = \"3\"\n[profile.dev]\n";
        let tree = "0|floorguard-types v0.1.0 (/x)|MIT\n1|libm v0.2.16|MIT\n2|inner v1.0.0|GPL-3.0\n1|crc v3.0.0|MIT\n";
        let found = dependencies_in(tree, &reasons_in(manifest));
        let shown: Vec<_> = found.iter().map(|one| (one.name.as_str(), one.reason.as_str())).collect();
        assert_eq!(
            shown,
            [("crc v3.0.0", ""), ("inner v1.0.0", "needed by libm"), ("libm v0.2.16", "same bits")]
        );
        let complaints: Vec<_> =
            found.iter().filter_map(|one| complaint(one, manifest)).map(|f| f.line).collect();
        assert_eq!(complaints, [3, 0], "crc has no reason in line 3, the licence of inner is unknown");
    }
}
