//! Faults as seeded middleware between the devices and their receivers.

mod bridged_edit;
mod edit;
mod layer;
mod spec;
mod target;

pub use layer::FaultLayer;
pub use spec::{FaultError, FaultKind, FaultSpec};
pub use target::FaultTarget;
