//! The prose of a file: comments of sources, paragraphs of texts.

use std::path::{Path, PathBuf};

/// Consecutive lines of prose, joined by single spaces, so that a citation may be wrapped.
pub struct Paragraph {
    /// Its first line, counted from 1.
    pub line: usize,
    /// What it says, without the signs of a comment.
    pub text: String,
}

/// All files below a folder whose prose is checked, in the order of their paths.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut found = Vec::new();
    for entry in entries.filter_map(Result::ok) {
        let path = entry.path();
        let kind = entry.file_type().expect("a kind of file");
        let is_built = path.file_name().is_some_and(|name| name == "target" || name == ".git");
        if kind.is_dir() && !is_built {
            found.extend(files(&path));
        } else if kind.is_file() && marker(&path).is_some() {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// What begins a comment; nothing in a text, which is prose as a whole.
fn marker(path: &Path) -> Option<&'static str> {
    match path.extension()?.to_str()? {
        "rs" | "c" | "cpp" | "h" | "x" => Some("//"),
        "toml" | "py" | "sh" | "yml" => Some("#"),
        "md" => Some(""),
        _ => None,
    }
}

/// The prose of a file with this path. Code between fences is left out.
pub fn paragraphs(path: &Path, text: &str) -> Vec<Paragraph> {
    let marker = marker(path).unwrap_or_default();
    let mut found: Vec<Paragraph> = Vec::new();
    let mut goes_on = false;
    let mut in_fence = false;
    for (index, line) in text.lines().enumerate() {
        let comment = comment(line, marker);
        let prose = comment.map_or("", |(_, prose)| prose.trim());
        if prose.starts_with("```") {
            in_fence = !in_fence;
        }
        if prose.is_empty() || in_fence || prose.starts_with("```") {
            goes_on = false;
            continue;
        }
        let is_whole_line = comment.is_some_and(|(before, _)| before.trim().is_empty());
        match found.last_mut() {
            Some(last) if goes_on && is_whole_line => {
                last.text.push(' ');
                last.text.push_str(prose);
            }
            _ => found.push(Paragraph { line: index + 1, text: prose.to_owned() }),
        }
        goes_on = is_whole_line;
    }
    found
}

/// What stands before a comment, and what it says. An address such as `https://…` begins none.
fn comment<'a>(line: &'a str, marker: &str) -> Option<(&'a str, &'a str)> {
    let begins = |at: usize| !line.get(..at).is_some_and(|before| before.ends_with([':', '"', '\'', '/']));
    let at = line.match_indices(marker).map(|(at, _)| at).find(|&at| begins(at))?;
    let (before, prose) = line.split_at(at);
    let prose = prose.strip_prefix(marker).unwrap_or(prose);
    let prose = if marker == "//" { prose.trim_start_matches(['/', '!']) } else { prose };
    Some((before, prose))
}
