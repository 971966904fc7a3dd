//! Dirt on floors of six kinds, in simulation: `cargo xtask reproduce dirt`.
//!
//! The published detector and ours see the very same frames; the truth is the simulator's. Then halls are driven lane
//! by lane, and the map of seen dirt is compared with what was spilled.

mod compare;
mod passes;
mod picture;
mod scenes;
mod trade;

use std::fmt::Write as _;
use std::path::Path;

use floorguard_laboratory::evaluate::DirtFigures;
use floorguard_sim::floor::{DirtKind, FloorKind};
use rayon::prelude::*;

pub use compare::{Cell, compare};
pub use passes::{OFFSETS, Pass, pass};
pub use scenes::{Approach, FRAMES, view};

/// Lanes and metres of a hall.
const HALL: (u32, f32) = (3, 6.0);
/// What this stage must reach.
const FOUND_MIN: f64 = 0.9;
const FALSE_A_100_M2_MAX: f64 = 1.0;

/// Runs the comparison with a number of scenes for each floor and dirt and as many halls of each floor; tables and
/// pictures go to the folder. Seeds below 1,000 were examined while the detector and the map were made. True if
/// everything that must show did.
///
/// # Errors
/// A file cannot be written, or a frame cannot be judged.
pub fn dirt(scenes: u64, seed: u64, folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let pairs: Vec<(FloorKind, DirtKind)> =
        FloorKind::ALL.into_iter().flat_map(|floor| DirtKind::ALL.map(|dirt| (floor, dirt))).collect();
    let cells: Vec<Cell> = pairs
        .par_iter()
        .map(|(floor, dirt)| compare(*floor, *dirt, (scenes, seed)))
        .collect::<anyhow::Result<_>>()?;
    let (mut text, is_better) = table(&cells, scenes);
    picture::draw(&folder.join("precision_recall.svg"), &cells)?;
    let halls: Vec<(FloorKind, u64)> = FloorKind::ALL
        .into_iter()
        .flat_map(|floor| {
            (0..scenes).map(move |number| (floor, seed.wrapping_mul(1_000).wrapping_add(number)))
        })
        .collect();
    let passes: Vec<Pass> =
        halls.par_iter().map(|(floor, seed)| pass(*floor, HALL, *seed)).collect::<anyhow::Result<_>>()?;
    let (map, is_found) = map_table(&passes);
    text += &map;
    let floors = by_floor(&passes);
    text += &trade_table(&floors);
    trade::draw(&folder.join("found_over_invented.svg"), &floors)?;
    print!("{text}");
    std::fs::write(folder.join("dirt.txt"), &text)?;
    Ok((text, is_better && is_found))
}

/// Best intersection over union and area under the curve, published against ours; true if ours is better on all floors.
fn table(cells: &[Cell], scenes: u64) -> (String, bool) {
    let mut text = format!(
        "{scenes} scenes of {FRAMES} frames for each floor and dirt; the last frame is judged, pixels\n\
         floor     dirt      best IoU: published  one frame   ours   AUC: published  one frame   ours   at own threshold: precision recall\n"
    );
    let mut is_better = true;
    for floor in FloorKind::ALL {
        let of_floor: Vec<&Cell> = cells.iter().filter(|cell| cell.floor == floor).collect();
        for cell in &of_floor {
            line(&mut text, (floor.name(), cell.dirt.name()), cell.figures);
        }
        let mean = [0, 1, 2].map(|method| mean(of_floor.iter().map(|cell| cell.figures[method])));
        line(&mut text, (floor.name(), "mean"), mean);
        is_better &= mean[2].best_iou > mean[0].best_iou && mean[2].auc > mean[0].auc;
    }
    let all = [0, 1, 2].map(|method| mean(cells.iter().map(|cell| cell.figures[method])));
    line(&mut text, ("all", "mean"), all);
    let _ = writeln!(text, "ours better on every floor: {is_better}\n");
    (text, is_better)
}

fn line(text: &mut String, (floor, dirt): (&str, &str), [published, alone, ours]: [DirtFigures; 3]) {
    let _ = writeln!(
        text,
        "{floor:9} {dirt:9} {:19.3} {:10.3} {:6.3} {:16.4} {:10.4} {:6.4} {:28.3} {:6.3}",
        published.best_iou,
        alone.best_iou,
        ours.best_iou,
        published.auc,
        alone.auc,
        ours.auc,
        ours.precision,
        ours.recall
    );
}

fn mean(figures: impl Iterator<Item = DirtFigures>) -> DirtFigures {
    let (mut sum, mut count) = (DirtFigures::default(), 0.0_f64);
    for figure in figures {
        sum.best_iou += figure.best_iou;
        sum.auc += figure.auc;
        sum.block_auc += figure.block_auc;
        sum.iou += figure.iou;
        sum.precision += figure.precision;
        sum.recall += figure.recall;
        count += 1.0;
    }
    let part = |value: f64| value / count.max(1.0);
    DirtFigures {
        best_iou: part(sum.best_iou),
        auc: part(sum.auc),
        block_auc: part(sum.block_auc),
        iou: part(sum.iou),
        precision: part(sum.precision),
        recall: part(sum.recall),
    }
}

/// The halls of each floor together.
fn by_floor(passes: &[Pass]) -> Vec<Pass> {
    let mut sums: Vec<Pass> = Vec::new();
    for pass in passes {
        match sums.last_mut().filter(|sum| sum.floor == pass.floor) {
            Some(sum) => sum.add(pass),
            None => sums.push(pass.clone()),
        }
    }
    sums
}

/// How the two hang on the limit.
fn trade_table(floors: &[Pass]) -> String {
    let mut text = String::from("limit moved by   spills found   false spots per 100 m²\n");
    for (offset, (found, rate)) in OFFSETS.iter().zip(trade::curve(floors)) {
        let _ = writeln!(text, "{offset:14} {:12.1} % {rate:19.2}", 100.0 * found);
    }
    text
}

/// Spills found and invented spots; true if both are as they must be.
fn map_table(passes: &[Pass]) -> (String, bool) {
    let mut text = String::from(
        "map after the median   area   frames   liquid  powder  crumbs  stain    found   false   ms a frame\n",
    );
    let (mut found, mut all, mut invented, mut area) = (0, 0, 0, 0.0);
    for pass in &by_floor(passes) {
        let hits: u32 = pass.found.iter().map(|(_, hits, _)| hits).sum();
        let spills: u32 = pass.found.iter().map(|(_, _, spills)| spills).sum();
        let kinds: String =
            pass.found.iter().map(|(_, hits, spills)| format!("{hits:3}/{spills:<4}")).collect();
        let _ = writeln!(
            text,
            "{:20} {:5.1} m² {:6}   {kinds} {hits:3}/{spills:<4} {:5} {:10.1}",
            pass.floor.name(),
            pass.area_m2,
            pass.frames,
            pass.false_spots,
            pass.took.as_secs_f64() * 1e3 / f64::from(pass.frames.max(1))
        );
        (found, all, invented) = (found + hits, all + spills, invented + pass.false_spots);
        area += f64::from(pass.area_m2);
    }
    let (part, rate) =
        (f64::from(found) / f64::from(all.max(1)), 100.0 * f64::from(invented) / area.max(1.0));
    let holds = part >= FOUND_MIN && rate <= FALSE_A_100_M2_MAX;
    let _ = writeln!(
        text,
        "all: {:.1} % of {all} spills found, {rate:.2} false spots per 100 m²: {holds}",
        100.0 * part
    );
    (text, holds)
}
