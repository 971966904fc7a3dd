//! Work that somebody outside orders, a fleet's master: places to drive to, and between them parts of the floor to clean.

mod work;
#[cfg(test)]
mod work_tests;

pub use work::OrderedWork;
