//! `floorguard eval` with files that are cut, empty, of another kind or that contradict each other: exit 3, with the file, what was
//! found, what was expected and what to do. Made here from the recordings, and never a figure that means nothing.

use std::path::{Path, PathBuf};

use clap::Parser as _;
use floorguard_app::commands::{Arguments, dispatch, exit_code};
use floorguard_robot::picture_files::read_text;
use floorguard_tests::data;

/// Exit code and message.
fn eval(line: &[&str]) -> (u8, String) {
    let words = ["floorguard", "eval"].iter().chain(line).chain(&["--json"]);
    let arguments = Arguments::try_parse_from(words).expect("right usage");
    match dispatch(arguments) {
        Ok(()) => (0, String::new()),
        Err(error) => (exit_code(&error), format!("{error:#}")),
    }
}

/// What is done to the cells of a row.
type Change<'a> = &'a dyn Fn(&mut Vec<String>);

struct TestFolder(tempfile::TempDir);

impl TestFolder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn put(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).expect("it is written");
        path
    }
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a name")
}

/// Each is refused with exit 3 and says so.
fn refused(what: &str, line: &[&str], reported: &str) {
    let (code, message) = eval(line);
    assert_eq!(code, 3, "{what}: {message}");
    assert!(message.contains(reported), "{what}: {message}");
}

/// A row whose cells were changed.
fn cells(row: &str, change: impl Fn(&mut Vec<String>)) -> String {
    let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
    change(&mut cells);
    cells.join(",")
}

#[test]
fn legs() {
    let Some(path) = data::recording("laser2d_people/leigh_leg_training.csv.gz") else { return };
    let all = read_text(&path).expect("it is text");
    let (header, rest) = all.split_once('\n').expect("a first line");
    let rows: Vec<&str> = rest.lines().step_by(40).collect();
    let folder = TestFolder::new();
    let file = |header: &str, change: Change<'_>| {
        let rows: Vec<String> = rows.iter().map(|row| cells(row, change)).collect();
        folder.put("legs.csv", format!("{header}\n{}\n", rows.join("\n")))
    };
    let good = file(header, &|_| {});
    assert_eq!(eval(&["legs", "--scans", text(&good)]).0, 0);
    // Too few legs to learn from: the table of this build is tested, and finds them.
    let report = floorguard_laboratory::evaluate::legs(&good, false).expect("it is right");
    assert!(report.method == "table" && report.f1 > 0.4, "{} {}", report.method, report.f1);
    let with_mark = folder
        .put("mark.csv", [b"\xef\xbb\xbf", std::fs::read(&good).expect("it is there").as_slice()].concat());
    assert_eq!(eval(&["legs", "--scans", text(&with_mark)]).0, 0);
    // Another scanner that says what it is: every second beam.
    let coarse = header.replace("0.006135923", "0.012271846").replace("n=768", "n=384");
    let coarse = file(&coarse, &|cells| {
        let mut index = 0;
        cells.retain(|_| {
            index += 1;
            index <= 4 || index % 2 == 1
        });
    });
    assert_eq!(eval(&["legs", "--scans", text(&coarse)]).0, 0);
    let cut: Change<'_> = &|cells| cells.truncate(304);
    let keep: Change<'_> = &|_| {};
    for (what, header, change, reported) in [
        ("cut", header.to_owned(), cut, "300 ranges, and the scanner of this file has 768 beams"),
        ("cut, and reported", header.replace("n=768", "n=300"), cut, "do not belong together"),
        ("without ranges", header.to_owned(), &|cells| cells.truncate(4), "no ranges"),
        ("degrees", header.replace("0.006135923", "0.3516"), keep, "radians"),
        (
            "the wrong way round",
            header.replace("0.006135923", "-0.006135923"),
            keep,
            "do not belong together",
        ),
        ("nothing measured", header.to_owned(), &|cells| cells[4..].fill("0".to_owned()), "no return at all"),
        ("no first line", rows[0].to_owned(), keep, "angle_increment"),
        (
            "no legs",
            header.to_owned(),
            &|cells| (cells[2], cells[3]) = ("0".to_owned(), String::new()),
            "no labelled leg",
        ),
    ] {
        refused(what, &["legs", "--scans", text(&file(&header, change))], reported);
    }
    let packed = std::fs::read(&path).expect("it is there");
    let half = folder.put("half.csv.gz", &packed[..packed.len() / 2]);
    refused("half", &["legs", "--scans", text(&half)], "copy it again");
    refused(
        "a picture",
        &["legs", "--scans", text(&folder.put("p.csv", b"\x89PNG\r\n\x1a\n\xff\xfe"))],
        "no text",
    );
    refused("empty", &["legs", "--scans", text(&folder.put("e.csv", b""))], "empty");
}

#[test]
fn svm() {
    let names = ["flobot_pedestrian.model", "flobot_pedestrian.range", "flobot_svm_key.csv.gz"];
    let [Some(model), Some(range), Some(rows)] = names.map(|name| data::recording(&format!("models/{name}")))
    else {
        return;
    };
    let all = read_text(&rows).expect("it is text");
    let lines: Vec<&str> = all.lines().take(4).collect();
    let folder = TestFolder::new();
    let rows = |change: Change<'_>| {
        let changed: Vec<String> = lines[1..].iter().map(|row| cells(row, change)).collect();
        folder.put("rows.csv", format!("{}\n{}\n", lines[0], changed.join("\n")))
    };
    let run = |model: &Path, range: &Path, rows: &Path| {
        eval(&["svm", "--model", text(model), "--range", text(range), "--rows", text(rows)])
    };
    assert_eq!(run(&model, &range, &rows(&|_| {})).0, 0);
    let changes: [(&str, Change<'_>, &str); 5] = [
        ("an invalid decision", &|cells| cells[1] = "nan".to_owned(), "`nan` is no number"),
        ("an invalid feature", &|cells| cells[9] = "inf".to_owned(), "`inf` is no number"),
        ("an empty cell", &|cells| cells[9].clear(), "cut off?"),
        ("cut", &|cells| cells.truncate(50), "47 features"),
        ("foreign labels", &|cells| cells[0] = "3".to_owned(), "label 3 is none of the model's (1 and -1)"),
    ];
    for (what, change, reported) in changes {
        let (code, message) = run(&model, &range, &rows(change));
        assert!(code == 3 && message.contains(reported), "{what}: {code} {message}");
    }
    let good = rows(&|_| {});
    let whole = std::fs::read_to_string(&model).expect("it is text");
    for (from, to, reported) in [
        ("gamma 0.5", "gamma nan", "not finite"),
        ("gamma 0.5", "gamma -1", "more than 0"),
        ("total_sv 554", "total_sv 555", "copy it again"),
    ] {
        assert!(whole.contains(from));
        let (code, message) = run(&folder.put("m", whole.replacen(from, to, 1)), &range, &good);
        assert!(code == 3 && message.contains(reported), "{to}: {code} {message}");
    }
    let short: Vec<String> = read_text(&range).expect("text").lines().take(40).map(str::to_owned).collect();
    let (code, message) = run(&model, &folder.put("r", short.join("\n")), &good);
    assert!(code == 3 && message.contains("range file of this model"), "{code} {message}");
    // A model without probabilities has no error of them.
    let bare: String =
        whole.lines().filter(|line| !line.starts_with("prob")).map(|line| format!("{line}\n")).collect();
    let report =
        floorguard_laboratory::evaluate::svm(&folder.put("b", bare), &range, &good).expect("it is read");
    assert_eq!((report.max_probability_error, report.passed()), (None, true));
}

#[test]
fn tracks() {
    let folder = TestFolder::new();
    let good = "1,1,0,0,10,10,1\n2,1,1,0,10,10,1\n";
    let truth = folder.put("truth.txt", good);
    let run = |result: &Path| eval(&["tracks", "--truth", text(&truth), "--result", text(result)]);
    assert_eq!(run(&truth).0, 0);
    assert_eq!(run(&folder.put("blanks.txt", good.replace(',', " "))).0, 0, "py-motmetrics reads these, too");
    assert_eq!(run(&folder.put("flat.txt", good.replace("10,10", "0,10"))).0, 0, "found in the wrong place");
    for (what, bytes, reported) in [
        ("not a number", good.replace("10,10,1", "nan,10,1"), "`nan` is no number"),
        ("infinite", good.replace("10,10,1", "inf,10,1"), "`inf` is no number"),
        ("negative", good.replace("10,10,1", "-4,10,1"), "a rectangle of -4 × 10"),
        ("twice", good.repeat(2), "line 3: frame 1 has id 1 for the second time, first in line 1"),
        ("with names", format!("frame,id,x,y,w,h\n{good}"), "without a line of names"),
        ("semicolons", good.replace(',', ";"), "separate the cells by commas"),
        ("cut", good[..good.len() - 8].to_owned(), "cut off?"),
        ("a huge frame", good.replacen('1', "99999999999999999999", 1), "whole numbers"),
        ("other frames", good.replace("\n2,", "\n9,").replacen('1', "8", 1), "not one in common"),
        ("empty", String::new(), "no rows"),
    ] {
        let (code, message) = run(&folder.put("result.txt", bytes));
        assert!(code == 3 && message.contains(reported), "{what}: {code} {message}");
    }
    let other = folder.put("nobody.txt", good.replace("10,1\n", "10,0\n"));
    refused(
        "all marked",
        &["tracks", "--truth", text(&other), "--result", text(&truth)],
        "no rows that count",
    );
}

#[test]
fn clusters_and_motion() {
    let Some(capture) = data::recording("vlp16_packets/mrpt_gps_600rpm.pcap") else { return };
    let folder = TestFolder::new();
    let key = |rows: &str| folder.put("key.csv", format!("frame,time_s,track,x,y\n{rows}"));
    let good = "0,0.0,1,2.0,1.0\n1,0.1,1,2.1,1.0\n";
    for command in ["clusters", "motion"] {
        let run = |capture: &Path, key: &Path| eval(&[command, text(capture), "--key", text(key)]);
        assert_eq!(run(&capture, &key(good)).0, 0);
        // A key that is longer than the capture counts as far as there is a capture.
        assert_eq!(run(&capture, &key(&format!("{good}900,90.0,1,2.0,1.0\n"))).0, 0);
        for (what, rows, reported) in [
            ("no rows", "", "no rows"),
            ("another capture", "900,90.0,1,2.0,1.0\n", "nothing to compare"),
            ("millimetres", "0,0.0,1,2000,1000\n", "metres"),
            ("not a number", "0,0.0,1,nan,1.0\n", "`nan` is no number"),
            ("before the start", "-1,0.0,1,2.0,1.0\n", "-1"),
            ("cut", "0,0.0,1,2.0,1.0\n1,0.1\n", "cut off?"),
            ("semicolons", "0;0.0;1;2.0;1.0\n", "separate the cells by commas"),
        ] {
            let (code, message) = run(&capture, &key(rows));
            assert!(code == 3 && message.contains(reported), "{command}, {what}: {code} {message}");
        }
        let good = key(good);
        let bytes = std::fs::read(&capture).expect("it is there");
        let other = data::recording("vlp16_packets/NEG_hdl32e_monterey_200pkts.pcap");
        let position = data::recording("vlp16_packets/gadomski_position_packet.pcap");
        let single = data::recording("vlp16_packets/gadomski_single_packet.pcap");
        for (what, capture, reported) in [
            ("cut", Some(folder.put("cut.pcap", &bytes[..bytes.len() - 100])), "copy it again"),
            ("header only", Some(folder.put("head.pcap", &bytes[..24])), "no datagram to port 2368"),
            ("a picture", Some(folder.put("p.pcap", b"\x89PNG\r\n\x1a\n")), "is no .pcap"),
            ("empty", Some(folder.put("e.pcap", b"")), "is empty"),
            ("another lidar", other, "this is a HDL-32E"),
            ("positions", position, "no datagram to port 2368"),
            ("one packet", single, "revolution"),
        ] {
            let Some(capture) = capture else { continue };
            let (code, message) = run(&capture, &good);
            assert!(code == 3 && message.contains(reported), "{command}, {what}: {code} {message}");
        }
    }
}
