//! The floor camera: two devices of the kernel, one of depth and one of colour, and how they look at the floor.

use std::path::PathBuf;

use floorguard_core::sensing::PinholeCamera;
use floorguard_runtime::configuration::Mounting;

/// A depth camera, with a colour camera beside it that shows the same view.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraConfiguration {
    /// Device of the depth pictures: whole millimetres, sixteen bits (Z16).
    pub depth: PathBuf,
    /// Device of the colour pictures, if dirt is to be seen.
    pub colour: Option<PathBuf>,
    /// Columns and rows of both.
    pub size: (usize, usize),
    /// Intrinsics of the rectified pictures.
    pub camera: PinholeCamera,
    /// Where it is; pitched nose down.
    pub mounting: Mounting,
}

/// Parses `v4l2:DEVICE`.
#[must_use]
pub(super) fn parse_video(text: &str) -> Option<PathBuf> {
    text.strip_prefix("v4l2:").filter(|device| device.starts_with('/')).map(PathBuf::from)
}
