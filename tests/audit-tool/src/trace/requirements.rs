//! Requirements: identifier → text → code → tests → last result, both ways; hazards and the causes that answer them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use serde::Serialize;

use super::marks::{Place, Test, rust_files, scan};
use crate::claim::{Claim, Finding};
use crate::facts::facts;

/// A line of `docs/requirements.md` and what belongs to it.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Requirement {
    /// `FG-REQ-…`.
    pub id: String,
    /// The sentence.
    pub text: String,
    /// Clauses, as orientation.
    pub serves: String,
    /// Line in the document.
    pub line: usize,
    /// Where code names it.
    pub code: Vec<Place>,
    /// Its tests.
    pub tests: Vec<Test>,
    /// Hazards that it answers.
    pub hazards: Vec<String>,
}

/// A line of `docs/hazards.md`.
#[derive(Debug, Clone, Serialize)]
pub struct Hazard {
    /// `FG-HAZ-…`.
    pub id: String,
    /// The sentence.
    pub text: String,
    /// Variants of `enum Cause`.
    pub causes: Vec<String>,
    /// Identifiers.
    pub requirements: Vec<String>,
    /// Line in the document.
    pub line: usize,
}

/// All of it.
#[derive(Debug, Default, Serialize)]
pub struct Trace {
    /// By identifier.
    pub requirements: Vec<Requirement>,
    /// By identifier.
    pub hazards: Vec<Hazard>,
}

/// What the documents and sources hold; results are filled in by [`Trace::book`].
pub struct Sources {
    requirements: String,
    hazards: String,
    causes: BTreeSet<String>,
    printed_causes: BTreeSet<String>,
    code: Vec<(String, Place)>,
    tests: Vec<(String, Test)>,
}

impl Sources {
    /// Reads them.
    pub fn read(root: &Path) -> Result<Self> {
        let text =
            |path: &str| fs::read_to_string(root.join(path)).with_context(|| format!("cannot read {path}"));
        let facts = &facts().trace;
        let mut files = Vec::new();
        facts.folders.iter().for_each(|folder| rust_files(&root.join(folder), &mut files));
        files.sort();
        let (mut code, mut tests) = (Vec::new(), Vec::new());
        for path in files {
            let name = path.strip_prefix(root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            let text = fs::read_to_string(&path).with_context(|| format!("cannot read {name}"))?;
            scan(&name, &text, &mut code, &mut tests);
        }
        Ok(Self {
            requirements: text(&facts.requirements)?,
            hazards: text(&facts.hazards)?,
            causes: variants(&text(&facts.causes)?)?,
            printed_causes: printed(&text(&facts.causes)?, &text(&facts.sources)?)?,
            code,
            tests,
        })
    }

    /// The integration tests that hold tests of requirements, for `cargo test --test`.
    pub fn targets(&self) -> BTreeSet<String> {
        let files = self.tests.iter().map(|(_, test)| test.place.file.as_str());
        let stems = files.filter_map(|file| {
            let rest = file.strip_prefix(&facts().trace.tests_folder)?.strip_prefix('/')?;
            let first = rest.split('/').next()?;
            // A folder is a program, and so is a file beside it.
            Some(first.strip_suffix(".rs").unwrap_or(first))
        });
        stems.map(str::to_owned).collect()
    }

    /// The causes as the guard's table prints them: those of a source once for each source.
    pub fn printed_causes(&self) -> &BTreeSet<String> {
        &self.printed_causes
    }

    /// Puts everything together, and says what does not fit.
    pub fn trace(&self, results: &BTreeMap<String, bool>) -> (Trace, Vec<Claim>) {
        let mut findings = Vec::new();
        let requirements = &facts().trace.requirements;
        let mut trace =
            Trace { requirements: requirements_in(&self.requirements), hazards: hazards_in(&self.hazards) };
        let known: BTreeSet<String> = trace.requirements.iter().map(|line| line.id.clone()).collect();
        for (id, place) in &self.code {
            match trace.requirements.iter_mut().find(|line| line.id == *id) {
                Some(line) => line.code.push(place.clone()),
                None => {
                    findings.push(at(place, format!("{id} is named here and not listed in {requirements}")))
                }
            }
        }
        for (id, test) in &self.tests {
            match trace.requirements.iter_mut().find(|line| line.id == *id) {
                Some(line) => {
                    line.tests.push(Test { passed: results.get(&test.name).copied(), ..test.clone() });
                }
                None => findings
                    .push(at(&test.place, format!("{id} is tested here and not listed in {requirements}"))),
            }
        }
        // Where nothing ran, as when core does not compile, that is one finding and not one of each test.
        let have_run = !results.is_empty();
        if !have_run {
            findings.push(Finding {
                place: facts().trace.requirements.clone(),
                line: 0,
                message: "no test of a requirement ran".to_owned(),
            });
        }
        for line in &mut trace.requirements {
            let answers = trace.hazards.iter().filter(|hazard| hazard.requirements.contains(&line.id));
            line.hazards = answers.map(|hazard| hazard.id.clone()).collect();
            findings.extend(orphaned(line, have_run));
        }
        let hazards = self.judge_hazards(&trace.hazards, &known);
        let claims = claims(&trace, findings, hazards);
        (trace, claims)
    }

    /// A hazard names only what there is, and every cause answers one.
    fn judge_hazards(&self, hazards: &[Hazard], known: &BTreeSet<String>) -> Vec<Finding> {
        let mut findings = Vec::new();
        for hazard in hazards {
            let mut complain = |message: String| {
                findings.push(Finding { place: facts().trace.hazards.clone(), line: hazard.line, message });
            };
            for cause in hazard.causes.iter().filter(|cause| !self.causes.contains(*cause)) {
                complain(format!("{}: there is no cause `{cause}`", hazard.id));
            }
            for id in hazard.requirements.iter().filter(|id| !known.contains(*id)) {
                complain(format!("{}: there is no requirement {id}", hazard.id));
            }
            if hazard.causes.is_empty() || hazard.requirements.is_empty() {
                complain(format!("{} has no cause or no requirement", hazard.id));
            }
        }
        for cause in
            self.causes.iter().filter(|cause| !hazards.iter().any(|hazard| hazard.causes.contains(cause)))
        {
            let message = format!("cause `{cause}` answers no hazard of {}", facts().trace.hazards);
            findings.push(Finding { place: facts().trace.causes.clone(), line: 0, message });
        }
        findings
    }
}

fn claims(trace: &Trace, requirements: Vec<Finding>, hazards: Vec<Finding>) -> Vec<Claim> {
    let tests = trace.requirements.iter().flat_map(|line| &line.tests);
    let passed = tests.clone().filter(|test| test.passed == Some(true)).count();
    let places: usize = trace.requirements.iter().map(|line| line.code.len()).sum();
    vec![
        Claim {
            id: "requirements-traced",
            text: "Every requirement has code, and tests that passed in this run; nothing names a requirement that does not exist.",
            evidence: format!(
                "{} requirements, {places} places in code, {} tests, {passed} passed",
                trace.requirements.len(),
                tests.count()
            ),
            findings: requirements,
        },
        Claim {
            id: "hazards-answered",
            text: "Every hazard has causes and requirements, and every cause and requirement answers a hazard.",
            evidence: format!("{} hazards", trace.hazards.len()),
            findings: hazards,
        },
    ]
}

fn at(place: &Place, message: String) -> Finding {
    Finding { place: place.file.clone(), line: place.line, message }
}

/// What a requirement lacks, its tests' results only if there are any.
fn orphaned(line: &Requirement, have_run: bool) -> Vec<Finding> {
    let complain = |message: String| Finding {
        place: facts().trace.requirements.clone(),
        line: line.line,
        message: format!("{} {message}", line.id),
    };
    let mut findings = Vec::new();
    for (lacking, what) in [
        (line.code.is_empty(), "is named by no code"),
        (line.tests.is_empty(), "has no test"),
        (line.hazards.is_empty(), "answers no hazard"),
        (line.serves.is_empty(), "names no clauses"),
    ] {
        findings.extend(lacking.then(|| complain(what.to_owned())));
    }
    for test in line.tests.iter().filter(|test| have_run && test.passed != Some(true)) {
        let how = if test.passed.is_some() { "failed" } else { "did not run" };
        findings.push(at(&test.place, format!("{}: test {} {how}", line.id, test.name)));
    }
    findings
}

/// Cells of the rows whose first cell begins with `prefix`, with the line.
fn rows<'a>(document: &'a str, prefix: &'a str) -> impl Iterator<Item = (usize, Vec<&'a str>)> {
    document.lines().enumerate().filter_map(move |(index, line)| {
        let cells: Vec<&str> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        cells.first().is_some_and(|cell| cell.starts_with(prefix)).then_some((index + 1, cells))
    })
}

fn requirements_in(document: &str) -> Vec<Requirement> {
    let cell = |cells: &[&str], at: usize| cells.get(at).map_or_else(String::new, |text| (*text).to_owned());
    rows(document, "FG-REQ-")
        .map(|(line, cells)| Requirement {
            id: cell(&cells, 0),
            text: cell(&cells, 1),
            serves: cell(&cells, 4),
            line,
            ..Requirement::default()
        })
        .collect()
}

fn hazards_in(document: &str) -> Vec<Hazard> {
    let list = |text: &str| {
        text.split(',').map(|word| word.trim().to_owned()).filter(|word| !word.is_empty()).collect()
    };
    rows(document, "FG-HAZ-")
        .filter_map(|(line, cells)| {
            let &[id, text, causes, requirements] = cells.as_slice() else { return None };
            Some(Hazard {
                id: id.to_owned(),
                text: text.to_owned(),
                causes: list(causes),
                requirements: list(requirements),
                line,
            })
        })
        .collect()
}

/// Names of the variants of `enum Cause`.
fn variants(text: &str) -> Result<BTreeSet<String>> {
    let causes = enumeration(text, "Cause", &facts().trace.causes)?;
    Ok(causes.variants.iter().map(|variant| variant.ident.to_string()).collect())
}

/// Every value of `enum Cause` as it prints itself: `NAME`, or `NAME(SOURCE)`.
fn printed(causes: &str, sources: &str) -> Result<BTreeSet<String>> {
    let sources = enumeration(sources, "Source", &facts().trace.sources)?;
    let values =
        enumeration(causes, "Cause", &facts().trace.causes)?.variants.into_iter().flat_map(|variant| {
            let of = |source: &syn::Variant| format!("{}({})", variant.ident, source.ident);
            match variant.fields {
                syn::Fields::Unit => vec![variant.ident.to_string()],
                _ => sources.variants.iter().map(of).collect(),
            }
        });
    Ok(values.collect())
}

fn enumeration(text: &str, name: &str, path: &str) -> Result<syn::ItemEnum> {
    let file = syn::parse_file(text).with_context(|| path.to_owned())?;
    let found = file.items.into_iter().find_map(|item| match item {
        syn::Item::Enum(item) if item.ident == name => Some(item),
        _ => None,
    });
    found.with_context(|| format!("no `enum {name}` in {path}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CODE: &str = "/// Stops (FG-REQ-901).\nfn stop() {}\n#[cfg(test)]\nmod tests {\n    // FG-REQ-999\n    #[test]\n    fn fg_req_901_stops() {}\n    fn fg_req_902_is_no_test() {}\n}\n";

    fn sources(requirements: &str, hazards: &str) -> Sources {
        let (mut code, mut tests) = (Vec::new(), Vec::new());
        scan("core-nostd/guard/src/example.rs", CODE, &mut code, &mut tests);
        let causes = variants("pub enum Cause { A, B(u8) }").expect("an enum");
        let (requirements, hazards) = (requirements.to_owned(), hazards.to_owned());
        Sources { requirements, hazards, causes, printed_causes: BTreeSet::new(), code, tests }
    }

    fn messages(sources: &Sources, passed: Option<bool>) -> Vec<(usize, String)> {
        let result = passed.map(|passed| ("fg_req_901_stops", passed));
        messages_of(sources, &[result.as_slice(), &[("fg_req_900_is_elsewhere", true)]].concat())
    }

    fn messages_of(sources: &Sources, results: &[(&str, bool)]) -> Vec<(usize, String)> {
        let results = results.iter().map(|(name, passed)| ((*name).to_owned(), *passed)).collect();
        let (_, claims) = sources.trace(&results);
        claims
            .into_iter()
            .flat_map(|claim| claim.findings)
            .map(|finding| (finding.line, finding.message))
            .collect()
    }

    #[test]
    fn source_causes_are_printed_once_per_source() {
        let causes = printed("enum Cause { A, B(Source) }", "enum Source { X, Y }").expect("two enums");
        assert_eq!(causes.into_iter().collect::<Vec<_>>(), ["A", "B(X)", "B(Y)"]);
    }

    const LINE: &str = "| FG-REQ-901 | It stops. | `example.rs` | moves | ISO 1 |";
    const HAZARD: &str = "| FG-HAZ-01 | It moves. | A, B | FG-REQ-901 |";

    #[test]
    fn a_whole_chain_holds() {
        assert_eq!(messages(&sources(LINE, HAZARD), Some(true)), []);
    }

    /// As when core does not compile: one finding, not one of each test.
    #[test]
    fn nothing_run_is_reported_once() {
        let expected = [(0, "no test of a requirement ran".to_owned())];
        assert_eq!(messages_of(&sources(LINE, HAZARD), &[]), expected);
    }

    #[test]
    fn chain_breaks_are_named_with_line() {
        let one = |requirements: &str, hazards: &str, passed, line: usize, words: &str| {
            let found = messages(&sources(requirements, hazards), passed);
            assert!(found.iter().any(|(at, text)| *at == line && text.contains(words)), "{words}: {found:?}");
        };
        one(LINE, HAZARD, Some(false), 7, "failed");
        one(LINE, HAZARD, None, 7, "did not run");
        one("", HAZARD, Some(true), 1, "not listed");
        one("", HAZARD, Some(true), 1, "no requirement FG-REQ-901");
        one(
            &format!("{LINE}\n| FG-REQ-903 | No. | - | - | ISO 1 |"),
            HAZARD,
            Some(true),
            2,
            "named by no code",
        );
        one(&format!("{LINE}\n| FG-REQ-903 | No. | - | - | ISO 1 |"), HAZARD, Some(true), 2, "has no test");
        one(&format!("{LINE}\n| FG-REQ-903 | No. | - | - | |"), HAZARD, Some(true), 2, "answers no hazard");
        one(LINE, "| FG-HAZ-01 | It moves. | A, C | FG-REQ-901 |", Some(true), 1, "no cause `C`");
        one(LINE, "| FG-HAZ-01 | It moves. | A | FG-REQ-901 |", Some(true), 0, "`B` answers no hazard");
    }
}
