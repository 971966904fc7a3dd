//! What `tests/audit.toml` says of a project: nothing of it stands in the code.

mod report;
mod runs;
mod tree;

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use anyhow::{Context, Result};
use serde::Deserialize;

use crate::shell::{self, FILE};

pub use report::{Firmware, Goal, Records, State, States, Trace};
pub use runs::{Kind, NotCounted, Part, Share, Stage, Suite};
pub use tree::{HostedOnly, Image, OwnIterator, Sources, Structure};

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
    /// How people start the tool.
    pub command: String,
    /// Folders of sources.
    pub sources: Sources,
    /// Rules of the tree as a whole.
    pub structure: Structure,
    /// The image that is disassembled.
    pub image: Image,
    /// Iterators that audited crates write themselves.
    #[serde(default)]
    pub own_iterator: Vec<OwnIterator>,
    /// What runs on a Linux computer only.
    #[serde(default)]
    pub hosted_only: Vec<HostedOnly>,
    /// Requirements and hazards.
    pub trace: Trace,
    /// What other commands keep.
    pub records: Records,
    /// States that tests print, and their picture.
    pub states: States,
    /// The image that runs on an emulator.
    pub firmware: Option<Firmware>,
    /// What long campaigns aim at.
    #[serde(default)]
    pub goal: Vec<Goal>,
    /// Campaigns that something else runs, so that they are known by name.
    #[serde(default)]
    pub other_campaigns: Vec<String>,
    /// Campaigns: tests that take their part from the environment.
    #[serde(default)]
    pub campaign: Vec<Kind>,
    /// Shares that campaigns are about.
    #[serde(default)]
    pub share: Vec<Share>,
    /// Parts of the code of which mutants are made.
    #[serde(default)]
    pub mutants: Vec<Part>,
    /// Stages in which loops are counted, the quick ones first.
    #[serde(default)]
    pub counting: Vec<Stage>,
    /// Loops that no counted test reached.
    #[serde(default)]
    pub not_counted: Vec<NotCounted>,
}

static FACTS: LazyLock<Facts> =
    LazyLock::new(|| read(&shell::root()).unwrap_or_else(|error| panic!("{error:#}")));

/// The facts of this project.
pub fn facts() -> &'static Facts {
    &FACTS
}

/// Reads them, so that a mistake in the file is reported before anything begins.
///
/// # Errors
/// The file is absent, or says what nobody asks for.
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
