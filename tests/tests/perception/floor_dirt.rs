//! Dirt in pictures: both detectors on floors with known dirt, folders in both layouts, and broken folders.

use std::path::{Path, PathBuf};

use floorguard_host::outcome::BadInput;
use floorguard_laboratory::evaluate::dirt;
use image::{GrayImage, Luma, Rgb, RgbImage};

const WIDTH: u32 = 320;
const HEIGHT: u32 = 240;

/// A grey floor with a little noise and a red spot, and where the spot is.
fn frame(salt: u32) -> (RgbImage, GrayImage) {
    let is_dirt = |x: u32, y: u32| x.abs_diff(100 + salt) < 14 && y.abs_diff(90) < 9;
    let picture = RgbImage::from_fn(WIDTH, HEIGHT, |x, y| {
        let noise = (x.wrapping_mul(2_654_435_761).wrapping_add(y.wrapping_mul(40_503) ^ salt) >> 7) % 7;
        let grey = 120 + noise as u8;
        if is_dirt(x, y) { Rgb([grey + 40, grey - 40, grey - 50]) } else { Rgb([grey; 3]) }
    });
    let mask = GrayImage::from_fn(WIDTH, HEIGHT, |x, y| Luma([if is_dirt(x, y) { 255 } else { 0 }]));
    (picture, mask)
}

/// Two frames with masks side by side.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for number in [1, 2] {
        let (picture, mask) = frame(number * 20);
        picture.save(folder.path().join(format!("hall_{number:03}.png"))).expect("room");
        mask.save(folder.path().join(format!("hall_{number:03}_mask.png"))).expect("room");
    }
    folder
}

/// The folder is refused as bad input, and the message names the file.
fn assert_refused(folder: &Path, name: &str) {
    let problem = dirt(folder, None).expect_err("must be refused");
    assert!(problem.is::<BadInput>(), "{problem:#}");
    assert!(format!("{problem:#}").contains(name), "{problem:#} does not name {name}");
}

#[test]
fn both_detectors_see_a_red_spot_on_grey() {
    let folder = folder();
    let report = dirt(folder.path(), None).expect("judged");
    assert_eq!((report.frames, report.frames_unknown, report.other_pictures), (2, 0, 0));
    assert!(report.ours.best_iou > 0.8 && report.ours.auc > 0.99, "{report:?}");
    assert!(report.published.auc > 0.95, "{report:?}");
    let json = serde_json::to_value(&report).expect("numbers");
    for key in ["best_iou", "auc", "precision", "recall"] {
        for method in [&json, &json["published"], &json["ours"]] {
            assert!(method[key].is_f64(), "{key} in {json}");
        }
    }
}

#[test]
fn folders_for_each_kind_are_the_same_frames() {
    let (flat, nested) = (folder(), tempfile::tempdir().expect("a folder"));
    for (kind, ending) in [("frames", ""), ("masks", "_mask")] {
        std::fs::create_dir(nested.path().join(kind)).expect("room");
        for number in [1, 2] {
            let from = flat.path().join(format!("hall_{number:03}{ending}.png"));
            std::fs::copy(from, nested.path().join(kind).join(format!("hall_{number:03}.png")))
                .expect("room");
        }
    }
    assert_eq!(dirt(flat.path(), None).expect("judged"), dirt(nested.path(), None).expect("judged"));
}

#[test]
fn a_large_frame_is_reduced() {
    let folder = tempfile::tempdir().expect("a folder");
    let (picture, mask) = frame(3);
    let larger = image::imageops::FilterType::Nearest;
    image::imageops::resize(&picture, 1_280, 960, larger).save(folder.path().join("a1.png")).expect("room");
    image::imageops::resize(&mask, 1_280, 960, larger).save(folder.path().join("a1_mask.png")).expect("room");
    let report = dirt(folder.path(), None).expect("judged");
    assert_eq!(report.reduced_by, 2);
    assert!(report.ours.auc > 0.99, "{report:?}");
}

#[test]
fn laser_marking_and_non_floor_are_excluded() {
    let folder = tempfile::tempdir().expect("a folder");
    let (picture, mask) = frame(3);
    picture.save(folder.path().join("a1.png")).expect("room");
    mask.save(folder.path().join("a1_mask.png")).expect("room");
    let inverted = GrayImage::from_fn(WIDTH, HEIGHT, |x, y| Luma([255 - mask.get_pixel(x, y)[0]]));
    inverted.save(folder.path().join("a1_floor.png")).expect("room");
    let report = dirt(folder.path(), None).expect("judged");
    let ours = report.ours;
    assert!(ours.recall.is_nan() && ours.best_iou.is_nan(), "all dirt lies outside of the floor: {ours:?}");
    let black = GrayImage::new(WIDTH, HEIGHT);
    black.save(folder.path().join("a1_floor.png")).expect("room");
    assert_refused(folder.path(), "unknown");
}

#[test]
fn broken_folders_are_refused_by_name() {
    let broken = |change: fn(&Path)| {
        let folder = folder();
        change(folder.path());
        folder
    };
    let missing = broken(|path| std::fs::remove_file(path.join("hall_002_mask.png")).expect("there"));
    assert_refused(missing.path(), "hall_002.png");
    let cut = broken(|path| {
        let file = path.join("hall_001.png");
        let bytes = std::fs::read(&file).expect("there");
        std::fs::write(&file, &bytes[..bytes.len() / 2]).expect("room");
    });
    assert_refused(cut.path(), "hall_001.png");
    let small = broken(|path| GrayImage::new(31, 17).save(path.join("hall_001_mask.png")).expect("room"));
    assert_refused(small.path(), "hall_001_mask.png");
    let cut_jpeg = broken(|path| {
        let (png, jpeg) = (path.join("hall_001.png"), path.join("hall_001.jpg"));
        image::open(&png).expect("there").save(&jpeg).expect("room");
        std::fs::remove_file(png).expect("there");
        let bytes = std::fs::read(&jpeg).expect("there");
        std::fs::write(&jpeg, &bytes[..bytes.len() / 2]).expect("room");
    });
    assert_refused(cut_jpeg.path(), "hall_001.jpg");
    let covered = broken(|path| {
        for name in ["hall_001.png", "hall_002.png"] {
            let mut dark = image::open(path.join(name)).expect("there").into_rgb8();
            dark.pixels_mut().for_each(|pixel| pixel.0 = pixel.0.map(|value| value % 9));
            dark.save(path.join(name)).expect("room");
        }
    });
    assert_refused(covered.path(), "unknown");
    let empty = tempfile::tempdir().expect("a folder");
    assert_refused(empty.path(), "no frame");
    assert_refused(&PathBuf::from("no/such/folder"), "no/such/folder");
}

/// Where no mask shows dirt nobody can tell what was found: no figure says 0.
#[test]
fn without_dirt_there_is_no_recall() {
    let folder = folder();
    for name in ["hall_001_mask.png", "hall_002_mask.png"] {
        GrayImage::new(WIDTH, HEIGHT).save(folder.path().join(name)).expect("room");
    }
    let report = dirt(folder.path(), None).expect("judged");
    let json = serde_json::to_value(&report).expect("numbers");
    for key in ["best_iou", "auc", "block_auc", "recall"] {
        assert!(json[key].is_null() && json["published"][key].is_null(), "{key} in {json}");
    }
    assert_eq!(json["precision"], 0.0, "it calls the spot dirty");
}

#[test]
fn a_picture_of_no_series_is_no_frame() {
    let folder = folder();
    RgbImage::new(64, 64).save(folder.path().join("montage.png")).expect("room");
    let report = dirt(folder.path(), None).expect("judged");
    assert_eq!((report.frames, report.other_pictures), (2, 1));
}

/// Tiled floors with spots: ours is better in every figure that does not depend on a threshold.
#[test]
fn ours_is_better_on_the_benchmark_floors() {
    let Some(folder) = floorguard_tests::data::bench_input("dirt") else { return };
    let report = dirt(&folder, None).expect("judged");
    let (ours, published) = (report.ours, report.published);
    assert!(ours.best_iou > 0.80 && ours.auc > 0.999 && ours.block_auc > 0.999, "{ours:?}");
    assert!(ours.best_iou > published.best_iou && ours.auc > published.auc, "{published:?}");
    assert!(ours.block_auc > published.block_auc, "{published:?}");
}

/// Cracks in pavement: not dirt, but real texture with a rare object in it.
#[test]
fn ours_is_better_on_real_surfaces() {
    let Some(folder) = floorguard_tests::data::recording("surface_images") else { return };
    let report = dirt(&folder, None).expect("judged");
    let (ours, published) = (report.ours, report.published);
    assert_eq!((report.frames, report.other_pictures), (13, 2));
    assert!(ours.auc > 0.88 && ours.auc > published.auc, "{ours:?} {published:?}");
    assert!(ours.best_iou > published.best_iou && ours.block_auc > published.block_auc, "{ours:?}");
}
