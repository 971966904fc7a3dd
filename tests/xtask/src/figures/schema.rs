//! The records of measured figures; `docs/evidence/figures/README.md` describes every field.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use serde::Deserialize;

/// What stands where something was not written down when it was measured.
pub const NOT_RECORDED: &str = "not recorded";

/// All figures of one subject: one page.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Subject {
    /// Of the file and of the page.
    #[serde(skip)]
    pub name: String,
    /// Pages with smaller numbers come first.
    pub order: u32,
    pub title: String,
    pub about: String,
    pub experiments: Vec<Experiment>,
}

/// Figures that were measured together.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    pub title: String,
    /// A later experiment of the page replaces it; its figures count in no sum.
    #[serde(default)]
    pub former: bool,
    pub data: String,
    pub seed: String,
    pub n: String,
    pub command: String,
    pub record: Record,
    pub figures: Vec<Figure>,
    #[serde(default)]
    pub misses: Vec<String>,
    /// Without gain.
    #[serde(default)]
    pub tried: Vec<String>,
    #[serde(default)]
    pub notes: Vec<String>,
}

/// When and on what it was measured.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    pub measured_on: String,
    /// Date of the commit that first printed the figures.
    pub printed_on: String,
    /// The code that was measured; of older figures the commit that first printed them.
    pub commit: String,
    pub machine: String,
    pub load: String,
}

/// One row. What is absent is that of its experiment.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figure {
    pub metric: String,
    pub data: Option<String>,
    pub seed: Option<String>,
    pub n: Option<String>,
    pub result: String,
    pub interval: Option<String>,
    pub target: Option<String>,
    pub met: Option<Met>,
    pub command: Option<String>,
}

/// Whether the target was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Met {
    Yes,
    No,
}

/// Reads and checks every record below a folder, in the order of the pages.
///
/// # Errors
/// A record cannot be read, is no such record, or contradicts itself.
pub fn read(folder: &Path) -> Result<Vec<Subject>> {
    let entries = std::fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
    let mut subjects = Vec::new();
    for entry in entries {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "json") {
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let text = std::fs::read_to_string(&path)?;
            subjects.push(parse(&name, &text).with_context(|| path.display().to_string())?);
        }
    }
    subjects.sort_by(|one, other| (one.order, &one.name).cmp(&(other.order, &other.name)));
    Ok(subjects)
}

/// One record, checked.
pub fn parse(name: &str, text: &str) -> Result<Subject> {
    let mut subject: Subject = serde_json::from_str(text)?;
    name.clone_into(&mut subject.name);
    for experiment in &subject.experiments {
        check(experiment).with_context(|| experiment.title.clone())?;
    }
    Ok(subject)
}

/// Targets have a verdict, verdicts a target, and a missed target is explained.
fn check(experiment: &Experiment) -> Result<()> {
    let Record { measured_on, printed_on, commit, machine, load } = &experiment.record;
    for (field, text) in [
        ("measured_on", measured_on),
        ("printed_on", printed_on),
        ("commit", commit),
        ("machine", machine),
        ("load", load),
        ("data", &experiment.data),
        ("seed", &experiment.seed),
        ("n", &experiment.n),
        ("command", &experiment.command),
    ] {
        ensure!(!text.is_empty(), "`{field}` is empty; what is unknown is \"{NOT_RECORDED}\"");
    }
    ensure!(!experiment.figures.is_empty(), "no figures");
    for figure in &experiment.figures {
        let has_both = figure.target.is_some() == figure.met.is_some();
        ensure!(has_both, "{}: a target has `met`, and `met` a target", figure.metric);
    }
    let is_missed = experiment.figures.iter().any(|figure| figure.met == Some(Met::No));
    ensure!(!is_missed || !experiment.misses.is_empty(), "a target is missed and `misses` is empty");
    Ok(())
}
