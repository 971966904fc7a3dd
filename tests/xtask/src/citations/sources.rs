//! What may be cited: chapters of the book with their headings, and the entries of its references.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use regex_lite::Regex;

use super::comments::files;

/// A chapter of the book, perhaps with a heading.
static CHAPTER: LazyLock<Regex> =
    LazyLock::new(|| Regex::new(r"\bbook, ([A-Z]|microScan3)").expect("a pattern"));

/// One or two surnames and a year; a day after it makes a date.
static PAPER: LazyLock<Regex> = LazyLock::new(|| {
    let name = "[A-ZÀ-Þ][A-Za-zÀ-ž'’-]+";
    let pattern = format!(r"({name})( et al\.?| and ({name}))?,? \(?((19|20)\d\d[a-z]?)\b(-\d)?");
    Regex::new(&pattern).expect("a pattern")
});

/// What stands before a year and is no author.
const NO_AUTHORS: &str = "January February March April May June July August September October November December \
     Monday Tuesday Wednesday Thursday Friday Saturday Sunday Rust In Since Copyright";

/// The book, as far as it is cited.
pub struct Sources {
    /// Titles of chapters, with their headings.
    pub chapters: BTreeMap<String, Vec<String>>,
    /// Entries of the references, each as one line.
    pub references: Vec<String>,
}

impl Sources {
    /// Reads the chapters below a folder; its `references.md` holds the references.
    pub fn read(folder: &Path) -> Self {
        let read = |path: &Path| std::fs::read_to_string(path).expect("a chapter");
        let mut chapters = BTreeMap::new();
        for path in files(folder) {
            let text = read(&path);
            let heading = |sign: &str| {
                let lines = text.lines().filter_map(|line| line.strip_prefix(sign));
                lines.map(str::to_owned).collect::<Vec<_>>()
            };
            if let Some(title) = heading("# ").into_iter().next() {
                chapters.insert(title, heading("## "));
            }
        }
        Self { chapters, references: entries(&read(&folder.join("references.md"))) }
    }

    /// What this prose cites and nobody can find.
    pub fn missing(&self, prose: &str) -> Vec<String> {
        let mut missing = self.missing_chapters(prose);
        missing.extend(self.missing_papers(prose));
        missing
    }

    /// `book, Guard: Collision` names a chapter and its heading, `book, Guard` a chapter.
    fn missing_chapters(&self, prose: &str) -> Vec<String> {
        let cited = CHAPTER.find_iter(prose).filter_map(|found| prose.get(found.start()..));
        let is_missing = |citation: &&str| !self.has_chapter(citation.trim_start_matches("book, "));
        cited.filter(is_missing).map(|citation| citation.chars().take(60).collect()).collect()
    }

    fn has_chapter(&self, citation: &str) -> bool {
        let title = self.chapters.keys().filter(|title| begins_with(citation, title));
        let Some(title) = title.max_by_key(|title| title.len()) else { return false };
        let rest = citation.get(title.len()..).unwrap_or_default();
        let Some(heading) = rest.strip_prefix(": ") else { return true };
        self.chapters.get(title).is_some_and(|known| known.iter().any(|known| begins_with(heading, known)))
    }

    /// `Hess et al. 2014`, `Chang and Lin 2011`, `Smith 1961`: the entry begins with the first author.
    fn missing_papers(&self, prose: &str) -> Vec<String> {
        let is_missing = |found: &regex_lite::Captures<'_>| {
            let part = |group: usize| found.get(group).map_or("", |part| part.as_str());
            let is_date = !part(6).is_empty() || NO_AUTHORS.split(' ').any(|word| word == part(1));
            let is_it = |entry: &&String| {
                begins_with(entry, part(1)) && entry.contains(part(3)) && begins_anywhere(entry, part(4))
            };
            !is_date && !self.references.iter().any(|entry| is_it(&entry))
        };
        let missing = PAPER.captures_iter(prose).filter(is_missing);
        missing.filter_map(|found| found.get(0).map(|whole| whole.as_str().to_owned())).collect()
    }
}

/// The text begins with a word or words, and they end there.
fn begins_with(text: &str, words: &str) -> bool {
    text.strip_prefix(words).is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '-'))
}

fn begins_anywhere(text: &str, word: &str) -> bool {
    text.match_indices(word).any(|(at, _)| text.get(at..).is_some_and(|rest| begins_with(rest, word)))
}

/// The entries of a list, each as one line.
fn entries(text: &str) -> Vec<String> {
    let mut entries: Vec<String> = Vec::new();
    for line in text.lines() {
        match (line.strip_prefix("* "), entries.last_mut()) {
            (Some(begin), _) => entries.push(begin.to_owned()),
            (None, Some(entry)) if line.starts_with("  ") => entry.push_str(&format!(" {}", line.trim())),
            _ => {}
        }
    }
    entries
}
