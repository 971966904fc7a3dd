//! Keys of depth pictures: who stood where.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_types::geometry::Point2;

use floorguard_host::outcome::BadInput;
use floorguard_robot::picture_files::read_text;

/// People by the name of the picture.
#[derive(Clone, Debug, Default)]
pub(super) struct KeyedPeople {
    /// Metres before and left of the camera's foot point.
    pub(super) places: BTreeMap<String, Vec<Point2>>,
}

/// Reads columns `file`, `x`, `y` in any order, named in the first line; more columns are fine.
pub(super) fn read_key(path: &Path) -> anyhow::Result<KeyedPeople> {
    let text = read_text(path)?;
    let bad = |line: usize, problem: &str| BadInput(format!("{}, line {line}: {problem}", path.display()));
    let mut lines = text.lines().enumerate();
    let (_, names) = lines.next().ok_or_else(|| bad(1, "the key is empty"))?;
    let column = |wanted: &str| names.split(',').position(|name| name.trim() == wanted);
    let (Some(file), Some(x), Some(y)) = (column("file"), column("x"), column("y")) else {
        return Err(bad(1, "expected columns `file`, `x` and `y`").into());
    };
    let mut key = KeyedPeople::default();
    for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |column: usize| cells.get(column).and_then(|cell| cell.parse::<f32>().ok());
        let name = cells.get(file).and_then(|name| Path::new(name).file_name());
        let (Some(name), Some(x_m), Some(y_m)) = (name, number(x), number(y)) else {
            return Err(bad(index + 1, "a picture and two numbers, metres ahead and to the left").into());
        };
        key.places.entry(name.to_string_lossy().into_owned()).or_default().push(Point2 { x_m, y_m });
    }
    Ok(key)
}
