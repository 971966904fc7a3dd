//! Where code and tests name a requirement.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// A place in the sources.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Place {
    /// File from the workspace root.
    pub file: String,
    /// Line.
    pub line: usize,
}

/// A test that checks a requirement.
#[derive(Debug, Clone, Serialize)]
pub struct Test {
    /// Name of the function.
    pub name: String,
    /// Where it stands.
    pub place: Place,
    /// Last result; `None` when it did not run.
    pub passed: Option<bool>,
}

/// Names in comments of code; functions `fg_req_NNN_…` anywhere.
pub fn scan(file: &str, text: &str, code: &mut Vec<(String, Place)>, tests: &mut Vec<(String, Test)>) {
    let is_test_file = file.contains("/tests/") || file.ends_with("_tests.rs") || file.ends_with("/tests.rs");
    let (mut in_tests, mut is_test) = (is_test_file, false);
    for (index, line) in text.lines().enumerate() {
        let place = Place { file: file.to_owned(), line: index + 1 };
        in_tests |= line.trim() == "mod tests {";
        if let Some((_, name)) = line.split_once("fn fg_req_") {
            let name: String = name.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let number: String = name.chars().take(3).collect();
            if is_test {
                let test = Test { name: format!("fg_req_{name}"), place: place.clone(), passed: None };
                tests.push((format!("FG-REQ-{number}"), test));
            }
        }
        // Attributes stand between `#[test]` and the function, and so do doc comments.
        is_test = line.trim() == "#[test]" || (is_test && !line.contains("fn "));
        if !in_tests {
            let ids = line.split("FG-REQ-").skip(1).map(|rest| rest.chars().take(3).collect::<String>());
            let ids =
                ids.filter(|number| number.len() == 3 && number.bytes().all(|byte| byte.is_ascii_digit()));
            code.extend(ids.map(|number| (format!("FG-REQ-{number}"), place.clone())));
        }
    }
}

/// Every Rust file below a folder.
pub fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for path in fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}
