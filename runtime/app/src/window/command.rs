//! Runs it and says what was found.

use floorguard_host::outcome::{BadInput, VerdictFailed, WrongUsage};
use floorguard_mapping::Occupancy;
use floorguard_mapping_host::output::{OutputFile, check_place, plan_map, replace_folder};
use serde_json::{Value, json};

use super::arguments::WindowArguments;
use super::output::{files, page};
use super::recording;
use floorguard_robot::actuated::WindowMap;

/// More of the scans refused than this: the map is doubtful.
const REFUSED_SHARE_MAX: f64 = 0.2;

/// A map, and what belongs to it.
struct Found {
    map: WindowMap,
    /// More of the summary.
    source: Value,
    /// The panorama, and the files of the map.
    files: Vec<OutputFile>,
    faults: Vec<String>,
}

/// Runs the command.
///
/// # Errors
/// Bad input, a folder that cannot take a map, or scans that were refused (the map is written all the same).
pub fn run(arguments: &WindowArguments) -> anyhow::Result<()> {
    check_place(&arguments.out).map_err(|error| WrongUsage(error.to_string()))?;
    let found = match (&arguments.scenario, &arguments.scans, &arguments.servo) {
        (Some(name), _, _) => simulated(arguments, name)?,
        (None, Some(scans), Some(servo)) => {
            let (map, recorded) = recording::play(arguments, (scans, servo))?;
            let source = json!({
                "recorded_scans": recorded.scans,
                "recorded_ranges": recorded.ranges,
                "recorded_sum_m": recorded.sum_m,
            });
            finish(map, (source, Vec::new()), |map, summary| files(map, None, summary))
        }
        _ => return Err(WrongUsage("a recording with its servo, or a scenario".to_owned()).into()),
    };
    conclude(arguments, found)
}

#[cfg(feature = "laboratory")]
fn simulated(arguments: &WindowArguments, name: &str) -> anyhow::Result<Found> {
    use floorguard_mapping_host::output::picture_png;
    use floorguard_types::geometry::{Point3, Pose2};

    let super::simulated::Simulated { map, session, panorama } = super::simulated::play(arguments, name)?;
    let source = json!({
        "scenario": name,
        "lidar": session.lidar,
        "clock_uncertainty_us": session.clock_uncertainty_us(),
    });
    let geometry = panorama.geometry;
    let columns = usize::from(geometry.columns);
    // From the window's frame to the robot, where the camera is.
    let robot_from_window: Pose2 = panorama.pose.inverse().compose(map.window.frame_in_odometry());
    let pixels = panorama.pixels.clone();
    let colour = move |point: Point3| {
        let flat = robot_from_window.transform(floorguard_types::geometry::Point2::new(point.x_m, point.y_m));
        let pixel = geometry.pixel_of(Point3::new(flat.x_m, flat.y_m, point.z_m))?;
        let from = 3 * (pixel.row * columns + pixel.column);
        pixels.get(from..from + 3).map(|rgb| [rgb[0], rgb[1], rgb[2]])
    };
    let mut found = finish(map, (source, session.faults), |map, summary| files(map, Some(&colour), summary));
    let strip = picture_png(u32::from(geometry.columns), u32::from(geometry.rows), panorama.pixels);
    found.files.push(OutputFile::new("panorama.png", strip));
    Ok(found)
}

#[cfg(not(feature = "laboratory"))]
fn simulated(_arguments: &WindowArguments, _name: &str) -> anyhow::Result<Found> {
    Err(WrongUsage("this program was built without the simulator".to_owned()).into())
}

fn finish(
    map: WindowMap,
    (mut source, faults): (Value, Vec<String>),
    files: impl FnOnce(&WindowMap, &str) -> Vec<OutputFile>,
) -> Found {
    let floor = plan_map(&map.plan, map.now);
    let taken = &map.taken;
    let refused: Value =
        taken.refused.iter().map(|(kind, one)| ((*kind).to_owned(), json!(one.count))).collect();
    let geometry = map.window.geometry();
    let more = json!({
        "scans": taken.scans,
        "surfaces": taken.surfaces,
        "people_points": taken.people,
        "refused": refused,
        "cells": map.window.points().count(),
        "grid_columns": geometry.columns(),
        "grid_rows": geometry.rows(),
        "cell_m": geometry.resolution_m(),
        "map_columns": floor.columns,
        "map_rows": floor.rows,
        "map_cell_m": floor.cell_m,
        "free_m2": floor.area_m2(Occupancy::Free),
        "occupied_m2": floor.area_m2(Occupancy::Occupied),
        "arrows": map.arrows().len(),
        "faults": faults,
    });
    if let (Some(all), Some(more)) = (source.as_object_mut(), more.as_object()) {
        all.extend(more.clone());
    }
    let files = files(&map, &source.to_string());
    Found { map, source, files, faults }
}

/// What was refused, in words.
fn refusals(map: &WindowMap) -> Vec<String> {
    map.taken.refused.values().map(|one| format!("refused {} times: {}", one.count, one.first)).collect()
}

fn conclude(arguments: &WindowArguments, mut found: Found) -> anyhow::Result<()> {
    let taken = &found.map.taken;
    let refused: u64 = taken.refused.values().map(|one| one.count).sum();
    let mut lines = vec![
        format!(
            "{} scans entered, {} cells of the window hold something",
            taken.scans, found.source["cells"]
        ),
        format!(
            "{:.2} m² free, {:.2} m² occupied",
            found.source["free_m2"].as_f64().unwrap_or(0.0),
            found.source["occupied_m2"].as_f64().unwrap_or(0.0)
        ),
        format!("{} movement arrows", found.map.arrows().len()),
    ];
    lines.extend(refusals(&found.map));
    lines.extend(found.faults.iter().cloned());
    let page = page(&found.files, &lines);
    found.files.push(OutputFile::new("index.html", page));
    replace_folder(&arguments.out, &found.files).map_err(|error| BadInput(error.to_string()))?;
    if arguments.json {
        tell!("{}", found.source)?;
    } else {
        say!("window: {}", arguments.out.display());
        lines.iter().for_each(|line| say!("  {line}"));
        say!("  look at {}", arguments.out.join("index.html").display());
    }
    let all = taken.scans + refused;
    if all == 0 {
        return Err(BadInput("no scan in it".to_owned()).into());
    }
    if refused as f64 > REFUSED_SHARE_MAX * all as f64 {
        let why = refusals(&found.map).join("; ");
        return Err(VerdictFailed(format!("of {all} scans {refused} were refused: {why}")).into());
    }
    Ok(())
}
