//! An interrupted mapping goes on: its state lies beside the folder of the map until the map is whole.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use floorguard_host::outcome::BadInput;
use floorguard_mapping_host::mapper::{MapConfig, Mapper};

use super::arguments::MapArguments;
use crate::files::write_whole_by;

/// The state is written this often.
const EVERY: Duration = Duration::from_secs(5);

/// Where the state of a mapping lies, and when it was written.
pub struct Checkpoint {
    path: PathBuf,
    key: u64,
    written: Cell<Instant>,
    /// Scans that are in the map already.
    pub scans: u64,
}

impl Checkpoint {
    /// Of a folder of a map: `.NAME.resume` beside it. The mapping begins anew where none lies there, or one of other files or
    /// options.
    pub fn open(arguments: &MapArguments, out: &Path, config: &MapConfig) -> (Self, Mapper) {
        let name = out.file_name().unwrap_or_default().to_string_lossy();
        let path = out.with_file_name(format!(".{name}.resume"));
        let key = key(arguments);
        let bytes = std::fs::read(&path).unwrap_or_default();
        let written = Cell::new(Instant::now());
        match Mapper::resume(config.clone(), &bytes, key) {
            Some(resumed) => (Self { path, key, written, scans: resumed.scans }, resumed.mapper),
            None => (Self { path, key, written, scans: 0 }, Mapper::new(config.clone())),
        }
    }

    /// Writes the state now and then; `scans` are in the map.
    ///
    /// # Errors
    /// The system refuses.
    pub fn keep(&self, mapper: &Mapper, scans: u64) -> Result<(), BadInput> {
        if self.written.get().elapsed() < EVERY {
            return Ok(());
        }
        // While loops are worked in, the next scans are waited for.
        if !mapper.is_settled() {
            return Ok(());
        }
        self.written.set(Instant::now());
        // The folder of the map is made when the map is whole; its parent may not be there yet.
        if let Some(parent) = self.path.parent() {
            let refused = |error| BadInput(format!("{}: cannot be made ({error})", parent.display()));
            std::fs::create_dir_all(parent).map_err(refused)?;
        }
        write_whole_by(&self.path, |to| mapper.checkpoint(scans, self.key, to).map(drop))
    }

    /// The map is whole: the state goes.
    pub fn remove(&self) {
        // A state that stays does no harm: it is used for the same input only.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// A number of the input and of all options that change the map.
fn key(arguments: &MapArguments) -> u64 {
    let mut text = format!("{:?} {} {}", arguments.drive, arguments.range_m, env!("CARGO_PKG_VERSION"));
    for file in &arguments.files {
        let facts = std::fs::metadata(file).ok();
        let changed = facts.as_ref().and_then(|facts| facts.modified().ok());
        text += &format!(" {} {:?} {changed:?}", file.display(), facts.map(|facts| facts.len()));
    }
    text.bytes()
        .fold(0xCBF2_9CE4_8422_2325, |sum, byte| (sum ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3))
}
