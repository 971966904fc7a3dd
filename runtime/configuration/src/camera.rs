//! The floor camera: two devices of the kernel, one of depth and one of colour, and how they look at the floor.

use std::path::PathBuf;

use floorguard_core::sensing::PinholeCamera;
use floorguard_runtime::configuration::Mounting;

use super::devices::{read_mounting, read_source};
use super::reader::Reader;

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
fn parse_video(text: &str) -> Option<PathBuf> {
    text.strip_prefix("v4l2:").filter(|device| device.starts_with('/')).map(PathBuf::from)
}

/// A camera that looks down at the floor before the robot.
pub(super) fn read_camera(section: Reader<'_>) -> Option<CameraConfiguration> {
    let depth = read_source(&section, "v4l2:/dev/video2", parse_video);
    let colour = section.find("colour_source").and_then(|_| {
        let (text, span) = section.text("colour_source", "v4l2:/dev/video4")?;
        let device = parse_video(text);
        if device.is_none() {
            section.refuse(
                &span,
                format!("[camera]: `colour_source` is \"{text}\", no address of this kind"),
                "write for example \"v4l2:/dev/video4\"",
            );
        }
        device
    });
    // The core has room for pictures of this size.
    let size = (section.integer("width", 64..=640) as usize, section.integer("height", 48..=480) as usize);
    let focal = [section.number("fx", 30.0..=2_000.0), section.number("fy", 30.0..=2_000.0)];
    let centre = [section.number("cx", 0.0..=640.0), section.number("cy", 0.0..=480.0)];
    let mounting = read_mounting(section.section("mounting"));
    if mounting.roll_rad.abs() > 0.1 || !(0.2..1.5).contains(&mounting.pitch_rad) {
        section.refuse(
            section.span(),
            "[camera]: rolled by more than 6°, or not pitched down by 11° to 86°",
            "mount the camera so that it looks down at the floor before the robot",
        );
    }
    section.finish();
    let camera = PinholeCamera::new(focal, centre)?;
    Some(CameraConfiguration { depth: depth?, colour, size, camera, mounting })
}
