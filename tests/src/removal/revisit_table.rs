//! The table of the tours: what each round left.

use std::fmt::Write as _;
use std::path::Path;

use floorguard_mapping_host::output::{CloudPage, cloud_page};

use super::driven::{Driven, driven_revisit};
use super::revisit::{Revisited, Round};

/// Seed of the buildings.
const SEED: u64 = 4_711;
/// Share of the floor below people that is seen at the end.
const FILLED: f32 = 0.95;
/// Share of people's returns that are removed.
const REMOVED: f64 = 0.98;
/// Share of the static points of the cloud that stay. Single returns are counted beside: a box takes some of the wall beside who stands.
const KEPT: f64 = 0.995;

/// Runs the experiment with so many random buildings, prints the table and writes it and two pages into `folder`. True if all
/// holes are filled and the people gone.
///
/// # Errors
/// A file that cannot be written.
pub fn people_revisits(trials: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let mut table = String::new();
    let holds = tours(trials, folder, &mut table)?;
    println!("{table}");
    std::fs::write(folder.join("revisits.md"), &table)?;
    Ok((table, holds))
}

/// Surveys and tours: the office, the conference room with its corridor, and so many random buildings. True if all holes are
/// filled and the people gone.
///
/// # Errors
/// The folder takes no page.
fn tours(trials: u64, folder: &Path, table: &mut String) -> anyhow::Result<bool> {
    *table += "| building | round | poses of the tour | floor below people, m² | of it seen, % | people removed, % | static points kept, % | of single returns, % |\n\
               |---|---|---|---|---|---|---|---|\n";
    let mut holds = true;
    let mut filled = Vec::new();
    let named = [("office, 1 person".to_owned(), 1, 1), ("conference room, 3 people".to_owned(), 2, 3)];
    let random = (0..trials).map(|trial| {
        let (rooms, count) = (2 + trial as usize % 4, 1 + trial as usize % 10);
        (format!("random building {trial}: {rooms} rooms, {count} people"), rooms, count)
    });
    for (number, (name, rooms, count)) in named.into_iter().chain(random).enumerate() {
        let (rounds, clouds) = Revisited::new(SEED + number as u64, rooms, count).run();
        rounds.iter().enumerate().for_each(|(round, each)| row(table, (&name, round), each));
        if let Some(last) = rounds.last() {
            filled.push(last.areas.filled_share());
            holds &= meets(last);
        }
        if number < 2 {
            let page = cloud_page(&CloudPage {
                title: &name,
                figures: &[],
                kept: &clouds.kept,
                removed: &clouds.removed,
                filled: &clouds.filled,
                floor_m: 0.0,
            });
            std::fs::write(folder.join(if number == 0 { "office.html" } else { "conference.html" }), page)?;
        }
    }
    let driven = driven_revisit(SEED)?;
    let name = "hall, tour driven by the robot itself";
    driven.rounds.iter().enumerate().for_each(|(round, each)| row(table, (name, round), each));
    holds &= driven.reached == driven.legs && driven.contacts == 0;
    if let Some(last) = driven.rounds.last() {
        holds &= meets(last) && last.seen == 0;
    }
    let Driven { legs, reached, contacts, driven_m, .. } = driven;
    let _ = writeln!(
        table,
        "\nby the robot itself: {reached} of {legs} stops of its tours reached, {contacts} contacts that its sensors could have \
         avoided, {driven_m:.0} m driven"
    );
    filled.sort_by(f32::total_cmp);
    let (worst, median) = (filled[0], filled[filled.len() / 2]);
    let _ =
        writeln!(table, "\nfilled at the end: worst {:.1} %, median {:.1} %", 100.0 * worst, 100.0 * median);
    Ok(holds)
}

fn meets(last: &Round) -> bool {
    last.areas.filled_share() >= FILLED
        && last.score.dynamic_accuracy() >= REMOVED
        && last.static_points_kept >= KEPT
}

fn row(table: &mut String, (name, round): (&str, usize), each: &Round) {
    // Writing to a string cannot fail.
    let _ = writeln!(
        table,
        "| {name} | {round} | {} | {:.2} | {:.1} | {:.2} | {:.3} | {:.3} |",
        each.stops,
        each.areas.removed_m2,
        100.0 * each.areas.filled_share(),
        100.0 * each.score.dynamic_accuracy(),
        100.0 * each.static_points_kept,
        100.0 * each.score.static_accuracy()
    );
    println!("{name}, round {round}: {each:?}");
}
