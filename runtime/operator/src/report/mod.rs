//! The report of a recording as one page, and the parts of which every report is made.

pub mod charts;
mod close_up;
mod document;
mod folder;
mod grids;
mod history;
mod mission;
mod pdf;
mod proof;
mod proof_section;
mod sheet;
mod sketch;
mod slider;
pub mod style;

pub use close_up::Fields;
pub use document::document;
pub use folder::make_folder;
pub use history::{History, read_history};
pub use pdf::pdf;
pub use proof::{
    Cell, Circumstances, Cleaning, NotClaimed, Proof, ProofStop, cells, cells_csv, made_now, proof,
};
pub use sheet::Sheet;
