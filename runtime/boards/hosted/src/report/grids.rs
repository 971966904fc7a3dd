//! A recorded occupancy grid as SVG: cells of equal value in a row become one rectangle.

use std::fmt::Write;

use crate::recording::decode::Grid;

/// Shades between 0 and 100.
const SHADES: u8 = 6;

/// The picture; unknown cells are the background.
pub fn picture(grid: &Grid) -> String {
    let (width, height) = (grid.width, grid.height);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" shape-rendering=\"crispEdges\" \
         role=\"img\"><rect width=\"100%\" height=\"100%\" fill=\"#b8c4cf\"/>"
    );
    for shade in 0..SHADES {
        let mut path = String::new();
        for (row, cells) in grid.cells.chunks(width.max(1)).enumerate() {
            runs(&mut path, (row, height), cells, shade);
        }
        let light = 255 - u32::from(shade) * 40;
        let _ = write!(svg, "<path d=\"{path}\" fill=\"rgb({light} {light} {light})\"/>");
    }
    svg + "</svg>"
}

fn shade_of(cell: i8) -> Option<u8> {
    u8::try_from(cell).ok().map(|value| value.min(100) * (SHADES - 1) / 100)
}

fn runs(path: &mut String, (row, height): (usize, usize), cells: &[i8], shade: u8) {
    let mut begun = None;
    for column in 0..=cells.len() {
        let inside = cells.get(column).and_then(|cell| shade_of(*cell)) == Some(shade);
        match (inside, begun) {
            (true, None) => begun = Some(column),
            (false, Some(from)) => {
                let wide = column - from;
                let _ = write!(path, "M{from} {}h{wide}v1h-{wide}z", height - 1 - row);
                begun = None;
            }
            _ => {}
        }
    }
}
