//! The pair of files that ROS's `map_server` and nav2 open: a grey picture (PGM) and its description (YAML).

use std::fmt::Write as _;

use floorguard_mapping::Occupancy;

use crate::grid_map::GridMap;

/// Grey of the three states, as `map_saver` writes them: with the thresholds below each is read as what it was.
const FREE: u8 = 254;
const UNKNOWN: u8 = 205;
const OCCUPIED: u8 = 0;

/// The picture: binary PGM, the first row is the top of the map.
#[must_use]
pub fn pgm(map: &GridMap) -> Vec<u8> {
    let mut bytes = format!("P5\n{} {}\n255\n", map.columns, map.rows).into_bytes();
    let grey = |cell: &Occupancy| match cell {
        Occupancy::Free => FREE,
        Occupancy::Unknown => UNKNOWN,
        Occupancy::Occupied => OCCUPIED,
    };
    for row in map.cells.chunks(map.columns.max(1)).rev() {
        bytes.extend(row.iter().map(grey));
    }
    bytes
}

/// The description of a picture that lies beside it.
#[must_use]
pub fn yaml(map: &GridMap, picture: &str) -> String {
    let mut text = String::new();
    let [x_m, y_m] = map.corner_m;
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "image: {picture}\nmode: trinary\nresolution: {:.6}\norigin: [{x_m:.6}, {y_m:.6}, 0.0]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196",
        map.cell_m
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn picture_begins_at_the_top() {
        use Occupancy::{Free, Occupied, Unknown};
        let cells = vec![Free, Occupied, Unknown, Free, Free, Free];
        let map = GridMap { columns: 3, rows: 2, cell_m: 0.05, corner_m: [-1.5, 2.0], cells };
        assert_eq!(pgm(&map), [&b"P5\n3 2\n255\n"[..], &[254, 254, 254, 254, 0, 205]].concat());
        let text = yaml(&map, "map.pgm");
        assert!(
            text.contains("origin: [-1.500000, 2.000000, 0.0]\n") && text.starts_with("image: map.pgm\n")
        );
    }
}
