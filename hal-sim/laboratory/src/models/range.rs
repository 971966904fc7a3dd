//! The `.range` file of `svm-scale`: bounds of each feature in the training set. Source: book, People: Scaling.

use std::path::Path;

use floorguard_perception::people::classify::Scaling;

use super::{ModelError, read};

/// Bounds, by dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeFile {
    lower: f32,
    upper: f32,
    ranges: Vec<(f32, f32)>,
}

/// No feature vector is this long: a larger index is a broken file.
const DIMENSIONS_MAX: usize = 10_000;

impl RangeFile {
    /// Reads a file.
    ///
    /// # Errors
    /// The file cannot be read or is no range file of the form `x`, `lower upper`, `index min max`…
    pub fn open(path: &Path) -> Result<Self, ModelError> {
        Self::parse(&read(path)?, &path.display().to_string())
    }

    /// Reads a text; `name` is used in errors.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn parse(text: &str, name: &str) -> Result<Self, ModelError> {
        let wrong = |line: usize, problem: String| ModelError::Line { path: name.to_owned(), line, problem };
        let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
        match lines.next() {
            Some((_, "x")) => {}
            Some((line, other)) => return Err(wrong(line, format!("expected `x`, found `{other}`"))),
            None => {
                return Err(ModelError::Incomplete {
                    path: name.to_owned(),
                    problem: "the file is empty".into(),
                });
            }
        }
        let mut file = Self { lower: -1.0, upper: 1.0, ranges: Vec::new() };
        for (line, content) in lines.filter(|(_, content)| !content.is_empty()) {
            let cells: Result<Vec<f64>, _> = content.split_whitespace().map(str::parse).collect();
            let cells = cells.map_err(|error| wrong(line, format!("`{content}`: {error}")))?;
            match cells[..] {
                [lower, upper] if line == 2 && lower < upper => {
                    (file.lower, file.upper) = (lower as f32, upper as f32);
                }
                [index, min, max]
                    if line > 2 && index >= 1.0 && index <= DIMENSIONS_MAX as f64 && min <= max =>
                {
                    let index = index as usize;
                    if file.ranges.len() < index {
                        // A dimension that the file leaves out stays unscaled.
                        file.ranges.resize(index, (0.0, 0.0));
                    }
                    file.ranges[index - 1] = (min as f32, max as f32);
                }
                _ => {
                    return Err(wrong(
                        line,
                        format!("expected `index min max` with min ≤ max, found `{content}`"),
                    ));
                }
            }
        }
        Ok(file)
    }

    /// For the classifier of the core.
    #[must_use]
    pub fn scaling(&self) -> Scaling<'_> {
        Scaling { lower: self.lower, upper: self.upper, ranges: &self.ranges }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn range_file_errors_name_the_line() {
        let file = RangeFile::parse("x\n-1 1\n1 3 7077\n3 -0.5 0.5\n", "a.range").expect("good");
        assert_eq!(file.scaling().ranges, [(3.0, 7_077.0), (0.0, 0.0), (-0.5, 0.5)]);
        let broken = RangeFile::parse("x\n-1 1\n1 3 many\n", "a.range").expect_err("broken");
        assert!(broken.to_string().starts_with("a.range, line 3"), "{broken}");
        assert!(RangeFile::parse("", "a.range").is_err());
        assert!(RangeFile::parse("y\n", "a.range").is_err());
        assert!(RangeFile::parse("x\n-1 1\n1 5 3\n", "a.range").is_err());
    }
}
