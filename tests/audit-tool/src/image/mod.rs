//! The compiled image: read, disassembled, judged.

pub mod claims;
mod lines;
mod linked;
pub mod roots;
pub mod thumb;

pub use linked::{CompiledLoop, Function, Image, PanicCall, build, is_panic, read};
