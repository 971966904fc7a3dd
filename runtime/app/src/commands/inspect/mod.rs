//! `floorguard inspect`: what is in a recording, what is wrong with it, and what can be done with it, on one page.

mod bag;
mod capture;
mod lines;
mod page;
mod run;
mod serial;
mod timeline;

pub use run::{InspectArguments, run};
pub use serial::{inertial, scanner};
