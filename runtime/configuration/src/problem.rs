//! What is wrong with a configuration, where, and what to do about it.

use std::fmt;

/// Names closer than this (Jaro-Winkler, 0…1) are offered as "did you mean".
const SIMILAR: f64 = 0.75;

/// One mistake in `robot.toml`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Byte offset into the text.
    pub offset: usize,
    /// What is wrong, with the value and the limit.
    pub what: String,
    /// What the user can do.
    pub remedy: String,
    /// What is written is understood; only no robot drives with it. A recording of one that did can be read.
    pub is_understood: bool,
}

/// All mistakes of a file, in the order of the text. `Display` gives one line per mistake:
/// `file:line:column: what; remedy`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Refused {
    file: String,
    lines: Vec<(usize, usize, Problem)>,
}

impl Refused {
    /// Sorts the mistakes and finds their lines.
    #[must_use]
    pub fn new(file: &str, text: &str, mut problems: Vec<Problem>) -> Self {
        problems.sort_by_key(|problem| problem.offset);
        let lines = problems.into_iter().map(|problem| {
            let (line, column) = position(text, problem.offset);
            (line, column, problem)
        });
        Self { file: file.to_owned(), lines: lines.collect() }
    }

    /// How many mistakes there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.lines.len()
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (line, column, problem)) in self.lines.iter().enumerate() {
            let separator = if index == 0 { "" } else { "\n" };
            write!(
                formatter,
                "{separator}{}:{line}:{column}: {}; {}",
                self.file, problem.what, problem.remedy
            )?;
        }
        Ok(())
    }
}

/// Line and column of a byte offset, both from 1; columns count characters.
fn position(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |at| at + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

/// The known word that is nearest to this one, as a question; none if no word is near.
#[must_use]
pub fn did_you_mean(word: &str, known: &[&str]) -> Option<String> {
    let score = |candidate: &&str| strsim::jaro_winkler(word, candidate);
    let best = known.iter().copied().max_by(|a, b| score(a).total_cmp(&score(b)))?;
    (score(&best) >= SIMILAR).then(|| format!("did you mean `{best}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_characters_from_one() {
        assert_eq!(position("a\nbä c", 0), (1, 1));
        assert_eq!(position("a\nbä c", 6), (2, 4));
        assert_eq!(position("a", 99), (1, 2));
    }
}
