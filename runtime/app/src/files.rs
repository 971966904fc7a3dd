//! Files that are read as a whole.

use std::fs::File;
use std::io::{BufWriter, Read as _, Write as _};
use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_host::packing::unpacked;
use floorguard_mapping_host::grid_map::GridMap;
use floorguard_robot::site::ros_map;

/// Text of a file, packed or not.
///
/// # Errors
/// It cannot be read, or is no text.
pub fn text(path: &Path) -> Result<String, BadInput> {
    let bad = |error: std::io::Error| BadInput(format!("{}: {error}", path.display()));
    let mut text = String::new();
    File::open(path).and_then(unpacked).map_err(bad)?.read_to_string(&mut text).map_err(bad)?;
    Ok(text)
}

/// Writes a file whole: beside its place first, then put there in one step.
///
/// # Errors
/// The system refuses.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), BadInput> {
    write_whole_by(path, |to| to.write_all(bytes))
}

/// The same, with what `write` writes piece by piece.
///
/// # Errors
/// The system refuses.
pub fn write_whole_by(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<(), BadInput> {
    let bad = |error: std::io::Error| BadInput(format!("{}: cannot be written ({error})", path.display()));
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    let beside = path.with_file_name(name);
    let mut to = BufWriter::new(File::create(&beside).map_err(bad)?);
    write(&mut to).and_then(|()| to.flush()).and_then(|()| to.get_ref().sync_all()).map_err(bad)?;
    std::fs::rename(&beside, path).map_err(bad)
}

/// A map: a folder of `floorguard map`, a map of ROS (.yaml), or a bare picture.
///
/// # Errors
/// It cannot be read.
pub fn grid_map(path: &Path) -> Result<GridMap, BadInput> {
    let file = if path.is_dir() { path.join("map.yaml") } else { path.to_owned() };
    let loaded = ros_map::load(&file).map_err(|error| BadInput(format!("{error:#}")))?;
    let geometry = loaded.geometry();
    let corner = geometry.origin_in_map();
    Ok(GridMap {
        columns: geometry.columns(),
        rows: geometry.rows(),
        cell_m: f64::from(geometry.resolution_m()),
        corner_m: [f64::from(corner.x_m), f64::from(corner.y_m)],
        cells: loaded.values().to_vec(),
    })
}
