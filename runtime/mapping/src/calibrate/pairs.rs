//! Points that were picked in the lidar's cloud and in the picture.

use nalgebra::{Vector2, Vector3};

/// One point, seen by both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PickedPair {
    /// In the lidar's frame, metres.
    pub point_in_lidar: Vector3<f64>,
    /// In the picture, pixels.
    pub pixel: Vector2<f64>,
}

/// A line that is no pair.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "line {line}: five numbers are expected (x y z in metres in the lidar's frame, column and row in pixels)"
)]
pub struct PickedPairsError {
    /// Number of the line, from 1.
    pub line: usize,
}

/// Reads pairs: `x,y,z,column,row` a line, separated by commas, semicolons or blanks. Empty lines, comments (`#`) and one
/// line of names at the beginning are left out.
///
/// ```
/// use floorguard_mapping_host::calibrate::read_pairs;
///
/// let pairs = read_pairs("x,y,z,column,row\n# the corner of the door\n3.1,0.4,-0.2,512.5,300\n").unwrap();
/// assert_eq!((pairs.len(), pairs[0].pixel.x), (1, 512.5));
/// assert_eq!(read_pairs("3.1,0.4\n").unwrap_err().line, 1);
/// ```
///
/// # Errors
/// A line has other than five numbers, or one that is not finite.
pub fn read_pairs(text: &str) -> Result<Vec<PickedPair>, PickedPairsError> {
    let mut pairs = Vec::new();
    let mut is_first = true;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let words: Vec<&str> =
            line.split([',', ';', ' ', '\t']).map(str::trim).filter(|word| !word.is_empty()).collect();
        let is_names = std::mem::take(&mut is_first) && words.iter().all(|word| word.parse::<f64>().is_err());
        if is_names {
            continue;
        }
        let numbers: Vec<f64> = words
            .iter()
            .filter_map(|word| word.parse().ok())
            .filter(|number: &f64| number.is_finite())
            .collect();
        let [x, y, z, column, row] = numbers[..] else { return Err(PickedPairsError { line: index + 1 }) };
        if words.len() != 5 {
            return Err(PickedPairsError { line: index + 1 });
        }
        let (point_in_lidar, pixel) = (Vector3::new(x, y, z), Vector2::new(column, row));
        pairs.push(PickedPair { point_in_lidar, pixel });
    }
    Ok(pairs)
}
