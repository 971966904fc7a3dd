//! Published classifiers, read from their files, against what libsvm itself computed.

use std::io::Read as _;

use flate2::read::GzDecoder;
use floorguard_laboratory::models::{LibsvmModel, RangeFile};
use floorguard_tests::data::recording;

/// Label, decision value, probability of label 1, scaled features.
fn rows(path: &str) -> Option<Vec<Vec<f64>>> {
    let mut text = String::new();
    let file = std::fs::File::open(recording(path)?).expect("the key opens");
    GzDecoder::new(file).read_to_string(&mut text).expect("the key is text");
    let number = |cell: &str| cell.parse().expect("a number");
    Some(text.lines().skip(1).map(|line| line.split(',').map(number).collect()).collect())
}

fn compare<const DIMENSIONS: usize>(name: &str) {
    let Some(model) = recording(&format!("models/{name}_pedestrian.model")) else { return };
    let Some(rows) = rows(&format!("models/{name}_svm_key.csv.gz")) else { return };
    let file = LibsvmModel::<DIMENSIONS>::open(&model).expect("a model");
    let (mut decision_error, mut probability_error) = (0.0_f64, 0.0_f64);
    for (index, row) in rows.iter().enumerate() {
        let scaled: [f64; DIMENSIONS] = row[3..].try_into().expect("one value a feature");
        let verdict = file.model().judge(&scaled);
        assert_eq!(f64::from(verdict.label), row[0], "{name}, row {index}");
        decision_error = decision_error.max((verdict.decision - row[1]).abs() / row[1].abs());
        let probability = verdict.probability.expect("calibrated");
        probability_error = probability_error.max((probability - row[2]).abs());
    }
    println!(
        "{name}: {} rows, decision {decision_error:.1e}, probability {probability_error:.1e}",
        rows.len()
    );
    assert!(rows.len() >= 100, "{name}: only {} rows", rows.len());
    assert!(decision_error < 1.0e-5, "{name}: decision off by {decision_error}");
    assert!(probability_error < 1.0e-5, "{name}: probability off by {probability_error}");
}

#[test]
fn published_models_decide_as_libsvm() {
    compare::<71>("flobot");
    compare::<61>("online_learning");
}

#[test]
fn published_ranges_cover_every_feature() {
    for (name, dimensions) in [("flobot", 71), ("online_learning", 61)] {
        let Some(path) = recording(&format!("models/{name}_pedestrian.range")) else { return };
        let file = RangeFile::open(&path).expect("a range file");
        assert_eq!(file.scaling().ranges.len(), dimensions, "{name}");
    }
}
