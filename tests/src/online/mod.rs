//! Learning on the robot in new places, in simulation: `cargo xtask reproduce online-learning`.
//!
//! Rooms and sensor heights that made neither the shipped classifier nor the anchors. The robot stands and watches;
//! every sample is scored before anything is learnt from it. What must show: nothing gets worse anywhere.

use std::fmt::Write as _;
use std::path::Path;

use floorguard_laboratory::train::{
    OnlinePlace, OnlineReport, anchors, draw_online, learn_place, random_scenes,
};
use floorguard_perception::online_learning::LabelledShape;
use rayon::prelude::*;

/// Seed of the first room; the anchors have seeds from 90,000, the shipped table those below 1,000. In rooms from 70,000 on
/// the learner and its rule were chosen; nobody looked at these before.
const SEED: u64 = 76_000;
/// Rooms of the anchors.
const ANCHOR_SCENES: u64 = 40;
/// How much precision and recall of the second half may fall against the shipped classifier: a few samples.
const WORSE_MAX: [f64; 2] = [0.005, 0.01];

/// The places: random rooms, each with a lidar at another height than the last.
#[must_use]
pub fn places(count: u64, seconds: usize) -> Vec<OnlinePlace> {
    let heights_m = [0.8, 0.4, 1.6, 0.6];
    let rooms = random_scenes(SEED, count);
    let each = rooms.into_iter().zip(heights_m.into_iter().cycle()).enumerate();
    each.map(|(index, (run, height_m))| OnlinePlace {
        name: format!("room_{index}"),
        scenario: run.scenario,
        seed: run.seed,
        seconds,
        scale: run.scale,
        sensor_height_m: height_m,
    })
    .collect()
}

/// Learns in every place from nothing.
#[must_use]
pub fn learn_everywhere(places: &[OnlinePlace], anchors: &[LabelledShape]) -> Vec<OnlineReport> {
    places.par_iter().map(|place| learn_place(place, anchors, None).0).collect()
}

/// Nothing got worse: not in the second half of the time, and not on the anchors.
#[must_use]
pub fn holds(report: &OnlineReport) -> bool {
    let [shipped, learned] = report.second_half;
    let not_worse =
        shipped.iter().zip(learned).zip(WORSE_MAX).all(|((before, after), most)| after >= before - most);
    let [[recall, _], [learned_recall, _]] = report.anchors;
    not_worse && learned_recall >= recall - 0.01
}

fn line(place: &OnlinePlace, report: &OnlineReport) -> String {
    let [[precision, recall], [learned_precision, learned_recall]] = report.second_half;
    let last = report.windows.last().copied().unwrap_or_default();
    let [people, non_people, _] = last.labelled;
    let [taken, refused] = last.judged;
    format!(
        "{:<10} {:>6.1} {precision:>9.3} {recall:>7.3} {learned_precision:>10.3} {learned_recall:>7.3} {:>8.3} {:>7.3} {people:>7} {non_people:>7} {taken:>6} {refused:>8}\n",
        report.place,
        place.sensor_height_m,
        report.shipped.f1(),
        report.learned.f1(),
    )
}

/// Runs eight places for `minutes` each; tables, JSON and pictures into `folder`. The second value says whether nothing
/// got worse anywhere.
///
/// # Errors
/// The folder cannot be written.
pub fn online_learning(minutes: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let places = places(8, 60 * minutes as usize);
    let anchors = anchors(ANCHOR_SCENES);
    let reports = learn_everywhere(&places, &anchors);
    let mut text = format!(
        "{minutes} min in each place; {} anchors; precision and recall of the second half of the time, F1 of all\n",
        anchors.len()
    );
    let _ = writeln!(
        text,
        "{:<10} {:>6} {:>17} {:>18} {:>8} {:>7} {:>7} {:>7} {:>6} {:>8}",
        "place",
        "height",
        "shipped P, R",
        "learned P, R",
        "F1 ship",
        "F1 new",
        "people",
        "nobody",
        "taken",
        "refused"
    );
    for (place, report) in places.iter().zip(&reports) {
        text.push_str(&line(place, report));
        draw_online(folder, report)?;
    }
    let (mut shipped, mut learned) = (reports[0].shipped, reports[0].learned);
    for report in &reports[1..] {
        shipped.add(&report.shipped);
        learned.add(&report.learned);
    }
    let _ = writeln!(
        text,
        "all places, all the time: shipped {:.3} {:.3}, learned {:.3} {:.3}",
        shipped.precision(),
        shipped.recall(),
        learned.precision(),
        learned.recall()
    );
    eprintln!("{text}");
    std::fs::write(folder.join("online_learning.txt"), &text)?;
    std::fs::write(folder.join("online_learning.json"), serde_json::to_string_pretty(&reports)?)?;
    Ok((text, reports.iter().all(holds)))
}
