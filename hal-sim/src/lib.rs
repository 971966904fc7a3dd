//! Plays the world: scene, people, robot physics, sensors that emit the bytes of the wire, faults as middleware.
//!
//! The encoders here are written from the chapters on wire formats of the book and never call the decoders of the drivers, so
//! that one misreading cannot cancel itself out.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod actuated;
pub mod can;
pub mod dirt;
pub mod faults;
pub mod floor;
pub mod hazards;
pub mod motors;
pub mod people;
pub mod robot;
pub mod scenario;
pub mod scene;
pub mod sensors;
pub mod simulation;
pub mod wire;

pub use can::CanFrame;
pub use faults::{FaultKind, FaultLayer, FaultSpec, FaultTarget};
pub use scenario::Scenario;
pub use simulation::{Simulation, Truth};
pub use wire::{Payload, Stream, WireEvent};
