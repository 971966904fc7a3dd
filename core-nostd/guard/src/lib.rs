//! Everything that can decide to move or stop, and nothing else.
//!
//! The rule of this module: at most 1,600 code lines, no decision with more than four conditions, a truth table for
//! each, and a requirement identifier (`FG-REQ-…`, listed in `docs/requirements.md`) at each rule and each test. What
//! the guard knows (fields, tables, configuration) and the words it uses are in `protection`.
//!
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::todo,
        clippy::unimplemented,
        clippy::indexing_slicing,
        clippy::as_conversions
    )
)]

#[cfg(test)]
extern crate std;

mod advice_check;
mod decide;
#[cfg(test)]
mod drive_tests;
mod field_selection;
mod limiter;
mod machine;
mod motion_checks;
mod packet_check;
pub mod people;
#[cfg(test)]
mod people_tests;
pub mod protection;
mod reset_answer;
mod rules;
mod scan_check;
mod scan_judgement;
mod source_monitor;
mod state;
mod supervisor;
#[cfg(test)]
mod tests;
mod way_check;
#[cfg(test)]
mod word_tests;

pub use crate::protection::*;
pub use machine::{DecisionMachine, Verdict};
pub use rules::{Clear, Escape};
pub use source_monitor::{FUTURE_TOLERANCE_US, SourceMonitor};
pub use supervisor::Supervisor;
