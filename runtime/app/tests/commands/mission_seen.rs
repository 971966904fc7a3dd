//! A cleaning mission in recording, report and panel: its progress is visible whatever the source.

use floorguard_laboratory::world::record_plan;
use std::fs::File;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::process::Command;

use crate::seen_support::{Page, browser, progress};
use floorguard_laboratory::world::{Observer, Plan, run_recorded};
use floorguard_operator::panel::{Access, Panel, PanelView, Records, Tokens};
use floorguard_operator::telemetry::RunSinks;
use floorguard_recording::{Recording, decode, topics};

#[test]
fn mission_is_in_recording_and_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mission.mcap");
    let plan = Plan::named("empty", 1, 3_000_000).expect("a plan");
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    let mut sinks = RunSinks::default();
    record_plan(&mut sinks, &plan, &path).expect("a recording");
    [0.0, 0.25, 0.5].into_iter().for_each(|share| sinks.mission(&progress(share)));
    run_recorded(&plan, &mut observer, &mut sinks).expect("a run");
    let messages: Vec<_> =
        Recording::new(File::open(&path).expect("the file")).collect::<Result<_, _>>().expect("whole");
    let grids = |topic: &str| -> Vec<decode::Grid> {
        let wanted = messages.iter().filter(|message| &*message.topic == topic);
        wanted.map(|message| decode::grid(&message.data).expect("a grid")).collect()
    };
    let (claimed, dirt, map) = (grids(topics::CLAIMED), grids(topics::DIRT), grids(topics::MAP));
    let count = |grid: &decode::Grid, wanted: i8| grid.cells.iter().filter(|cell| **cell == wanted).count();
    // At the beginning, and what was newest at the end.
    assert_eq!((claimed.len(), dirt.len()), (2, 3));
    assert_eq!((count(&claimed[0], 100), count(&claimed[1], 100)), (0, 585));
    assert_eq!((count(&dirt[0], 100), count(&dirt[2], 5)), (1_170, 585));
    assert_eq!(
        (claimed[1].header.frame.as_str(), claimed[1].width, claimed[1].resolution_m),
        ("map", 40, 0.1)
    );
    let known = |grid: &decode::Grid| grid.cells.iter().filter(|cell| **cell >= 0).count();
    assert!(map.len() >= 2 && known(map.last().expect("a map")) > 5_000, "{}", map.len());
    assert_eq!(map[0].header.frame, "odom");
    let report = Command::new(env!("CARGO_BIN_EXE_floorguard")).arg("report").arg(&path).output();
    let report = report.expect("the program starts");
    assert!(report.status.success(), "{report:?}");
    let page = std::fs::read_to_string(path.with_extension("html")).expect("the page");
    for words in [
        "Cleaning mission",
        "<b>50.0 %</b>of the dirty floor",
        "Green: cleaned in this run",
        "before",
        "after",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(page.contains("#7fb77e"), "no green: nothing is shown as clean");
    proof_counts_cells(&path);
}

/// The report for other programs: 585 cells of a square decimetre were cleaned, as many are to do, and each has its row.
fn proof_counts_cells(path: &std::path::Path) {
    let (json, csv) = (path.with_extension("json"), path.with_extension("csv"));
    let mut report = Command::new(env!("CARGO_BIN_EXE_floorguard"));
    report
        .arg("report")
        .arg(path)
        .args(["--operator", "A. Smith", "--robot", "number 7", "--json"])
        .arg(&json)
        .arg("--cells")
        .arg(&csv);
    let output = report.output().expect("the program starts");
    assert!(output.status.success(), "{output:?}");
    let text = std::fs::read_to_string(&json).expect("JSON");
    let proof: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let area = |name: &str| proof["cleaning"][name].as_f64().expect("a number");
    assert!((area("cleaned_m2") - 5.85).abs() < 1e-3 && (area("to_do_m2") - 5.85).abs() < 1e-3, "{proof}");
    assert_eq!((area("assumed_m2"), &proof["operator"]), (0.0, &"A. Smith".into()));
    assert!(
        proof["robot"].as_str().is_some_and(|robot| robot.starts_with("number 7 (configuration ")),
        "{proof}"
    );
    let rows = std::fs::read_to_string(&csv).expect("rows");
    assert_eq!((rows.lines().count(), rows.matches(",cleaned,100,5").count()), (1_171, 585));
    let page = std::fs::read_to_string(path.with_extension("html")).expect("the page");
    assert!(page.contains("Proof of cleaning") && page.contains("A. Smith") && page.contains("class=sign"));
}

#[test]
fn panel_serves_changed_floors() {
    let plan = Plan::named("empty", 1, 1_000_000).expect("a plan");
    let access =
        Access::new("127.0.0.1:0".parse().expect("an address"), Tokens::default()).expect("on the loopback");
    let mut panel =
        Panel::open(access, PanelView::new("a test", &plan.robot), Records::default()).expect("open");
    let address = panel.address();
    let ask = |path: &str| {
        let mut stream = TcpStream::connect(address).expect("it answers");
        let request = format!("GET {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).expect("sent");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("read");
        answer.split_once("\r\n\r\n").expect("a body").1.to_owned()
    };
    assert_eq!(ask("/layers?after=0"), "{}");
    panel.mission(&progress(0.5));
    let floor: serde_json::Value = serde_json::from_str(&ask("/layers?after=0")).expect("a floor");
    assert_eq!((&floor["width"], &floor["number"]), (&40.into(), &1.into()));
    let cells = |text: &serde_json::Value, letter: char| -> usize {
        // Count, colon, letter.
        let text: Vec<char> = text.as_str().expect("a text").chars().collect();
        let mut count = 0;
        let mut number = String::new();
        let mut letters = text.into_iter();
        while let Some(next) = letters.next() {
            match next {
                ':' if letters.next() == Some(letter) => {
                    count += std::mem::take(&mut number).parse::<usize>().expect("a count");
                }
                ':' => number.clear(),
                digit => number.push(digit),
            }
        }
        count
    };
    assert_eq!((cells(&floor["claimed"], 'c'), cells(&floor["claimed"], '.')), (585, 30));
    assert_eq!(cells(&floor["dirt"], '9') + cells(&floor["dirt"], '0'), 1_170);
}

/// A run in real time with a panel and a mission, looked at with a wide and with a narrow browser.
#[test]
fn browser_shows_floor_on_screen_and_phone() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium is installed");
        return;
    };
    // Longer than the patience of both browsers together: a picture behind the end shows a robot that has ended.
    let plan = Plan::named("empty", 1, 400_000_000).expect("a plan");
    let access =
        Access::new("127.0.0.1:0".parse().expect("an address"), Tokens::default()).expect("on the loopback");
    // With the token the page has buttons.
    let token = access.token.clone();
    let panel = Panel::open(access, PanelView::new("a test", &plan.robot), Records::default()).expect("open");
    let address = format!("http://{}/#{token}", panel.address());
    let run = std::thread::spawn(move || {
        let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
        let mut observer = Observer::new(&plan, &mut show);
        let mut sinks = RunSinks::default();
        sinks.panel = Some(panel);
        sinks.mission(&progress(0.5));
        run_recorded(&plan, &mut observer, &mut sinks).map_err(|error| error.to_string())
    });
    std::thread::scope(|scope| {
        for size in [(1280, 800), (390, 1400)] {
            let address = &address;
            scope.spawn(move || {
                let seen = Page::open(browser, address, size).until(Seen::of, Seen::is_all);
                println!("{size:?}: {seen:?}");
                assert!(seen.last().is_some_and(Seen::is_all), "{size:?}: {seen:?}");
            });
        }
    });
    // The run goes on in its thread; it has been seen.
    drop(run);
}

/// Pixels of what must be seen, on the narrow screen too: cleaned floor and floor to do as they blend with the background, the bar of the progress, the robot's body and the buttons.
#[derive(Debug)]
struct Seen {
    clean: usize,
    dirty: usize,
    bar: usize,
    blue: usize,
}

impl Seen {
    fn of(picture: &image::RgbImage) -> Self {
        let near = |pixel: &image::Rgb<u8>, colour: [u8; 3]| {
            pixel.0.iter().zip(colour).all(|(a, b)| a.abs_diff(b) <= 6)
        };
        let count = |colour: [u8; 3]| picture.pixels().filter(|pixel| near(pixel, colour)).count();
        Self {
            clean: count([152, 189, 159]),
            dirty: count([218, 189, 137]),
            bar: count([0x2E, 0x7D, 0x32]),
            blue: count([0x0B, 0x53, 0x94]),
        }
    }

    const fn is_all(&self) -> bool {
        self.clean > 1_000 && self.dirty > 500 && self.bar > 1_000 && self.blue > 2_000
    }
}
