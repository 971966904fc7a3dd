//! Facts on long runs: campaigns, mutants, counted loops.

use serde::Deserialize;

/// A test that takes its part of a campaign from the environment.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kind {
    /// Name on the command line.
    pub name: String,
    /// What a trial is.
    pub trial: String,
    /// Package that holds the test.
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
    /// The campaign.
    pub campaign: String,
    /// The count that is a part …
    pub part: String,
    /// … of this one.
    pub whole: String,
    /// The largest share.
    pub at_most: Option<f64>,
    /// The smallest share.
    pub at_least: Option<f64>,
}

/// A part of the code of which mutants are made.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Name of the campaign.
    pub name: String,
    /// Package that is changed, and whose tests must notice.
    pub package: String,
    /// Patterns of files.
    pub files: Vec<String>,
    /// Share of viable mutants that must be caught or explained, per cent.
    pub wanted_percent: f64,
    /// The quick ones first: a later one sees what survived the earlier ones.
    pub suites: Vec<Suite>,
}

/// Some tests in one program.
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

/// Some tests in which loops are counted.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// None: the audited ones.
    #[serde(default)]
    pub packages: Vec<String>,
    /// In the last package these programs of tests only; none: all.
    #[serde(default)]
    pub programs: Vec<String>,
    /// In these programs the tests of these modules only; none: all.
    #[serde(default)]
    pub modules: Vec<String>,
}

/// Loops that no counted test reached, and the tests that are to reach them.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NotCounted {
    /// How the paths of their files begin.
    pub path: String,
    /// Files of tests.
    pub tests: Vec<String>,
}
