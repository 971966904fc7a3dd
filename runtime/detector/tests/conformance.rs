//! The same models and pictures as ONNX Runtime and OpenCV: `tests/models/make.py` made the models and wrote what those two say.

use std::path::{Path, PathBuf};
use std::process::Command;

use floorguard_detector::{
    Detector, DetectorConfig, DetectorThread, Layout, Letterbox, Model, ModelError, OnnxModel, RgbPicture,
};
use floorguard_types::time::Stamp;
use serde_json::Value;

const FRAME: [u32; 2] = [64, 64];

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models")
}

fn key(folder: &Path, name: &str) -> Value {
    let text = std::fs::read_to_string(folder.join(format!("{name}.json"))).expect("a key beside the model");
    serde_json::from_str(&text).expect("a key is JSON")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|each| each.as_f64().expect("a number")).collect()
}

/// The picture of the script.
fn picture() -> RgbPicture {
    let value = |x: u32, y: u32, c: u32| ((7 * x + 13 * y + 29 * c + x * y / 5) % 256) as u8;
    let pixels = (0..60).flat_map(|y| (0..100).flat_map(move |x| (0..3).map(move |c| value(x, y, c))));
    RgbPicture::new([100, 60], pixels.collect()).expect("three octets a pixel")
}

fn outputs_agree(folder: &Path, name: &str) {
    let mut model = OnnxModel::load(&folder.join(format!("{name}.onnx"))).expect("a model");
    assert_eq!(model.frame(), FRAME);
    let ramp: Vec<f32> = (0..3 * 64 * 64).map(|index| (index * 37 % 256) as f32 / 255.0).collect();
    let found = model.run(ramp).expect("it runs").values;
    let expected = numbers(&key(folder, name)["ramp"]);
    assert_eq!(found.len(), expected.len());
    let worst = found.iter().zip(&expected).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
    let largest = expected.iter().map(|value| value.abs()).fold(0.0, f64::max);
    assert!(worst <= 2.0e-6 * largest.max(1.0) + 2.0e-6, "{name}: off by {worst}, largest {largest}");
}

fn boxes_agree(folder: &Path, name: &str) {
    let model = OnnxModel::load(&folder.join(format!("{name}.onnx"))).expect("a model");
    let mut detector = Detector::new(Box::new(model), DetectorConfig::default()).expect("a detector");
    assert_eq!(detector.layout(), if name == "yolox" { Layout::Yolox } else { Layout::YoloV8 });
    let key = key(folder, name);
    let frame = Letterbox::new([100, 60], FRAME, detector.layout().placing());
    // OpenCV's planes are blue, green and red for the one and as they are for the other: both wrote them as given.
    let planes = frame.fill(&picture(), [0, 1, 2], 1.0);
    let sampled = numbers(&key["frame"]);
    let off = planes.iter().step_by(7).zip(&sampled).map(|(a, b)| (f64::from(*a) - b).abs());
    assert!(off.fold(0.0, f64::max) <= 1.0, "{name}: the frame differs by more than a rounding");
    let expected: Vec<Vec<f64>> = key["boxes"].as_array().expect("a list").iter().map(numbers).collect();
    let found = detector.detect(&picture()).expect("it runs");
    assert_eq!(found.len(), expected.len(), "{name}");
    for row in &expected {
        let is_same = found.iter().any(|each| {
            let edges =
                [each.upper_left.column, each.upper_left.row, each.lower_right.column, each.lower_right.row];
            let values = std::iter::once(each.confidence).chain(edges);
            let limits = std::iter::once(0.01).chain(std::iter::repeat(1.0));
            values.zip(row).zip(limits).all(|((a, b), limit)| (f64::from(a) - b).abs() <= limit)
        });
        assert!(is_same, "{name}: {row:?} is not among {found:?}");
    }
}

#[test]
fn stored_answers_of_onnxruntime_hold() {
    for name in ["yolox", "yolov8"] {
        outputs_agree(&models(), name);
        boxes_agree(&models(), name);
    }
}

#[test]
fn onnxruntime_agrees_on_fresh_models() {
    let python = std::env::var("FLOORGUARD_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has_all = Command::new(&python).args(["-c", "import onnxruntime, onnx, cv2, numpy"]).output();
    if !has_all.is_ok_and(|output| output.status.success()) {
        println!(
            "skipped: {python} has no onnxruntime, onnx, cv2 and numpy (FLOORGUARD_PYTHON names another one)"
        );
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    for seed in ["3", "5"] {
        let script = models().join("make.py");
        let made =
            Command::new(&python).arg(script).arg(folder.path()).arg(seed).output().expect("it starts");
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        for name in ["yolox", "yolov8"] {
            outputs_agree(folder.path(), name);
            boxes_agree(folder.path(), name);
        }
    }
}

#[test]
fn thread_answers_as_the_detector_does() {
    let detector = || {
        let model = OnnxModel::load(&models().join("yolov8.onnx")).expect("a model");
        Detector::new(Box::new(model), DetectorConfig::default()).expect("a detector")
    };
    let thread = DetectorThread::start(detector()).expect("a thread");
    thread.offer(Stamp::from_micros(7), picture());
    let (found, counts) = thread.finish();
    assert_eq!((counts.processed, counts.late, found.len()), (1, 0, 1));
    assert_eq!(found[0].people, Ok(detector().detect(&picture()).expect("it runs")));
}

#[test]
fn files_that_are_no_detector_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("model.onnx");
    std::fs::write(&path, b"this is no model").expect("written");
    assert!(matches!(OnnxModel::load(&path), Err(ModelError::NoModel(_))));
    let whole = std::fs::read(models().join("yolox.onnx")).expect("a model");
    std::fs::write(&path, &whole[..whole.len() / 2]).expect("written");
    assert!(matches!(OnnxModel::load(&path), Err(ModelError::NoModel(_))));
    assert!(matches!(OnnxModel::load(Path::new("/nowhere.onnx")), Err(ModelError::NoModel(_))));
}
