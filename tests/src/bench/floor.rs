//! Times of the floor camera's stages on the shared pictures of 640 × 480.

use std::path::Path;

use floorguard_laboratory::evaluate::DirtTotals;
use floorguard_perception::floor::dirt::PublishedDetector;
use floorguard_perception::floor::{FloorModel, FloorParameters, ObjectFinder, PixelClass, Plane};
use floorguard_robot::picture_files::{DepthFile, DirtDetectors, read_colour, read_depth, read_mask};
use floorguard_types::sensing::{ColorImage, DepthImage, ImageSize, PinholeCamera};
use floorguard_types::time::Stamp;

use super::peers::OurTime;
use super::{Took, took};
use crate::data::bench_input;
use crate::dirt::view;
use floorguard_sim::floor::FloorCamera;
use floorguard_types::geometry::Pose2;

const ROUNDS: usize = 60;

/// How long a stage takes, milliseconds a frame.
#[derive(Clone, Debug)]
pub struct FrameTime {
    /// The picture.
    pub input: &'static str,
    /// What was measured.
    pub stage: &'static str,
    /// Median over the rounds.
    pub median: Took,
    /// The fastest round: what the machine can do when nobody else is at it.
    pub fastest: Took,
}

/// Measures floor, objects and dirt; an absent picture is left out, with a line.
#[must_use]
pub fn run_floor() -> Vec<FrameTime> {
    let mut rows = Vec::new();
    for (input, path) in [("depth_0", "depth/depth_0.png"), ("depth_6", "depth/depth_6.png")] {
        if let Some(path) = bench_input(path) {
            rows.extend(depth(input, &path));
        }
    }
    for (input, path) in [("floor_0", "dirt/floor_0.png"), ("floor_3", "dirt/floor_3.png")] {
        if let Some(path) = bench_input(path) {
            rows.extend(dirt(input, &path));
        }
    }
    rows
}

fn times(input: &'static str, stage: &'static str, mut once: impl FnMut(usize)) -> FrameTime {
    let all: Vec<Took> = (0..ROUNDS).map(|round| took(|| once(round))).collect();
    FrameTime { input, stage, median: Took::median(&all), fastest: Took::fastest(&all) }
}

fn depth(input: &'static str, path: &Path) -> Option<FrameTime> {
    let (mut model, file) = model_and_picture(path)?;
    let parameters = *model.parameters();
    let mut finder = Box::<ObjectFinder>::default();
    let mut classes = vec![PixelClass::Unknown; file.depth_mm.len()];
    let mut pixels = file.depth_mm.clone();
    Some(times(input, "floor plane and objects", |round| {
        // Another last bit in every round, as from a living camera: identical frames would be a frozen one.
        pixels[0] = round as u16 % 2;
        let stamp = Stamp::from_micros(33_333 * (round as u64 + 1));
        if let Ok(image) =
            DepthImage::new(stamp, ImageSize { width: file.width, height: file.height }, &pixels)
        {
            let estimate = model.update(&image, stamp);
            let _ = std::hint::black_box(finder.find(&image, (&parameters, &estimate), &mut classes));
        }
    }))
}

/// Plane and objects of one depth picture, as on the robot; nothing that one installs does the same.
pub(super) fn objects() -> Option<OurTime> {
    let row = depth("depth_0", &bench_input("depth/depth_0.png")?)?;
    let note = "floor plane and objects; aim 3 ms".to_owned();
    Some(OurTime {
        task: "floor",
        input: row.input.to_owned(),
        median: row.median,
        fastest: row.fastest,
        note,
    })
}

/// Plane fits of the benchmark's depth pictures, with how far they are from the truth.
///
/// # Errors
/// The truth cannot be read.
pub(super) fn planes() -> anyhow::Result<Vec<OurTime>> {
    let Some(truth) = bench_input("depth/truth.json") else { return Ok(Vec::new()) };
    let truth: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(truth)?)?;
    let mut times = Vec::new();
    for frame in truth["frames"].as_array().into_iter().flatten() {
        let input = format!("depth_{}", frame["k"]);
        let path = bench_input(&format!("depth/{input}.png")).filter(|path| path.exists());
        let Some((mut model, mut file)) = path.and_then(|path| model_and_picture(&path)) else { continue };
        let mut found = None;
        let all = (0..ROUNDS as u64).map(|round| {
            file.depth_mm[0] = round as u16 % 2;
            let stamp = Stamp::from_micros(33_333 * (round + 1));
            let image =
                DepthImage::new(stamp, ImageSize { width: file.width, height: file.height }, &file.depth_mm)
                    .ok();
            took(|| found = image.map(|image| model.update(&image, stamp).plane))
        });
        let all: Vec<Took> = all.collect();
        let Some(found) = found else { continue };
        // That file's normals point down.
        let component = |index: usize| -frame["normal"][index].as_f64().unwrap_or(0.0) as f32;
        let Some(exact) = Plane::new([component(0), component(1), component(2)], 1.0) else { continue };
        let angle = found.tilt_from_rad(&exact).to_degrees();
        let off_mm = 1e3 * (f64::from(found.distance_m) - frame["h"].as_f64().unwrap_or(0.0)).abs();
        let note = format!("{angle:.3}°, {off_mm:.1} mm off; from the picture, with curvature");
        times.push(OurTime::of("plane", input, &all, note));
    }
    Ok(times)
}

/// Our detector of dirt on the benchmark's floors, with how well it tells blocks apart.
///
/// # Errors
/// A picture cannot be judged.
pub(super) fn dirt_blocks() -> anyhow::Result<Vec<OurTime>> {
    let mut times = Vec::new();
    for number in 0..10 {
        let input = format!("floor_{number}");
        let at = |name: String| bench_input(&name).filter(|path| path.exists());
        let (Some(path), Some(mask)) =
            (at(format!("dirt/{input}.png")), at(format!("dirt/{input}_mask.png")))
        else {
            continue;
        };
        let (file, truth) = {
            let file = read_colour(&path)?;
            let truth = read_mask(&mask, ImageSize { width: file.width, height: file.height })?;
            (file, truth)
        };
        let image =
            ColorImage::new(Stamp::ZERO, ImageSize { width: file.width, height: file.height }, &file.rgb)?;
        let usable = vec![true; file.width * file.height];
        let mut detectors = DirtDetectors::default();
        let [_, answer] = detectors.judge(&image, &usable, None)?;
        let judged: Vec<bool> = answer.scores.iter().map(|score| !score.is_nan()).collect();
        let mut totals = DirtTotals::default();
        totals.add(&answer, (&truth.marked, &judged), file.width);
        let once = || assert!(std::hint::black_box(detectors.watch(&image, &usable, None)).is_ok());
        let all: Vec<Took> = std::iter::repeat_with(once_timed(once)).take(ROUNDS).collect();
        let note = format!("block AUC {:.4}; our method, aim 6 ms", totals.figures().block_auc);
        times.push(OurTime::of("dirt", input, &all, note));
    }
    Ok(times)
}

/// Times one call after another.
fn once_timed(mut once: impl FnMut()) -> impl FnMut() -> Took {
    move || took(&mut once)
}

fn model_and_picture(path: &Path) -> Option<(Box<FloorModel>, DepthFile)> {
    let file = read_depth(path).ok()?;
    let camera = PinholeCamera::new([525.0, 525.0], [319.5, 239.5])?;
    let any = floorguard_perception::floor::Expectation {
        mounted: Plane::of_mounting(1.0, 0.0)?,
        tilt_max_rad: 0.872_665,
        distance_range_m: [0.15, 3.0],
    };
    Some((Box::new(FloorModel::new(FloorParameters::expecting(camera, any), 1)), file))
}

fn dirt(input: &'static str, path: &Path) -> Vec<FrameTime> {
    let Ok(file) = read_colour(path) else { return Vec::new() };
    let Ok(image) =
        ColorImage::new(Stamp::ZERO, ImageSize { width: file.width, height: file.height }, &file.rgb)
    else {
        return Vec::new();
    };
    let usable = vec![true; file.width * file.height];
    let mut published = Box::<PublishedDetector>::default();
    let mut ours = DirtDetectors::default();
    let camera = FloorCamera::default();
    vec![
        times(input, "dirt, published", |_| {
            let _ = std::hint::black_box(published.detect(&image, &usable));
        }),
        times(input, "dirt, ours", |_| {
            let _ = std::hint::black_box(ours.watch(&image, &usable, None));
        }),
        times(input, "dirt, ours over frames", |round| {
            let view = view(&camera, Pose2::new(0.1 * round as f32, 0.0, 0.0));
            let _ = std::hint::black_box(ours.watch(&image, &usable, Some(&view)));
        }),
    ]
}
