//! Trained models from files. Published ones stay files; the project ships only what it trained itself.

mod libsvm;
mod range;

pub use libsvm::LibsvmModel;
pub use range::RangeFile;

/// A model file that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file cannot be read.
    #[error("cannot read {path}: {cause}")]
    Read {
        /// The file.
        path: String,
        /// What the system says.
        cause: std::io::Error,
    },
    /// A line makes no sense.
    #[error("{path}, line {line}: {problem}")]
    Line {
        /// The file.
        path: String,
        /// Counted from 1.
        line: usize,
        /// What is wrong and what was expected.
        problem: String,
    },
    /// The file as a whole lacks something.
    #[error("{path}: {problem}")]
    Incomplete {
        /// The file.
        path: String,
        /// What is missing.
        problem: String,
    },
}

fn read(path: &std::path::Path) -> Result<String, ModelError> {
    std::fs::read_to_string(path)
        .map_err(|cause| ModelError::Read { path: path.display().to_string(), cause })
}
