//! Faults as seeded middleware between the devices and whoever listens.

mod layer;
mod spec;

pub use layer::FaultLayer;
pub use spec::{FaultError, FaultKind, FaultSpec};
