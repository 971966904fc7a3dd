//! A recorded occupancy grid as SVG: cells of equal value in a row become one rectangle.

use std::fmt::Write;

use floorguard_recording::decode::Grid;

use crate::words::Language;

/// Shades between 0 and 100.
const SHADES: u8 = 6;

/// What the numbers of a grid mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// 0 free, 100 occupied.
    Occupied,
    /// 0 none, 100 most.
    Dirt,
    /// 0 to do, 20 assumed clean, 50 uncertain, 100 cleaned.
    State,
}

impl Scale {
    fn colour(self, shade: u8) -> String {
        let steps = u32::from(shade);
        match self {
            Self::Occupied => {
                let light = 255 - steps * 40;
                format!("rgb({light} {light} {light})")
            }
            Self::Dirt => format!("rgb({} {} {})", 255 - steps * 30, 255 - steps * 42, 255 - steps * 48),
            Self::State => ["#fff", "#8ab6d6", "#f2c14e", "#f2c14e", "#f2c14e"]
                .get(usize::from(shade))
                .map_or("#7fb77e", |colour| colour)
                .to_owned(),
        }
    }
}

/// Rows from below, and what is known of them: first and last column, first and last row, the last ones exclusive.
fn known(grid: &Grid) -> (Vec<&[i8]>, [usize; 4]) {
    let rows: Vec<&[i8]> = grid.cells.chunks(grid.width.max(1)).collect();
    let any = |cells: &&[i8]| cells.iter().any(|cell| *cell >= 0);
    let bottom = rows.iter().position(any).unwrap_or(0);
    let top = rows.iter().rposition(any).map_or(grid.height, |row| row + 1);
    let column = |index: usize| rows.iter().any(|cells| cells.get(index).is_some_and(|cell| *cell >= 0));
    let left = (0..grid.width).find(|index| column(*index)).unwrap_or(0);
    let right = (0..grid.width).rev().find(|index| column(*index)).map_or(grid.width, |index| index + 1);
    (rows, [left, right, bottom, top])
}

/// How large the floor of the picture is.
pub fn size(grid: &Grid, language: Language) -> String {
    let (_, [left, right, bottom, top]) = known(grid);
    let metres = |cells: usize| language.number(f64::from(cells as f32 * grid.resolution_m), 1);
    format!("{} m × {} m.", metres(right - left), metres(top - bottom))
}

/// The picture, cut to what is known; unknown cells are the background.
pub fn picture(grid: &Grid, scale: Scale, language: Language) -> String {
    let (rows, [left, right, bottom, top]) = known(grid);
    // A cell more on each side, so that the edge is seen to be one.
    let (width, height) = (right - left + 2, top - bottom + 2);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" shape-rendering=\"crispEdges\" \
         role=\"img\" aria-label=\"{}\"><rect width=\"100%\" height=\"100%\" fill=\"#b8c4cf\"/>",
        language.say("floor in cells")
    );
    for shade in 0..SHADES {
        let mut path = String::new();
        for (row, cells) in (0..).zip(rows.get(bottom..top).unwrap_or_default()) {
            let cells = cells.get(left..right).unwrap_or_default();
            runs(&mut path, height - 2 - row, cells, shade);
        }
        if !path.is_empty() {
            let _ = write!(svg, "<path d=\"{path}\" fill=\"{}\"/>", scale.colour(shade));
        }
    }
    svg + "</svg>"
}

fn shade_of(cell: i8) -> Option<u8> {
    let shade = |value: u8| (u16::from(value.min(100)) * u16::from(SHADES - 1) / 100) as u8;
    u8::try_from(cell).ok().map(shade)
}

/// Cells of one shade in a row that is drawn so far from the top.
fn runs(path: &mut String, from_top: usize, cells: &[i8], shade: u8) {
    let mut begun = None;
    for column in 0..=cells.len() {
        let inside = cells.get(column).and_then(|cell| shade_of(*cell)) == Some(shade);
        match (inside, begun) {
            (true, None) => begun = Some(column),
            (false, Some(from)) => {
                let wide = column - from;
                let _ = write!(path, "M{} {from_top}h{wide}v1h-{wide}z", from + 1);
                begun = None;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use floorguard_types::geometry::Pose2;
    use floorguard_types::time::Stamp;

    use super::*;
    use floorguard_recording::decode::Header;

    #[test]
    fn a_picture_is_cut_to_what_is_known() {
        let mut cells = vec![-1; 100];
        cells[42] = 100;
        cells[43] = 100;
        let header = Header { stamp: Stamp::ZERO, frame: "map".to_owned() };
        let grid = Grid { header, resolution_m: 0.1, width: 10, height: 10, origin: Pose2::default(), cells };
        let svg = picture(&grid, Scale::State, Language::English);
        assert!(svg.contains("viewBox=\"0 0 4 3\"") && svg.contains("M1 1h2v1h-2z"), "{svg}");
        assert!(svg.contains("#7fb77e"), "{svg}");
    }
}
