//! A log as a file, packed or not, read line by line.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::line::{CarmenLine, LineError, parse_line};
use floorguard_host::packing;

/// A log that cannot be read to its end. Everything before has been delivered.
#[derive(Debug, thiserror::Error)]
pub enum CarmenError {
    /// The file cannot be opened.
    #[error("{path}: cannot be opened: {cause}")]
    Open {
        /// The file.
        path: String,
        /// What the system says.
        cause: std::io::Error,
    },
    /// It cannot be read on.
    #[error("{path}, line {line}: cannot be read ({cause})")]
    Read {
        /// The file.
        path: String,
        /// Number of the line, from 1.
        line: usize,
        /// What the system or the unpacking says.
        cause: std::io::Error,
    },
    /// A line is damaged.
    #[error("{path}, line {line}: {cause}")]
    Line {
        /// The file.
        path: String,
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        cause: LineError,
    },
}

/// A log being read.
pub struct CarmenLog {
    path: String,
    source: BufReader<Box<dyn Read + Send>>,
    line: usize,
    finished: bool,
}

/// A line of a log is never longer: a binary file must not fill the memory.
const LINE_BYTES_MAX: u64 = 1 << 20;

impl CarmenLog {
    /// Opens a log.
    ///
    /// # Errors
    /// The file cannot be opened.
    pub fn open(path: &Path) -> Result<Self, CarmenError> {
        let shown = path.display().to_string();
        let opened = File::open(path).and_then(packing::unpacked);
        let source = opened.map_err(|cause| CarmenError::Open { path: shown.clone(), cause })?;
        Ok(Self { path: shown, source: BufReader::new(source), line: 0, finished: false })
    }
}

impl Iterator for CarmenLog {
    type Item = Result<CarmenLine, CarmenError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.finished {
            return None;
        }
        self.line += 1;
        let mut bytes = Vec::new();
        let read = self.source.by_ref().take(LINE_BYTES_MAX).read_until(b'\n', &mut bytes);
        let (path, line) = (self.path.clone(), self.line);
        let parsed = match read {
            Ok(0) => {
                self.finished = true;
                return None;
            }
            Ok(_) => {
                let text = String::from_utf8_lossy(&bytes);
                parse_line(&text).map_err(|cause| CarmenError::Line { path, line, cause })
            }
            Err(cause) => Err(CarmenError::Read { path, line, cause }),
        };
        self.finished = parsed.is_err();
        Some(parsed)
    }
}
