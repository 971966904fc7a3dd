//! The audit: every claim checked afresh at every run. A claim that fails names the file and the line.

#[cfg(test)]
mod image_injection_tests;
#[cfg(test)]
mod injection_tests;
#[cfg(test)]
mod refusal_tests;
mod run;
#[cfg(test)]
mod sneaky_tests;
mod tasks;

pub use run::{Options, run};
