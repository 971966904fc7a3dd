//! Facts on what the report shows beside the sources.

use std::collections::BTreeMap;

use serde::Deserialize;

/// Requirements and hazards.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trace {
    /// The document of the requirements.
    pub requirements: String,
    /// The document of the hazards.
    pub hazards: String,
    /// The file of `enum Cause`.
    pub causes: String,
    /// The file of `enum Source`, which some causes name.
    pub sources: String,
    /// Where code and tests may name a requirement.
    pub folders: Vec<String>,
    /// Folder of the integration tests.
    pub tests_folder: String,
}

/// What other commands keep.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Records {
    /// Instructions by stage, on the emulator.
    pub instructions: String,
    /// The inputs that cost a stage the most.
    pub worst_inputs: String,
    /// The manual that the report quotes.
    pub manual: String,
}

/// States that tests print, and their picture.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct States {
    /// Where the manual has the picture.
    pub picture: String,
    /// Every state.
    pub shown: Vec<State>,
}

/// A state in the picture.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// As the tests print it.
    pub name: String,
    /// Its middle from the left, picture units.
    pub x: f32,
    /// Its middle from above, picture units.
    pub y: f32,
    /// What it means.
    pub meaning: String,
    /// What leaves it needs a reset.
    #[serde(default)]
    pub reset: bool,
}

/// The image that runs on an emulator.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Firmware {
    /// Its package.
    pub package: String,
    /// Its program.
    pub binary: String,
    /// Profile of Cargo.
    pub profile: String,
    /// Target of the compiler.
    pub target: String,
    /// The stack that all of it may need, bytes.
    pub stack_bytes: u64,
    /// Instructions at most, by what is counted.
    #[serde(default)]
    pub budgets: BTreeMap<String, u64>,
    /// What is counted, in words.
    #[serde(default)]
    pub stages: BTreeMap<String, String>,
    /// Endings of such names, and the words that they add.
    #[serde(default)]
    pub suffixes: BTreeMap<String, String>,
}

/// What a long campaign aims at.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Goal {
    /// In words.
    pub what: String,
    /// The campaign.
    pub campaign: String,
    /// `trials`, or what the campaign counts.
    pub count: String,
    /// How many.
    pub aim: u64,
}
