//! Facts on the sources and on the image that is made of them.

use std::collections::BTreeMap;

use serde::Deserialize;

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
    /// Tasks that run the audited code, and what they share: judged by their sources.
    #[serde(default)]
    pub tasks: Vec<String>,
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
    /// Lines that a file may have.
    pub file_lines: usize,
    /// Lines that a top module may have.
    pub module_lines: usize,
    /// Lines that half of the files may exceed.
    pub median_lines: usize,
    /// Packages of others that crates below a folder may be built with; folders that are not named may choose.
    #[serde(default)]
    pub others: BTreeMap<String, Vec<String>>,
}

/// The image that is disassembled.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Image {
    /// Its package, which is the name of its program, too.
    pub package: String,
    /// Folder of its sources.
    pub sources: String,
    /// Target of the compiler.
    pub target: String,
    /// Processor of the target.
    pub cpu: String,
    /// Profile of Cargo.
    pub profile: String,
    /// How the name of a stage begins: the work that a task does for one input.
    pub stage: String,
    /// The deepest stack that a stage may need, bytes.
    pub stack_bytes: u32,
    /// The same of a stage that runs once, before any task; its name ends in `_start`.
    pub start_stack_bytes: u32,
    /// Names of libraries whose loops are not ours.
    pub libraries: Vec<String>,
    /// Where the tasks are that run stages.
    pub tasks_folder: String,
    /// By stage: the tasks that run it, parted by commas.
    #[serde(default)]
    pub tasks: BTreeMap<String, String>,
}

/// An iterator of the project's own.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnIterator {
    /// File from the root of the workspace.
    pub file: String,
    /// Name of the type.
    pub name: String,
    /// Why it comes to its end.
    pub why: String,
}

/// What runs on a Linux computer only: a crate, or some modules of it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HostedOnly {
    /// The package.
    pub package: String,
    /// Its modules; none: all of it.
    #[serde(default)]
    pub modules: Vec<String>,
    /// Why it is in no image.
    pub reason: String,
    /// Files that are compiled for a microcontroller and name it all the same, as a type that no board's code takes.
    #[serde(default)]
    pub named_by: Vec<String>,
}
