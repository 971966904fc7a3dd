//! `--map-here`: the building is mapped from what the robot saw on a drive.

use std::path::{Path, PathBuf};

use clap::Args;
use floorguard_host::outcome::{BadInput, WrongUsage};
use floorguard_mapping_host::output::check_place;

use crate::mapping_commands::{self, MapArguments};

/// Whether a drive becomes a map.
#[derive(Clone, Debug, Default, Args)]
pub struct MapHere {
    /// Map the building: when the drive ends, its scans and wheels become a map in this folder, as by `floorguard map`. Without
    /// --record the drive is recorded beside it, as DIR.mcap, from which the map can be made again.
    #[arg(long = "map-here", value_name = "DIR")]
    pub folder: Option<PathBuf>,
}

impl MapHere {
    /// Drives with a recording, and maps from it if that is wanted; a drive that ends with a bad verdict is mapped, too.
    ///
    /// # Errors
    /// A folder that cannot take a map, those of the drive, and those of the mapping.
    pub fn drive(
        &self,
        record: Option<&Path>,
        drive: impl FnOnce(Option<PathBuf>) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let Some(folder) = &self.folder else { return drive(record.map(Path::to_owned)) };
        check_place(folder).map_err(|error| WrongUsage(error.to_string()))?;
        let recording = record.map_or_else(|| folder.with_added_extension("mcap"), Path::to_owned);
        if let Some(parent) = recording.parent() {
            let bad = |error: std::io::Error| BadInput(format!("{}: {error}", parent.display()));
            std::fs::create_dir_all(parent).map_err(bad)?;
        }
        let driven = drive(Some(recording.clone()));
        if driven.as_ref().is_err_and(|error| error.is::<BadInput>() || error.is::<WrongUsage>()) {
            return driven;
        }
        say!("mapping from {}", recording.display());
        let mapped = mapping_commands::map(&MapArguments::of_drive(recording, folder.clone()));
        driven.and(mapped)
    }
}
