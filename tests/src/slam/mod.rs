//! Five published laser logs mapped by our command, and the relation errors beside those of other programs.

mod logs;
mod table;

pub use table::slam;
