//! CLEAR-MOT and IDF1 against the key that an independent package made of a public sequence.

use std::collections::BTreeMap;

use floorguard_laboratory::metrics::MotAccumulator;
use floorguard_tests::data::recording;

/// left, top, width, height, pixels.
type Rectangle = [f64; 4];

/// Frame → objects of a file in the MOT15 format.
fn frames(path: &str) -> Option<BTreeMap<u64, Vec<(u64, Rectangle)>>> {
    let text = std::fs::read_to_string(recording(path)?).expect("the sequence is text");
    let mut frames: BTreeMap<u64, Vec<(u64, Rectangle)>> = BTreeMap::new();
    for line in text.lines().filter(|line| !line.is_empty()) {
        let fields: Vec<f64> = line.split(',').map(|field| field.trim().parse().expect("numbers")).collect();
        let rectangle = [fields[2], fields[3], fields[4], fields[5]];
        frames.entry(fields[0] as u64).or_default().push((fields[1] as u64, rectangle));
    }
    Some(frames)
}

/// 1 − intersection over union; none above 0.5.
fn distance(a: &Rectangle, b: &Rectangle) -> Option<f64> {
    let overlap = |axis: usize| {
        let end = (a[axis] + a[axis + 2]).min(b[axis] + b[axis + 2]);
        (end - a[axis].max(b[axis])).max(0.0)
    };
    let intersection = overlap(0) * overlap(1);
    let union = a[2] * a[3] + b[2] * b[3] - intersection;
    let distance = 1.0 - intersection / union;
    (distance <= 0.5).then_some(distance)
}

#[test]
fn figures_of_a_public_sequence_equal_the_key() {
    let folder = "mot_metrics/TUD-Campus";
    let (Some(truth), Some(tracks)) =
        (frames(&format!("{folder}/gt.txt")), frames(&format!("{folder}/test.txt")))
    else {
        return;
    };
    let key = std::fs::read_to_string(
        recording(&format!("{folder}/motmetrics_iou0.5.csv")).expect("present beside the sequence"),
    )
    .expect("the key is text");
    let mut lines = key.lines();
    let (names, values) = (lines.next().expect("a header"), lines.next().expect("a row"));
    let key: BTreeMap<_, _> = names.split(',').zip(values.split(',')).collect();
    let wanted = |name: &str| -> f64 { key[name].parse().expect("a number") };

    let mut accumulator = MotAccumulator::new();
    let mut numbers: Vec<_> = truth.keys().chain(tracks.keys()).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let empty = Vec::new();
    for number in numbers {
        let (objects, found) = (truth.get(number).unwrap_or(&empty), tracks.get(number).unwrap_or(&empty));
        let ids = |list: &[(u64, Rectangle)]| -> Vec<u64> { list.iter().map(|(id, _)| *id).collect() };
        accumulator.frame_by_distance(&ids(objects), &ids(found), |object, track| {
            distance(&objects[object].1, &found[track].1)
        });
    }
    let summary = accumulator.summary();
    for (value, name) in [
        (summary.unique_objects, "num_unique_objects"),
        (summary.mostly_tracked, "mostly_tracked"),
        (summary.mostly_lost, "mostly_lost"),
        (summary.false_positives, "num_false_positives"),
        (summary.misses, "num_misses"),
        (summary.switches, "num_switches"),
        (summary.fragmentations, "num_fragmentations"),
    ] {
        assert_eq!(value as f64, wanted(name), "{name}");
    }
    for (value, name) in [
        (summary.mota, "mota"),
        (summary.motp, "motp"),
        (summary.idf1, "idf1"),
        (summary.identity_precision, "idp"),
        (summary.identity_recall, "idr"),
    ] {
        let value = value.expect("there is something to measure");
        assert!((value - wanted(name)).abs() < 1e-4, "{name}: {value} against {}", wanted(name));
    }
}
