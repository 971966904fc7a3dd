//! Bytes in place of files: the configuration, and recordings.
#![allow(clippy::missing_panics_doc)] // That they panic at a wrong answer is what they are for.

use std::io::Cursor;

use floorguard_hosted::configuration::parse;
use floorguard_hosted::recording::Recording;

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

/// A recording. A reader that finds nothing wrong in a spoilt file would go on for ever only if it never came to the end.
pub fn recording(bytes: Vec<u8>) -> u64 {
    Recording::new(Cursor::new(bytes)).take(10_000).filter(Result::is_ok).count() as u64
}
