//! Runs tests with one mutant on.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use super::mutated_copy::MutatedCopy;
use crate::facts::{Suite, facts};
use crate::{shell, sources};

/// Seconds of the processor for a test, after which a mutant counts as endless, and so as noticed.
const ENDLESS_S: usize = 120;

/// A test that notes whatever it reaches takes as long as so many that do not.
const NOTING: usize = 5;

/// Names of the tests that reach the place of a mutant.
pub type Reached = BTreeMap<usize, Vec<String>>;

/// The tests of a suite, built.
pub struct Program {
    path: PathBuf,
    folder: PathBuf,
    /// Words that choose the suite's tests.
    arguments: Vec<String>,
}

impl Program {
    /// Builds the suite; `None` if it does not compile.
    pub fn build(mutated: &MutatedCopy, package: &str, suite: &Suite) -> Result<Option<Self>> {
        let mut command = mutated.cargo();
        command.args(["test", "--quiet", "--no-run", "--message-format=json", "--package", package]);
        let output =
            command.args(&suite.target).stderr(Stdio::null()).output().context("cannot start cargo")?;
        if !output.status.success() {
            return Ok(None);
        }
        let path = shell::test_executable(&String::from_utf8_lossy(&output.stdout), package);
        let path = path.context("cargo names no test executable")?;
        let folder = mutated.sources().join(sources::folder_of(package)?);
        let mut arguments: Vec<String> = suite.chosen.clone();
        arguments.extend(suite.skipped.iter().flat_map(|word| ["--skip".to_owned(), word.clone()]));
        Ok(Some(Self { path, folder, arguments }))
    }

    /// The program itself: what it is made of is what a result belongs to.
    pub fn bytes(&self) -> Result<Vec<u8>> {
        std::fs::read(&self.path).with_context(|| format!("cannot read {}", self.path.display()))
    }

    /// The names of the suite's tests.
    pub fn tests(&self) -> Result<Vec<String>> {
        let mut list = self.command("none", 1);
        let listed = list.args(&self.arguments).arg("--list").stdout(Stdio::piped()).output()?;
        let listed = String::from_utf8_lossy(&listed.stdout);
        Ok(listed.lines().filter_map(|line| line.strip_suffix(": test")).map(str::to_owned).collect())
    }

    /// These tests notice the mutant that is on; `none`: the tests as they are.
    pub fn notices(&self, mutant: &str, tests: &[String]) -> Result<bool> {
        let mut command = self.command(mutant, tests.len());
        Ok(!command.arg("--exact").args(tests).status().context("cannot start the tests")?.success())
    }

    /// The tests that reach the place of each mutant. All must pass without one.
    pub fn reached(&self, note: &Path) -> Result<Reached> {
        let mut reached = Reached::new();
        for test in self.tests()? {
            let _ = std::fs::remove_file(note);
            let mut command = self.command("note", NOTING);
            command.args(["--exact", &test]).env(facts().variable("MUTANTS_REACHED"), note);
            if !command.status()?.success() {
                bail!("{test} fails without a mutant; see it run in {}", self.folder.display());
            }
            let text = std::fs::read_to_string(note).unwrap_or_default();
            for number in text.lines().filter_map(|line| line.parse().ok()) {
                reached.entry(number).or_default().push(test.to_owned());
            }
        }
        let _ = std::fs::remove_file(note);
        Ok(reached)
    }

    /// Time for so many tests, each of which has kept to its own without a mutant. It is that of the processor: on a busy
    /// machine the clock proves nothing.
    fn command(&self, mutant: &str, tests: usize) -> Command {
        let mut command = Command::new("sh");
        let limit_s = ENDLESS_S * tests.max(1);
        command.arg("-c").arg(format!("ulimit -t {limit_s}; exec \"$0\" \"$@\"")).arg(&self.path);
        command
            .args(["--quiet", "--test-threads=1"])
            .current_dir(&self.folder)
            .env(facts().variable("MUTANT"), mutant);
        command.env("RUST_MIN_STACK", "33554432").env("PROPTEST_FAILURE_PERSISTENCE", "off");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command
    }
}
