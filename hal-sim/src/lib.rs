//! Plays the world: scene, people, robot physics, sensors that emit the bytes of the wire, faults as middleware.
//!
//! The encoders here are written from the wire-format specification and never call the decoders of the drivers, so
//! that one misreading cannot cancel itself out.
#![forbid(unsafe_code)]
