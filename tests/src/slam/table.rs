//! Runs the logs and prints the table.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use floorguard_app::mapping_commands::{MapArguments, map};
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::metrics::{RelationScore, read_relations, read_tum, score_relations};

use super::logs::{LOGS, Log, PEERS, text};

/// Poses farther from the times of a relation do not count, seconds.
const TOLERANCE_S: f64 = 0.1;
/// Relations without a pose, at most: a share of all.
const WITHOUT_MAX: f64 = 0.01;

/// Maps the five logs with one set of values into folders of `folder`, prints the table and writes it to `slam.md`. True if no
/// log is beyond its limit; absent logs are left out with a line each.
///
/// # Errors
/// A file that cannot be read or written, or a log that cannot be mapped.
pub fn slam(folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let mut table = String::from("| log | ours, cm | rotation, ° | largest, cm | time, s |");
    PEERS.iter().for_each(|peer| table += &format!(" {peer} |"));
    table += "\n|---|---|---|---|---|";
    table += &"---|".repeat(PEERS.len());
    table.push('\n');
    let mut holds = true;
    for log in &LOGS {
        let Some([file, key]) = log.files(folder)? else { continue };
        let began = Instant::now();
        let out = folder.join(log.name);
        map(&arguments(&file, &out))?;
        let took_s = began.elapsed().as_secs_f64();
        let trajectory = read_tum(&text(&out.join("trajectory.tum"))?)?;
        let mut flat: Vec<(f64, Se2)> = trajectory.iter().map(|pose| (pose.time_s, pose.flat())).collect();
        flat.sort_by(|a, b| a.0.total_cmp(&b.0));
        let relations = read_relations(&text(&key)?)?;
        let score = score_relations(&relations, &flat, TOLERANCE_S);
        holds &= score.translation_mean_m() <= log.limit_m
            && score.without_pose as f64 <= WITHOUT_MAX * relations.len() as f64;
        row(&mut table, log, &score, took_s);
    }
    println!("{table}");
    std::fs::write(folder.join("slam.md"), &table)?;
    Ok((table, holds))
}

fn arguments(file: &Path, out: &Path) -> MapArguments {
    MapArguments::of_drive(file.to_owned(), out.to_owned())
}

fn row(table: &mut String, log: &Log, score: &RelationScore, took_s: f64) {
    // Writing to a string cannot fail.
    let _ = write!(
        table,
        "| {} | {:.2} | {:.2} | {:.1} | {took_s:.1} |",
        log.name,
        100.0 * score.translation_mean_m(),
        score.rotation_mean_rad().to_degrees(),
        100.0 * score.translation_max_m()
    );
    for peer_m in log.peers_m {
        let _ =
            if peer_m.is_nan() { write!(table, " – |") } else { write!(table, " {:.1} |", 100.0 * peer_m) };
    }
    table.push('\n');
}
