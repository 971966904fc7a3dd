//! Clouds in the colours of a camera's pictures.

mod pictures;
#[cfg(test)]
mod tests;

pub use pictures::{CameraView, Colouring};
