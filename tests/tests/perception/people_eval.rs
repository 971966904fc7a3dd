//! `floorguard eval`: the figures of the commands, and how they refuse.

use std::path::Path;

use clap::Parser as _;
use floorguard_app::commands::{Arguments, dispatch, exit_code};
use floorguard_laboratory::evaluate;
use floorguard_tests::data::recording;

#[test]
fn both_published_models_pass() {
    for (name, features) in [("flobot", 71), ("online_learning", 61)] {
        let file = |end: &str| recording(&format!("models/{name}_{end}"));
        let (Some(model), Some(range), Some(rows)) =
            (file("pedestrian.model"), file("pedestrian.range"), file("svm_key.csv.gz"))
        else {
            return;
        };
        let report = evaluate::svm(&model, &range, &rows).expect("readable");
        assert!(report.passed() && report.rows >= 100 && report.features == features, "{report:?}");
        assert!(report.max_probability_error.is_some_and(|error| error < 1.0e-6), "{report:?}");
    }
}

#[test]
fn a_changed_row_fails_the_verdict() {
    let (Some(model), Some(range), Some(rows)) = (
        recording("models/flobot_pedestrian.model"),
        recording("models/flobot_pedestrian.range"),
        recording("models/flobot_svm_key.csv.gz"),
    ) else {
        return;
    };
    let text = floorguard_robot::picture_files::read_text(&rows).expect("readable");
    let mut lines = text.lines();
    let (names, first) = (lines.next().expect("names"), lines.next().expect("a row"));
    let flipped = if first.starts_with("-1,") { first.replacen("-1,", "1,", 1) } else { format!("-{first}") };
    let folder = tempfile::tempdir().expect("a folder");
    let changed = folder.path().join("changed.csv");
    std::fs::write(&changed, format!("{names}\n{flipped}\n")).expect("written");
    let report = evaluate::svm(&model, &range, &changed).expect("readable");
    assert_eq!((report.rows, report.label_mismatches, report.passed()), (1, 1, false));
}

#[test]
fn figures_of_the_public_sequence_equal_the_key() {
    let file = |name: &str| recording(&format!("mot_metrics/TUD-Campus/{name}.txt"));
    let (Some(truth), Some(result)) = (file("gt"), file("test")) else { return };
    let report = evaluate::tracks(&truth, &result).expect("readable");
    let summary = report.summary;
    for (found, wanted) in [(summary.mota, 0.526_462), (summary.motp, 0.277_201), (summary.idf1, 0.557_659)] {
        assert!(found.is_some_and(|found| (found - wanted).abs() < 1.0e-4), "{found:?} is not {wanted}");
    }
    let json = serde_json::to_value(report).expect("serialises");
    assert!(["mota", "motp", "idf1", "id_switches"].iter().all(|key| json.get(key).is_some()), "{json}");
    assert_eq!(report.id_switches, 7);
}

fn exit_of(line: &[&str]) -> u8 {
    match Arguments::try_parse_from(line) {
        Ok(arguments) => dispatch(arguments).err().as_ref().map_or(0, exit_code),
        Err(usage) => usage.exit_code() as u8,
    }
}

#[test]
fn usage_and_file_errors_have_own_codes() {
    assert_eq!(exit_of(&["floorguard", "eval", "tracks", "--truth", "only.txt"]), 2);
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path
    };
    let good = write("good.txt", "1,1,0,0,10,10,1\n");
    let bad = write("bad.txt", "1,1,0,0,ten,10,1\n");
    let run = |truth: &Path, result: &Path| {
        let (truth, result) = (truth.to_str().expect("text"), result.to_str().expect("text"));
        exit_of(&["floorguard", "eval", "tracks", "--truth", truth, "--result", result, "--json"])
    };
    assert_eq!(run(&good, &good), 0);
    assert_eq!(run(&good, &bad), 3);
    assert_eq!(run(&good, &folder.path().join("absent.txt")), 3);
}
