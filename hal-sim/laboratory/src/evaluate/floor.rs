//! The floor of one depth picture: plane, mask and objects, against a mask that somebody else made.

use std::path::{Path, PathBuf};

use anyhow::Context;
use floorguard_perception::floor::{
    Expectation, FloorFault, FloorModel, FloorObject, FloorParameters, ObjectFinder, PixelClass, Plane,
};
use floorguard_types::sensing::{DepthImage, ImageSize, PinholeCamera};
use floorguard_types::time::Stamp;
use image::{Rgb, RgbImage};
use serde::Serialize;

use floorguard_host::outcome::{BadInput, VerdictFailed};
use floorguard_robot::picture_files::{DepthFile, MaskFile, make_folder, read_depth, read_mask};

/// Half thickness of the floor in masks, metres: the convention of the recorded masks.
const MASK_BAND_M: f32 = 0.03;
/// Without a mounting the camera may look down or up by this, radians (50°).
const ANY_TILT_RAD: f32 = 0.872_665;
/// Without a mounting the camera is this high, metres.
const ANY_HEIGHT_M: [f32; 2] = [0.15, 3.0];
/// Wider pictures are reduced.
const COLUMNS_MAX: usize = floorguard_types::capacities::FLOOR_IMAGE_COLUMNS_MAX;
/// The search is seeded, so that the same picture gives the same answer.
const SEED: u64 = 1;

/// What to evaluate.
#[derive(Clone, Debug)]
pub struct FloorTask {
    /// The depth picture.
    pub depth: PathBuf,
    /// fx, fy, cx, cy in pixels.
    pub intrinsics: [f32; 4],
    /// Which pixels are floor.
    pub truth: Option<PathBuf>,
    /// A folder for the picture of the classes.
    pub out: Option<PathBuf>,
    /// Height (m) and downward pitch (rad) of the camera; without them any floor is searched.
    pub mounting: Option<[f32; 2]>,
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FloorReport {
    /// Unit normal that points up, in the camera's frame: x right, y down, z forward.
    pub normal: [f32; 3],
    /// Height of the camera above the plane, metres.
    pub distance_m: f32,
    /// Intersection over union of the floor pixels with the mask, among the pixels that have a depth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_iou: Option<f64>,
    /// Pixels within 3 cm of the plane.
    pub floor_pixels: u64,
    /// Pixels with a depth.
    pub returns: u64,
    /// Root mean square of the heights of the floor, metres.
    pub rms_m: f32,
    /// Coefficients of the curvature, 1/m.
    pub curvature_per_m: [f32; 3],
    /// What stands on the floor within the working range, nearest first.
    pub objects: Vec<ObjectReport>,
    /// Objects beyond the capacity.
    pub objects_dropped: u32,
    /// Pixels of the file along one that was examined.
    pub reduced_by: usize,
}

/// One object.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ObjectReport {
    /// Middle of the footprint: metres right of and before the camera's foot point.
    pub position_m: [f32; 2],
    /// Sides of the footprint, metres.
    pub size_m: [f32; 2],
    /// Greatest height above the floor, metres.
    pub height_m: f32,
    /// Pixels.
    pub pixels: u32,
    /// Belief within 0..=1.
    pub confidence: f32,
    /// Rectangle in the picture: left, top, width, height.
    pub rectangle_px: [u16; 4],
}

impl ObjectReport {
    /// Of an object in a picture that was reduced by a factor.
    fn of(object: &FloorObject, reduced_by: usize) -> Self {
        let by = reduced_by as u16;
        let ([lx, ly], [hx, hy]) = (object.low_m, object.high_m);
        let ([left, top], [right, bottom]) = (object.first_px, object.last_px);
        Self {
            position_m: [0.5 * (lx + hx), 0.5 * (ly + hy)],
            size_m: [hx - lx, hy - ly],
            height_m: object.height_m,
            pixels: object.pixels * u32::from(by) * u32::from(by),
            confidence: object.confidence,
            rectangle_px: [left, top, right - left + 1, bottom - top + 1].map(|value| value * by),
        }
    }
}

/// Fits the floor of one picture.
///
/// # Errors
/// A file or the intrinsics cannot be used, or nothing returned; or the picture shows no floor, which is a failed
/// verdict. Either way the floor is unknown.
pub fn floor(task: &FloorTask) -> anyhow::Result<FloorReport> {
    let file = read_depth(&task.depth)?;
    let size = ImageSize { width: file.width, height: file.height };
    let truth = task.truth.as_deref().map(|path| read_mask(path, size)).transpose()?;
    let camera = camera(task.intrinsics, (&task.depth, size))?;
    let parameters = parameters(camera, task.mounting)?;
    let bad = |problem: String| BadInput(format!("{}: {problem}", task.depth.display()));
    let whole = DepthImage::new(Stamp::ZERO, size, &file.depth_mm).map_err(|p| bad(p.to_string()))?;
    let (reduced, reduced_by) = reduced(&file);
    let parameters = parameters_at(&parameters, reduced_by);
    let size = ImageSize { width: reduced.width, height: reduced.height };
    let image = DepthImage::new(Stamp::ZERO, size, &reduced.depth_mm).map_err(|p| bad(p.to_string()))?;
    let estimate = FloorModel::new(parameters, SEED).update(&image, Stamp::ZERO);
    let mut classes = vec![PixelClass::Unknown; reduced.depth_mm.len()];
    if let Some(fault @ FloorFault::NoReturns { .. }) = estimate.fault {
        return Err(bad(format!("floor unknown: {fault}")).into());
    }
    if let Some(fault) = estimate.fault {
        return Err(VerdictFailed(format!("{}: floor unknown: {fault}", task.depth.display())).into());
    }
    let mask = band(&whole, &camera, &estimate.plane);
    let found = ObjectFinder::default()
        .find(&image, (&parameters, &estimate), &mut classes)
        .map_err(|problem| bad(problem.to_string()))?;
    if let Some(folder) = &task.out {
        let stem = task.depth.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let path = make_folder(folder)?.join(format!("{stem}_floor.png"));
        let mask = band(&image, &parameters.camera, &estimate.plane);
        let picture = picture(&image, (&mask, &classes), &found.objects);
        picture.save(&path).with_context(|| format!("{}: cannot be written", path.display()))?;
    }
    Ok(FloorReport {
        normal: estimate.plane.normal,
        distance_m: estimate.plane.distance_m,
        floor_iou: truth.as_ref().map(|truth| overlap(&mask, truth, &file.depth_mm)),
        floor_pixels: mask.iter().filter(|is_floor| **is_floor).count() as u64,
        returns: whole.returns() as u64,
        rms_m: estimate.quality.rms_m,
        curvature_per_m: estimate.curvature.coefficients_per_m,
        objects: found.objects.iter().map(|object| ObjectReport::of(object, reduced_by)).collect(),
        objects_dropped: found.dropped,
        reduced_by,
    })
}

/// The camera of a picture of a size.
///
/// # Errors
/// There is no such camera, or not with such a picture: its optical axis would meet the picture's plane outside of the
/// picture. Swapped pictures of two cameras would otherwise appear as a missing floor.
pub(super) fn camera(
    [fx, fy, cx, cy]: [f32; 4],
    (path, ImageSize { width, height }): (&Path, ImageSize),
) -> anyhow::Result<PinholeCamera> {
    let camera = PinholeCamera::new([fx, fy], [cx, cy])
        .ok_or_else(|| BadInput(format!("intrinsics {fx},{fy},{cx},{cy}: no such camera")))?;
    let is_within = |centre: f32, count: usize| (-0.5..count as f32).contains(&centre);
    if is_within(cx, width) && is_within(cy, height) {
        return Ok(camera);
    }
    let problem = format!(
        "{}: the picture has {width} × {height} pixels, but intrinsics {fx},{fy},{cx},{cy} are those of about {:.0} × {:.0}",
        path.display(),
        (2.0 * cx + 1.0).max(0.0),
        (2.0 * cy + 1.0).max(0.0)
    );
    Err(BadInput(problem).into())
}

pub(super) fn parameters(
    camera: PinholeCamera,
    mounting: Option<[f32; 2]>,
) -> anyhow::Result<FloorParameters> {
    let parameters = match mounting {
        Some([height_m, pitch_rad]) => FloorParameters::mounted(camera, height_m, pitch_rad),
        None => Plane::of_mounting(1.0, 0.0).map(|mounted| {
            let expectation =
                Expectation { mounted, tilt_max_rad: ANY_TILT_RAD, distance_range_m: ANY_HEIGHT_M };
            FloorParameters::expecting(camera, expectation)
        }),
    };
    parameters.ok_or_else(|| BadInput("a camera below the floor".to_owned()).into())
}

/// Stride of pixels along both sides, so that the picture fits; depths are no means, which would lie between objects.
fn reduced(file: &DepthFile) -> (DepthFile, usize) {
    let by = file.width.div_ceil(COLUMNS_MAX).max(1);
    let (width, height, first) = ((file.width / by).max(1), (file.height / by).max(1), (by - 1) / 2);
    let pixel = |index: usize| {
        let (column, row) = (by * (index % width) + first, by * (index / width) + first);
        file.depth_mm.get(row * file.width + column).copied().unwrap_or(0)
    };
    (DepthFile { width, height, depth_mm: (0..width * height).map(pixel).collect() }, by)
}

/// The same for a picture that was reduced.
fn parameters_at(parameters: &FloorParameters, by: usize) -> FloorParameters {
    let ([fx, fy], [cx, cy]) = (parameters.camera.focal_px(), parameters.camera.centre_px());
    let (scale, first) = (1.0 / by as f32, ((by - 1) / 2) as f32);
    let centre = [scale * (cx - first), scale * (cy - first)];
    let camera = PinholeCamera::new([scale * fx, scale * fy], centre).unwrap_or(parameters.camera);
    FloorParameters { camera, ..*parameters }
}

/// Pixels within the band around the plane.
fn band(image: &DepthImage<'_>, camera: &PinholeCamera, plane: &Plane) -> Vec<bool> {
    let mut mask = Vec::with_capacity(image.depth_mm().len());
    for (row, depths) in image.rows().enumerate() {
        for (column, depth) in depths.iter().enumerate() {
            let z = f32::from(*depth) * 0.001;
            let point = camera.ray(column as f32, row as f32).map(|value| value * z);
            mask.push(*depth > 0 && plane.height_m(point).abs() < MASK_BAND_M);
        }
    }
    mask
}

/// Depth in grey, floor green (lighter where it is beyond the working range), objects red in a frame, holes blue.
fn picture(
    image: &DepthImage<'_>,
    (mask, classes): (&[bool], &[PixelClass]),
    objects: &[FloorObject],
) -> RgbImage {
    let (width, height) = (image.width() as u32, image.height() as u32);
    let mut picture = RgbImage::new(width, height);
    let pixels = image.depth_mm().iter().zip(mask).zip(classes).zip(picture.pixels_mut());
    for (((depth, is_floor), class), pixel) in pixels {
        let grey = if *depth == 0 { 0 } else { 230 - (u32::from(*depth).min(6_000) / 32) as u8 };
        *pixel = match class {
            PixelClass::Object => Rgb([215, grey / 3, grey / 3]),
            PixelClass::Hole => Rgb([grey / 4, grey / 3, 220]),
            PixelClass::Floor => Rgb([grey / 2, 90 + grey / 2, grey / 2]),
            _ if *is_floor => Rgb([grey - grey / 4, 60 + grey / 2, grey - grey / 4]),
            _ => Rgb([grey; 3]),
        };
    }
    for object in objects {
        let ([left, top], [right, bottom]) = (object.first_px, object.last_px);
        let frame = Rgb([255, 210, 40]);
        for column in u32::from(left)..=u32::from(right) {
            picture.put_pixel(column, u32::from(top), frame);
            picture.put_pixel(column, u32::from(bottom), frame);
        }
        for row in u32::from(top)..=u32::from(bottom) {
            picture.put_pixel(u32::from(left), row, frame);
            picture.put_pixel(u32::from(right), row, frame);
        }
    }
    picture
}

/// Intersection over union where there is a depth: what the camera did not see, neither side can know.
fn overlap(found: &[bool], truth: &MaskFile, depth_mm: &[u16]) -> f64 {
    let seen = || found.iter().zip(&truth.marked).zip(depth_mm).filter(|(_, depth)| **depth > 0);
    let both = seen().filter(|((a, b), _)| **a && **b).count();
    let either = seen().filter(|((a, b), _)| **a || **b).count();
    if either == 0 { 0.0 } else { both as f64 / either as f64 }
}

/// `fx,fy,cx,cy` as typed on the command line.
///
/// # Errors
/// Not four numbers.
pub fn parse_intrinsics(text: &str) -> Result<[f32; 4], String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|cell| cell.trim().parse::<f32>()).collect();
    let numbers = numbers.map_err(|problem| format!("`{text}`: {problem}"))?;
    numbers.try_into().map_err(|_| format!("`{text}`: four numbers are needed: fx,fy,cx,cy"))
}
