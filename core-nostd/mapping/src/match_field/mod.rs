//! What a scan is matched against: for every cell, how near the nearest return is.

mod field;
mod part;
mod stamp;
mod view;

pub use field::{MatchField, coarsen};
pub use part::FieldPart;
pub use view::{FieldLevel, FieldSample};
