//! What `tests/audit.toml` says of the project: nothing of it stands in the code.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use anyhow::{Context, Result};
use serde::Deserialize;

use crate::shell;

/// Where the facts are, from the root of the workspace.
pub const FILE: &str = "tests/audit.toml";

/// All of them.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Facts {
    /// Name of the project, for headings.
    pub project: String,
    /// How the names of the project's packages begin.
    pub own_packages: String,
    /// How the names of the environment variables begin by which tests take their orders.
    pub environment: String,
    pub sources: Sources,
    pub structure: Structure,
    pub image: Image,
    pub trace: Trace,
    #[serde(default)]
    pub hosted_only: Vec<HostedOnly>,
    #[serde(default)]
    pub not_counted: Vec<NotCounted>,
    #[serde(default)]
    pub counting: Vec<Stage>,
    #[serde(default)]
    pub mutants: Vec<Part>,
    #[serde(default)]
    pub campaign: Vec<Kind>,
    #[serde(default)]
    pub share: Vec<Share>,
}

/// Folders of sources.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sources {
    /// Every crate at or below these is audited.
    pub audited: Vec<String>,
    /// All that the robot and its simulator are made of.
    pub robot: Vec<String>,
    /// What is compiled for a microcontroller besides the audited crates.
    pub firmware: Vec<String>,
    /// The package that every audited crate knows.
    pub helpers: String,
    /// Features under which audited crates are checked in a copy.
    #[serde(default)]
    pub features: Vec<String>,
}

/// Rules of the tree as a whole.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Structure {
    /// Has the table of what may depend on what, and the markers between which the graph is drawn.
    pub document: String,
    /// Where Rust files are.
    pub folders: Vec<String>,
    /// Lines that a file, a top module, and half of the files may have.
    pub file_lines: usize,
    pub module_lines: usize,
    pub median_lines: usize,
}

/// The image that is disassembled.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Image {
    pub package: String,
    pub sources: String,
    pub target: String,
    pub cpu: String,
    pub profile: String,
    /// How the name of a stage begins.
    pub stage: String,
    pub stack_bytes: u32,
    pub start_stack_bytes: u32,
    pub libraries: Vec<String>,
}

/// Requirements and hazards.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trace {
    pub requirements: String,
    pub hazards: String,
    pub causes: String,
    pub sources: String,
    pub folders: Vec<String>,
    /// Package and folder of the integration tests.
    pub tests: String,
    pub tests_folder: String,
}

/// What runs on a Linux computer only: a crate, or some modules of it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HostedOnly {
    pub package: String,
    #[serde(default)]
    pub modules: Vec<String>,
    pub reason: String,
}

/// Loops that no counted test reached, and the tests that are to reach them.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NotCounted {
    pub path: String,
    pub tests: Vec<String>,
}

/// Some tests in which loops are counted.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// None: the audited ones.
    #[serde(default)]
    pub packages: Vec<String>,
    /// In the last package these files of tests only; none: all.
    #[serde(default)]
    pub files: Vec<String>,
}

/// A part of the code of which mutants are made.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Name of the campaign.
    pub name: String,
    pub package: String,
    pub files: Vec<String>,
    /// Share of viable mutants that must be caught or explained, per cent.
    pub wanted_percent: f64,
    pub suites: Vec<Suite>,
}

/// Some tests of that package in one program.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Suite {
    /// `--lib`, or `--test` with the name of the file.
    pub target: Vec<String>,
    /// Words that choose tests; none: all of them.
    #[serde(default)]
    pub chosen: Vec<String>,
    /// Words of tests that are left out.
    #[serde(default)]
    pub skipped: Vec<String>,
}

/// A test that takes its part of a campaign from the environment.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kind {
    pub name: String,
    /// What a trial is.
    pub trial: String,
    pub package: String,
    /// `--lib`, or `--test` with the name of the file.
    pub target: Vec<String>,
    /// Path of the test.
    pub test: String,
    /// Trials of one process: some seconds of work.
    pub block: u64,
    /// Trials of a whole campaign.
    pub trials: u64,
    /// Runtime and simulator make the trials, too, not only the audited crates.
    #[serde(default)]
    pub whole_robot: bool,
    /// It plays on the firmware.
    #[serde(default)]
    pub firmware: bool,
}

/// A share of what a campaign counts, and what it must keep to.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Share {
    pub campaign: String,
    pub part: String,
    pub whole: String,
    pub at_most: Option<f64>,
    pub at_least: Option<f64>,
}

static FACTS: LazyLock<Facts> =
    LazyLock::new(|| read(&shell::root()).unwrap_or_else(|error| panic!("{error:#}")));

/// The facts of this project.
pub fn facts() -> &'static Facts {
    &FACTS
}

/// Reads them, so that a mistake in the file is told in words before anything begins.
pub fn check() -> Result<()> {
    read(&shell::root()).map(|_| ())
}

fn read(root: &Path) -> Result<Facts> {
    let text = fs::read_to_string(root.join(FILE)).with_context(|| format!("cannot read {FILE}"))?;
    toml::from_str(&text).with_context(|| format!("{FILE} is broken"))
}

impl Facts {
    /// The name of an environment variable.
    pub fn variable(&self, name: &str) -> String {
        format!("{}_{name}", self.environment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_fact_is_refused() {
        let text = fs::read_to_string(shell::root().join(FILE)).expect("the facts");
        assert!(toml::from_str::<Facts>(&text).is_ok());
        assert!(toml::from_str::<Facts>(&text.replace("helpers =", "helper =")).is_err());
        assert!(toml::from_str::<Facts>(&text.replace("at_most", "at_mots")).is_err());
    }
}
