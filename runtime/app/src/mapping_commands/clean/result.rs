//! What came of cleaning: figures, clouds, pictures.

use std::path::Path;

use floorguard_host::outcome::{BadInput, WrongUsage};
use floorguard_mapping_host::clean::Thinned;
use floorguard_mapping_host::output::{TopView, cloud_pcd, cloud_ply, draw_top_view};
use floorguard_types::geometry::Point3;
use serde::Serialize;

use super::super::files::write_whole;

/// The figures; field names say the units.
#[derive(Clone, Debug, Default, Serialize)]
pub struct CleanSummary {
    /// Sweeps read.
    pub sweeps: u64,
    /// Of them without a pose at their time: in no cloud.
    pub sweeps_without_pose: u64,
    /// Of them without a floor: nothing of them was removed.
    pub sweeps_without_floor: u64,
    /// Returns with a pose.
    pub returns: u64,
    /// Returns of what moved, by free space.
    pub returns_moved: u64,
    /// Returns in boxes around people, beyond those.
    pub returns_in_boxes: u64,
    /// Points of the clean cloud.
    pub points_clean: usize,
    /// Points of the cloud of what was removed.
    pub points_removed: usize,
    /// Hits and stretches of rays that did not fit into memory.
    pub evidence_left_out: u32,
    /// Height of the floor in the map.
    pub floor_m: f32,
    /// Time of the first pass, evidence.
    pub observe_ms_per_sweep: f64,
    /// Time of the second pass, verdicts.
    pub judge_ms_per_sweep: f64,
}

/// Files of the folder; the first marks it as ours.
const FILES: [&str; 7] =
    ["clean.ply", "clean.pcd", "removed.ply", "removed.pcd", "before.png", "after.png", "summary.json"];

/// Makes the folder, or takes the one of a former run.
///
/// # Errors
/// It holds files and no cloud of ours, or cannot be made.
pub fn prepare(folder: &Path) -> Result<(), WrongUsage> {
    let is_empty = std::fs::read_dir(folder).map_or(true, |mut entries| entries.next().is_none());
    if !is_empty && !folder.join(FILES[0]).is_file() {
        let what = "this folder holds files and no cloud of ours; give another folder, which is made";
        return Err(WrongUsage(format!("{}: {what}", folder.display())));
    }
    std::fs::create_dir_all(folder).map_err(|error| WrongUsage(format!("{}: {error}", folder.display())))
}

/// Writes clouds, pictures and figures.
///
/// # Errors
/// A file cannot be written.
pub fn write(
    folder: &Path,
    clean: &Thinned,
    removed: &Thinned,
    summary: &CleanSummary,
) -> anyhow::Result<()> {
    let (kept, gone) = (clean.points(), removed.points());
    let all: Vec<Point3> = kept.iter().chain(gone).copied().collect();
    let heights_m = [summary.floor_m + 0.1, summary.floor_m + 2.0];
    let before = TopView { kept, removed: gone, heights_m };
    let after = TopView { removed: &[], ..before };
    let contents = [
        cloud_ply(kept),
        cloud_pcd(kept),
        cloud_ply(gone),
        cloud_pcd(gone),
        draw_top_view(&before, &all),
        draw_top_view(&after, &all),
        (serde_json::to_string_pretty(summary)? + "\n").into_bytes(),
    ];
    for (name, bytes) in FILES.iter().zip(&contents) {
        write_whole(&folder.join(name), bytes).map_err(|error: BadInput| anyhow::Error::from(error))?;
    }
    Ok(())
}
