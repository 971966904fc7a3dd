//! Places of people in a file, as boxes that leave the map.

use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_mapping::people_removal::{RemovalBox, RemovalSize};
use floorguard_types::geometry::Point3;

use crate::files::text;

/// A box for each line; `floor_m` is the height of the floor in the map.
///
/// # Errors
/// The file cannot be read, or a line is not two numbers.
pub fn boxes(path: &Path, floor_m: f32) -> Result<Vec<RemovalBox>, BadInput> {
    let mut boxes = Vec::new();
    for (index, line) in text(path)?.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let numbers: Vec<f32> = line
            .split([' ', '\t', ',', ';'])
            .filter(|word| !word.is_empty())
            .map_while(|word| word.parse().ok().filter(|number: &f32| number.is_finite()))
            .collect();
        let [x_m, y_m, ..] = numbers[..] else {
            let what = "two numbers are expected, x and y in metres";
            return Err(BadInput(format!("{}: line {}: {what}", path.display(), index + 1)));
        };
        boxes.push(RemovalBox::around(Point3::new(x_m, y_m, floor_m), floor_m, RemovalSize::default()));
    }
    Ok(boxes)
}
