//! The window of a robot that has driven, as files.

use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_mapping_host::output::{OutputFile, check_place, replace_folder};
use floorguard_robot::actuated::WindowWatch;

use super::output::{files, page};

/// Writes the map that the thread of the window has left, if a folder is named.
///
/// # Errors
/// A folder that cannot take it, or a robot without a lidar that a motor turns.
pub fn leave_window(folder: Option<&Path>, watch: &WindowWatch) -> anyhow::Result<()> {
    let Some(folder) = folder else { return Ok(()) };
    let Some((map, report)) = watch.take_map().zip(watch.report()) else {
        let what = "--window: no window was made; robot.toml has no [actuated_lidar], or its thread failed";
        return Err(BadInput(what.to_owned()).into());
    };
    check_place(folder).map_err(|error| BadInput(error.to_string()))?;
    let mut all = files(&map, None, &serde_json::to_string(&report)?);
    let index = page(&all, &[report.words()]);
    all.push(OutputFile::new("index.html", index));
    replace_folder(folder, &all).map_err(|error| BadInput(error.to_string()))?;
    say!("  look at {}", folder.join("index.html").display());
    Ok(())
}
