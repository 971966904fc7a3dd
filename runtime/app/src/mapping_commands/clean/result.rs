//! What came of cleaning: figures, clouds, pictures.

use std::path::Path;

use floorguard_host::outcome::WrongUsage;
use floorguard_mapping::people_removal::{RevisitRule, Sighting, revisits};
use floorguard_mapping_host::clean::{PeopleInImages, RemovedAreas};
use floorguard_mapping_host::metrics::{TimedPose, write_tum_in_space};
use floorguard_mapping_host::output::{
    CloudPage, TopView, cloud_las, cloud_page, cloud_pcd, cloud_ply, draw_top_view,
};
use floorguard_recording::{NamedCloud, PointRow, map_clouds};
use floorguard_types::geometry::{Point3, Pose2};
use floorguard_types::time::Stamp;
use serde::Serialize;

use crate::files::write_whole;

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
    /// Pictures whose boxes were used.
    pub pictures_used: u64,
    /// Pictures without a sweep or a pose at their time.
    pub pictures_unused: u64,
    /// Boxes that became places.
    pub boxes_placed: u64,
    /// Boxes with too few lidar points.
    pub boxes_without_points: u64,
    /// Boxes with a confidence below 0.5, or empty.
    pub boxes_not_sure: u64,
    /// Boxes beyond 32 in one picture.
    pub boxes_beyond_32: u64,
    /// Places of people, seen once or more.
    pub places: usize,
    /// Places beyond the 1,024 that are kept.
    pub places_left_out: u64,
    /// Floor below what was removed.
    pub removed_m2: f32,
    /// Of that, floor that was seen at another time.
    pub filled_m2: f32,
    /// Its share, 0 to 1.
    pub filled_share: f32,
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

impl CleanSummary {
    /// Takes over what became of the pictures of all surveys.
    pub fn enter_images(&mut self, surveys: &[PeopleInImages]) {
        let most = surveys.iter().map(PeopleInImages::pictures).max().unwrap_or(0) as u64;
        for images in surveys {
            let counts = images.counts;
            self.pictures_used += counts.used;
            self.boxes_placed += counts.placed;
            self.boxes_without_points += counts.without_points;
            self.boxes_not_sure += counts.not_sure;
            self.boxes_beyond_32 += counts.beyond_32;
            self.places += images.sightings().entries().len();
            self.places_left_out += u64::from(images.sightings().left_out());
        }
        self.pictures_unused = most.saturating_sub(self.pictures_used);
    }
}

/// What came of cleaning.
pub struct Cleaned<'a> {
    /// Points that stay.
    pub clean: &'a [Point3],
    /// Points that were removed.
    pub removed: &'a [Point3],
    /// People in pictures.
    pub sightings: &'a [Sighting],
    /// The lidar's poses, where the command found them itself.
    pub track: Option<&'a [TimedPose]>,
}

/// This file marks the folder as ours.
const MARKER: &str = "clean.ply";

/// Makes the folder, or takes the one of a former run.
///
/// # Errors
/// It holds files and no cloud of ours, or cannot be made.
pub fn prepare(folder: &Path) -> Result<(), WrongUsage> {
    let is_empty = std::fs::read_dir(folder).map_or(true, |mut entries| entries.next().is_none());
    if !is_empty && !folder.join(MARKER).is_file() {
        let what = "this folder holds files and no cloud of ours; give another folder, which is made";
        return Err(WrongUsage(format!("{}: {what}", folder.display())));
    }
    std::fs::create_dir_all(folder).map_err(|error| WrongUsage(format!("{}: {error}", folder.display())))
}

/// Writes clouds, pictures and figures, and completes the summary.
///
/// # Errors
/// A file cannot be written.
pub fn write(folder: &Path, cleaned: &Cleaned<'_>, summary: &mut CleanSummary) -> anyhow::Result<()> {
    let put = |name: &str, bytes: &[u8]| write_whole(&folder.join(name), bytes);
    let (kept, gone, floor_m) = (cleaned.clean, cleaned.removed, summary.floor_m);
    (summary.points_clean, summary.points_removed) = (kept.len(), gone.len());
    let mut areas = RemovedAreas::new(gone.iter().copied(), floor_m);
    areas.see(kept.iter().copied());
    let count = areas.count();
    (summary.removed_m2, summary.filled_m2, summary.filled_share) =
        (count.removed_m2, count.filled_m2, count.filled_share());
    let all: Vec<Point3> = kept.iter().chain(gone).copied().collect();
    for (name, points) in [("clean", kept), ("removed", gone), ("before", &all)] {
        put(&format!("{name}.ply"), &cloud_ply(points))?;
        put(&format!("{name}.pcd"), &cloud_pcd(points))?;
        put(&format!("{name}.las"), &cloud_las(points)?)?;
    }
    let before = TopView { kept, removed: gone, heights_m: [floor_m + 0.1, floor_m + 2.0] };
    put("before.png", &draw_top_view(&before, &all))?;
    put("after.png", &draw_top_view(&TopView { removed: &[], ..before }, &all))?;
    put("view.html", page(cleaned, summary, &areas.filled_points(kept)).as_bytes())?;
    put("clouds.mcap", &recording([kept, gone, &areas.filled_points(kept)])?)?;
    if !cleaned.sightings.is_empty() {
        put("people.csv", people(cleaned.sightings).as_bytes())?;
        put("revisits.csv", tour(cleaned.sightings).as_bytes())?;
    }
    if let Some(poses) = cleaned.track {
        put("trajectory.tum", write_tum_in_space(poses).as_bytes())?;
    }
    Ok(put("summary.json", (serde_json::to_string_pretty(summary)? + "\n").as_bytes())?)
}

/// What stays, what was removed, and what was seen where something was removed, for Foxglove and Rerun.
fn recording(clouds: [&[Point3]; 3]) -> anyhow::Result<Vec<u8>> {
    let topics = ["/map/clean", "/map/removed", "/map/filled"];
    let row = |point: &Point3| PointRow {
        position_m: [point.x_m, point.y_m, point.z_m],
        reflectivity: 0,
        ring: 0,
        time_s: 0.0,
    };
    let rows = clouds.map(|points| points.iter().map(row).collect::<Vec<_>>());
    let [clean, removed, filled] =
        [0, 1, 2].map(|index: usize| NamedCloud { topic: topics[index], points: &rows[index] });
    Ok(map_clouds(&[clean, removed, filled], Stamp::from_micros(1))?)
}

fn page(cleaned: &Cleaned<'_>, summary: &CleanSummary, filled: &[Point3]) -> String {
    let figures = [
        ("sweeps", summary.sweeps.to_string()),
        ("points that stay", summary.points_clean.to_string()),
        ("points removed", summary.points_removed.to_string()),
        ("floor below what was removed", format!("{:.1} m²", summary.removed_m2)),
        ("of it seen at another time", format!("{:.0} %", 100.0 * summary.filled_share)),
    ];
    cloud_page(&CloudPage {
        title: "Map before and after cleaning",
        figures: &figures,
        kept: cleaned.clean,
        removed: cleaned.removed,
        filled,
        floor_m: summary.floor_m,
    })
}

fn people(sightings: &[Sighting]) -> String {
    let mut text = String::from("x_m,y_m,z_m,seen_from_x_m,seen_from_y_m,seen_from_heading_rad,pictures\n");
    for seen in sightings {
        let (place, from) = (seen.person_in_map, seen.seen_from_in_map);
        text += &format!(
            "{:.3},{:.3},{:.3},{:.3},{:.3},{:.4},{}\n",
            place.x_m, place.y_m, place.z_m, from.x_m, from.y_m, from.heading_rad, seen.count
        );
    }
    text
}

/// Poses from which people were seen, in the order of a short tour from the last one: from there the robot goes on.
fn tour(sightings: &[Sighting]) -> String {
    let last = sightings.iter().max_by_key(|seen| seen.stamp);
    let start = last.map_or_else(Pose2::default, |seen| seen.seen_from_in_map);
    let mut text = String::from("lidar_x_m,lidar_y_m,lidar_heading_rad\n");
    for pose in revisits(sightings, start, RevisitRule::default(), |_| true) {
        text += &format!("{:.3},{:.3},{:.4}\n", pose.x_m, pose.y_m, pose.heading_rad);
    }
    text
}
