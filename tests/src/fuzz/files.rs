//! Bytes in place of files: the configuration, and recordings.
#![allow(clippy::missing_panics_doc)] // That they panic at a wrong answer is what they are for.

use std::io::Cursor;

use floorguard_configuration::parse;
use floorguard_recording::Recording;

/// A `robot.toml`. A refusal names its file.
pub fn configuration(bytes: &[u8]) -> u64 {
    match parse("robot.toml", &String::from_utf8_lossy(bytes)) {
        Ok(_) => 1,
        Err(refused) => {
            let shown = refused.to_string();
            assert!(shown.contains("robot.toml"), "a refusal names its file: {shown}");
            0
        }
    }
}

/// Each section of a configuration as a file of its own, without what only people read.
#[must_use]
pub fn sections_of(configuration: &str) -> Vec<Vec<u8>> {
    let mut sections = Vec::<Vec<u8>>::new();
    for line in configuration.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        if line.starts_with('[') {
            sections.push(Vec::new());
        }
        if let Some(section) = sections.last_mut() {
            section.extend_from_slice(line.as_bytes());
            section.push(b'\n');
        }
    }
    sections
}

/// A recording. A reader that finds no error in a corrupted file would loop for ever only if it never reached the end.
pub fn recording(bytes: Vec<u8>) -> u64 {
    Recording::new(Cursor::new(bytes)).take(10_000).filter(Result::is_ok).count() as u64
}

#[cfg(test)]
mod tests {
    use super::sections_of;

    #[test]
    fn sections_become_files_of_their_own() {
        let sections = sections_of("# words\nfirst = 1\n\n[a]\nb = 2\n# more\n[[c]]\nd = 3\n");
        assert_eq!(sections, [b"[a]\nb = 2\n".to_vec(), b"[[c]]\nd = 3\n".to_vec()]);
    }
}
