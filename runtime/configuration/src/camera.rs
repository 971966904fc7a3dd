//! The floor camera: where its pictures come from, and its parameters for the floor.

use std::path::PathBuf;

use floorguard_runtime::configuration::Mounting;
use floorguard_types::sensing::{ImageSize, PinholeCamera};

use super::devices::{read_mounting, read_source};
use super::reader::Reader;

/// Where pictures come from.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraSource {
    /// Devices of the kernel (V4L2).
    Devices {
        /// Device of the depth pictures: whole millimetres, sixteen bits (Z16).
        depth: PathBuf,
        /// Device of the colour pictures, if dirt is to be seen: RGB3, YUYV or MJPG.
        colour: Option<PathBuf>,
    },
    /// A folder of recorded pictures, played as if they came now; relative to the file of the configuration.
    Folder {
        /// Where it is.
        path: PathBuf,
        /// So many pictures a second; without it they come at the pace of the stamps in their names.
        rate_hz: Option<f32>,
    },
}

/// A depth camera, with a colour camera beside it that shows the same view.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraConfiguration {
    /// Where both streams come from.
    pub source: CameraSource,
    /// Columns and rows of both.
    pub size: ImageSize,
    /// Intrinsics of the rectified pictures.
    pub camera: PinholeCamera,
    /// Where it is; pitched nose down.
    pub mounting: Mounting,
}

/// For the reference: a camera as it may stand in the file.
pub(crate) const EXAMPLE_SECTION: &str = "[camera]
source = \"v4l2:/dev/video2\"
colour_source = \"v4l2:/dev/video4\"
width = 640
height = 480
fx = 525.0
fy = 525.0
cx = 319.5
cy = 239.5
mounting = { x_m = 0.9, y_m = 0.0, z_m = 0.72, pitch_deg = 45.0 }
";

/// Parses `v4l2:DEVICE`.
fn parse_video(text: &str) -> Option<PathBuf> {
    text.strip_prefix("v4l2:").filter(|device| device.starts_with('/')).map(PathBuf::from)
}

/// Parses `v4l2:DEVICE` or `folder:PATH`.
fn parse_pictures(text: &str) -> Option<CameraSource> {
    let folder = text.strip_prefix("folder:").filter(|path| !path.is_empty());
    let folder = folder.map(|path| CameraSource::Folder { path: path.into(), rate_hz: None });
    folder.or_else(|| parse_video(text).map(|depth| CameraSource::Devices { depth, colour: None }))
}

/// The streams: a device each, or a folder that holds both.
fn read_pictures(section: &Reader<'_>) -> Option<CameraSource> {
    let source = read_source(section, "v4l2:/dev/video2", parse_pictures);
    let colour = section.text_or_absent("colour_source", "v4l2:/dev/video4", "no dirt is seen");
    let rate_hz = section.number_or_absent("rate_hz", 0.1..=60.0, "the stamps in the names of the pictures");
    match source? {
        CameraSource::Devices { depth, .. } => {
            if rate_hz.is_some() {
                section.refuse(
                    section.span(),
                    "[camera]: `rate_hz` is for recorded pictures; a device has its own",
                    "leave it out, or give `source = \"folder:frames\"`",
                );
            }
            let colour = colour.and_then(|(text, span)| {
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
            Some(CameraSource::Devices { depth, colour })
        }
        CameraSource::Folder { path, .. } => {
            if let Some((_, span)) = colour {
                let what = "[camera]: the folder of `source` holds the colour pictures, too";
                section.refuse(&span, what, "leave `colour_source` out");
            }
            Some(CameraSource::Folder { path, rate_hz })
        }
    }
}

/// A camera that looks down at the floor before the robot.
pub(super) fn read_camera(section: Reader<'_>) -> Option<CameraConfiguration> {
    let source = read_pictures(&section);
    // The core's buffers hold pictures of this size.
    let size = ImageSize {
        width: section.integer("width", 64..=640) as usize,
        height: section.integer("height", 48..=480) as usize,
    };
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
    Some(CameraConfiguration { source: source?, size, camera, mounting })
}
