//! Citations of documents that are not part of this repository.

use std::sync::LazyLock;

use regex_lite::Regex;

/// Each pattern finds one way to cite a document that only its writers had: sections of a specification by their
/// letters, numbers of remarks, deviations and stages, reports by bare numbers, and files beside the repository.
const PATTERNS: [&str; 11] = [
    r"\b[Aa]lgorithms,? (section )?([A-Z]\b|[A-Z]?\d)",
    r"\b[Ww]ire-formats?,? (section )?\d",
    r"\b([Pp]latform|[Aa]rchitecture|[Ss]tyle[- ]guide),? (section )?\d",
    r"\b[Ii]ssues? #?\d",
    r"\b(AMB|DEV)-\d",
    r"\b[A-X]\.\d",
    r"\bK\d\d?\b",
    r"\bP[0-4]\b",
    r"\b[TX]-\d\d\b",
    r"\.\./shared($|[^/]|/[^d])",
    r"\b(algorithms|wire-formats|platform|style-guide)\.md",
];

static REFUSED: LazyLock<Vec<Regex>> =
    LazyLock::new(|| PATTERNS.iter().map(|pattern| Regex::new(pattern).expect("a pattern")).collect());

/// What is cited in this prose that a reader cannot find.
pub fn refused(prose: &str) -> Vec<String> {
    REFUSED.iter().filter_map(|pattern| pattern.find(prose).map(|found| found.as_str().to_owned())).collect()
}
