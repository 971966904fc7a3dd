//! Reads a scenario file and what lies beside it: the map of its walls, the recording of its people.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use floorguard_mapping::Occupancy;
use floorguard_sim::people::RecordedWalk;
use floorguard_sim::scenario::{RecordedFile, Scenario};
use floorguard_sim::scene::OccupiedCells;
use floorguard_types::geometry::{Point2, Pose2};

use floorguard_robot::environment::{TrackReading, read_tracks};
use floorguard_robot::site::ros_map;

/// Reads a scenario with its map and its recording; their paths are relative to the file.
///
/// # Errors
/// A file that cannot be read or is wrong, with its name.
pub fn load_scenario(path: &Path) -> anyhow::Result<Scenario> {
    let name = path.display();
    let text = std::fs::read_to_string(path).with_context(|| {
        format!("{name}: cannot be read; `floorguard simulate --scenario list` shows the built-in ones")
    })?;
    let mut scenario = Scenario::from_toml(&text).with_context(|| format!("{name}"))?;
    let folder = path.parent().unwrap_or(Path::new("."));
    if let Some(map) = &scenario.scene.map {
        scenario.scene.occupied =
            occupied(&folder.join(&map.file)).with_context(|| format!("{name}: [scene.map]"))?;
    }
    if let Some(recorded) = &scenario.recorded {
        scenario.walks = walks(folder, recorded).with_context(|| format!("{name}: [recorded]"))?;
    }
    Ok(scenario)
}

fn occupied(path: &Path) -> anyhow::Result<OccupiedCells> {
    let map = ros_map::load(path)?;
    let geometry = map.geometry();
    let corner = geometry.origin_in_map();
    Ok(OccupiedCells {
        origin_m: [corner.x_m, corner.y_m],
        resolution_m: geometry.resolution_m(),
        width: usize::from(geometry.width()),
        occupied: map.values().iter().map(|cell| *cell == Occupancy::Occupied).collect(),
    })
}

/// One walk for each person of the recording, in the world frame and the run's time.
fn walks(folder: &Path, recorded: &RecordedFile) -> anyhow::Result<Vec<RecordedWalk>> {
    let recording = read_tracks(&folder.join(&recorded.file), TrackReading::default())?.recording;
    let place = Pose2::new(recorded.at_m[0], recorded.at_m[1], recorded.yaw_deg.to_radians());
    let from_us = (f64::from(recorded.from_s) * 1.0e6) as i64;
    let mut walks: BTreeMap<u64, Vec<(u64, Point2)>> = BTreeMap::new();
    for (at_us, points) in &recording.moments {
        let Ok(at_us) = u64::try_from(at_us - from_us) else { continue };
        for point in points {
            walks.entry(point.id).or_default().push((at_us, place.transform(point.position)));
        }
    }
    Ok(walks.into_values().map(|places| RecordedWalk { places }).collect())
}
