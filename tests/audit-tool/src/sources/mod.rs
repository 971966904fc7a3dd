//! The sources that the audit covers: which crates, which files, parsed; and whether they are still the same.

mod crates;
mod files;
mod fingerprint;
mod imports;
pub mod macros;
pub mod same_code;

pub use crates::{Crate, crates, crates_below, folder_of, ident_of, is_own, module_of, within};
pub use files::{
    SourceFile, is_test_file, is_test_only, of_the_image, parse, read_audited, read_folders, read_robot,
};
pub use fingerprint::{code_today, fingerprint, without_docs};
pub use imports::paths_of;
