//! Bad depth pictures: each is refused with a reason, and the floor is unknown, not free.

use std::path::{Path, PathBuf};

use floorguard_host::outcome::BadInput;
use floorguard_laboratory::evaluate::{FloorTask, floor};
use floorguard_perception::floor::{FloorFault, FloorModel, FloorParameters, FloorSource, Plane};
use floorguard_types::sensing::{DepthImage, FrameFault, ImageSize, PinholeCamera};
use floorguard_types::time::Stamp;

const WIDTH: usize = 160;
const HEIGHT: usize = 120;
const CAMERA_HEIGHT_M: f32 = 0.72;
const PITCH_RAD: f32 = 0.7;

fn camera() -> PinholeCamera {
    PinholeCamera::new([131.25, 131.25], [79.5, 59.5]).expect("a camera")
}

fn model() -> FloorModel {
    FloorModel::new(FloorParameters::mounted(camera(), CAMERA_HEIGHT_M, PITCH_RAD).expect("a mounting"), 7)
}

/// A level floor; `salt` moves single millimetres, as depth noise does.
fn level_floor(salt: usize) -> Vec<u16> {
    let plane = Plane::of_mounting(CAMERA_HEIGHT_M, PITCH_RAD).expect("a plane");
    let camera = camera();
    let pixel = |index: usize| {
        let ray = camera.ray((index % WIDTH) as f32, (index / WIDTH) as f32);
        let towards: f32 = plane.normal.iter().zip(ray).map(|(n, r)| n * r).sum();
        let jitter = (index * 7 + salt * 13) % 3;
        let depth_mm = 1_000.0 * plane.distance_m / -towards;
        if towards < -0.05 { depth_mm as u16 + jitter as u16 } else { 0 }
    };
    (0..WIDTH * HEIGHT).map(pixel).collect()
}

fn image(depth_mm: &[u16], at_us: u64) -> DepthImage<'_> {
    DepthImage::new(Stamp::from_micros(at_us), ImageSize { width: WIDTH, height: HEIGHT }, depth_mm)
        .expect("the size fits")
}

#[test]
fn missing_fit_reuses_plane_then_unknown() {
    let mut model = model();
    let (good, dark) = (level_floor(0), vec![0; WIDTH * HEIGHT]);
    let measured = model.update(&image(&good, 1_000_000), Stamp::from_micros(1_000_000));
    assert_eq!((measured.source, measured.is_known, measured.fault), (FloorSource::Measured, true, None));
    for (age_us, source, is_known) in [
        (900_000, FloorSource::Reused(900_000), true),
        (1_000_001, FloorSource::Reused(1_000_001), false),
        (2_000_000, FloorSource::Reused(2_000_000), false),
        (2_000_001, FloorSource::Configured, false),
    ] {
        let now = Stamp::from_micros(1_000_000 + age_us);
        let estimate = model.update(&image(&dark, 1_000_000 + age_us), now);
        assert_eq!((estimate.source, estimate.is_known), (source, is_known), "{age_us} µs");
        assert_eq!(estimate.fault, Some(FloorFault::NoReturns { found: 0, pixels: WIDTH * HEIGHT }));
        if source == FloorSource::Configured {
            assert_eq!(estimate.plane, model.parameters().expectation.mounted);
        } else {
            assert_eq!(estimate.plane, measured.plane);
        }
    }
}

#[test]
fn a_model_that_has_seen_nothing_knows_nothing() {
    let estimate = model().without_frame(Stamp::from_micros(5));
    assert_eq!((estimate.source, estimate.is_known), (FloorSource::Configured, false));
}

#[test]
fn frozen_camera_differs_from_still_one() {
    let mut model = model();
    let (frozen, other) = (level_floor(0), level_floor(1));
    let mut faults = Vec::new();
    for frame in 0..5_u64 {
        let now = Stamp::from_micros(100_000 * (frame + 1));
        let estimate = model.update(&image(&frozen, 100_000 * (frame + 1)), now);
        faults.push((estimate.fault, estimate.is_known));
    }
    assert_eq!(faults[1], (None, true));
    assert_eq!(faults[2], (Some(FloorFault::Frame(FrameFault::Frozen(3))), false));
    assert_eq!(faults[4], (Some(FloorFault::Frame(FrameFault::Frozen(5))), false));
    let moved = model.update(&image(&other, 600_000), Stamp::from_micros(600_000));
    assert_eq!((moved.fault, moved.is_known), (None, true));
}

#[test]
fn future_and_old_stamps_are_refused() {
    let mut model = model();
    let good = level_floor(0);
    let early = model.update(&image(&good, 1_000), Stamp::from_micros(400));
    assert_eq!(early.fault, Some(FloorFault::Frame(FrameFault::FromTheFuture(600))));
    assert!(!early.is_known);
    assert!(model.update(&image(&good, 1_000), Stamp::from_micros(1_000)).is_known);
    let again = model.update(&image(&good, 1_000), Stamp::from_micros(2_000));
    assert_eq!(again.fault, Some(FloorFault::Frame(FrameFault::OutOfOrder)));
}

#[test]
fn a_wall_is_no_floor() {
    let mut model = model();
    let wall: Vec<u16> = (0..WIDTH * HEIGHT).map(|index| 800 + (index % 2) as u16).collect();
    let estimate = model.update(&image(&wall, 1_000), Stamp::from_micros(1_000));
    assert!(estimate.fault.is_some() && !estimate.is_known, "{estimate:?}");
}

fn task(depth: PathBuf) -> FloorTask {
    FloorTask { depth, intrinsics: [131.25, 131.25, 79.5, 59.5], truth: None, mounting: None, out: None }
}

fn message(depth: &Path) -> String {
    floor(&task(depth.to_owned())).expect_err("refused").to_string()
}

/// A depth picture as a portable grey map, big-endian as that format has it.
fn write_depth(path: &Path, depth_mm: &[u16]) {
    let mut bytes = format!("P5\n{WIDTH} {HEIGHT}\n65535\n").into_bytes();
    bytes.extend(depth_mm.iter().flat_map(|depth| depth.to_be_bytes()));
    std::fs::write(path, bytes).expect("written");
}

#[test]
fn bad_files_are_refused_with_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("depth.pgm");
    assert!(message(&path).contains("depth.pgm"));
    let text = folder.path().join("text");
    std::fs::write(&text, b"no picture").expect("written");
    assert!(message(&text).contains("no picture in a known format"));
    write_depth(&path, &vec![0; WIDTH * HEIGHT]);
    assert!(message(&path).contains("floor unknown: only 0 of 19200 pixels have a depth"));
    write_depth(&path, &level_floor(0)[..WIDTH * 7]);
    assert!(!message(&path).is_empty());
    std::fs::write(&path, format!("P5\n{WIDTH} 1\n255\n{}", "a".repeat(WIDTH))).expect("written");
    assert!(message(&path).contains("one channel of 16 bits"));
    write_depth(&path, &level_floor(0));
    let mut broken = task(path);
    for intrinsics in [[f32::NAN, 1.0, 0.0, 0.0], [0.0, 525.0, 319.5, 239.5]] {
        broken.intrinsics = intrinsics;
        assert!(floor(&broken).expect_err("refused").to_string().contains("no such camera"));
    }
    broken.intrinsics = task(PathBuf::new()).intrinsics;
    broken.truth = Some(folder.path().join("absent.png"));
    assert!(floor(&broken).expect_err("refused").to_string().contains("absent.png"));
    let small = folder.path().join("mask.pgm");
    std::fs::write(&small, "P5\n2 1\n255\nab").expect("written");
    broken.truth = Some(small);
    assert!(floor(&broken).expect_err("refused").to_string().contains("2 × 1 pixels"));
}

/// A small picture with the intrinsics of a large one is a mistake of the caller and no missing floor; a crop is neither.
#[test]
fn a_picture_of_another_camera_is_bad_input() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("depth.pgm");
    write_depth(&path, &level_floor(0));
    let mut task = task(path);
    for (centre, size) in
        [([319.5, 59.5], "640 × 120"), ([79.5, 239.5], "160 × 480"), ([-9.0, 59.5], "0 × 120")]
    {
        task.intrinsics = [131.25, 131.25, centre[0], centre[1]];
        let problem = floor(&task).expect_err("refused");
        let text = problem.to_string();
        assert!(problem.is::<BadInput>() && text.contains("160 × 120") && text.contains(size), "{text}");
    }
    task.intrinsics = [131.25, 131.25, 79.5, 59.5];
    assert!(floor(&task).is_ok());
    task.intrinsics = [131.25, 131.25, 100.0, 40.0];
    assert!(!floor(&task).is_err_and(|problem| problem.is::<BadInput>()));
}

/// A picture wider than the core's capacity is processed in part: the same plane, places and sizes.
#[test]
fn wide_pictures_are_reduced() {
    let folder = tempfile::tempdir().expect("a folder");
    let wanted = Plane::of_mounting(CAMERA_HEIGHT_M, PITCH_RAD).expect("a plane");
    for (width, height, by) in [(641, 479, 2), (1_280, 720, 2), (1_921, 1_081, 4), (640, 480, 1)] {
        let (fx, cx, cy) = (0.82 * width as f32, 0.5 * width as f32 - 0.5, 0.5 * height as f32 - 0.5);
        let camera = PinholeCamera::new([fx; 2], [cx, cy]).expect("a camera");
        let pixel = |index: usize| {
            let ray = camera.ray((index % width) as f32, (index / width) as f32);
            let down = |normal: [f32; 3]| -> f32 { normal.iter().zip(ray).map(|(n, r)| -n * r).sum() };
            let away = down(wanted.normal);
            let (top, [right, along]) = ((CAMERA_HEIGHT_M - 0.06) / away, wanted.axes());
            let place = |axis: [f32; 3]| -top * down(axis);
            let is_block = place(right).abs() < 0.05 && (0.8..0.9).contains(&place(along));
            let depth_m = if is_block { top } else { CAMERA_HEIGHT_M / away };
            if away > 0.05 { (1_000.0 * depth_m) as u16 + (index * 7 % 3) as u16 } else { 0 }
        };
        let depth: Vec<u16> = (0..width * height).map(pixel).collect();
        let path = folder.path().join(format!("{width}.png"));
        image::ImageBuffer::<image::Luma<u16>, _>::from_raw(width as u32, height as u32, depth)
            .expect("as many pixels")
            .save(&path)
            .expect("written");
        let mounting = Some([CAMERA_HEIGHT_M, PITCH_RAD]);
        let out = Some(folder.path().join("pictures"));
        let intrinsics = [fx, fx, cx, cy];
        let report =
            floor(&FloorTask { depth: path, intrinsics, truth: None, mounting, out }).expect("a floor");
        assert_eq!(report.reduced_by, by);
        let cosine: f32 = report.normal.iter().zip(wanted.normal).map(|(a, b)| a * b).sum();
        assert!(cosine.min(1.0).acos().to_degrees() < 0.3, "{width}: {report:?}");
        assert!((report.distance_m - CAMERA_HEIGHT_M).abs() < 0.01, "{width}: {}", report.distance_m);
        let [object] = &report.objects[..] else { panic!("{width}: {:?}", report.objects) };
        assert!((object.height_m - 0.06).abs() < 0.02 && object.position_m[0].abs() < 0.02, "{object:?}");
        let [left, _, columns, _] = object.rectangle_px.map(f32::from);
        assert!((left + 0.5 * columns - cx).abs() < 0.02 * width as f32, "{width}: {object:?}");
    }
}
