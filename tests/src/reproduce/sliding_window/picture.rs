//! Cells as coloured squares in a picture.

use std::path::Path;

use anyhow::anyhow;
use floorguard_mapping::sliding_window::{CellContent, Face, Plan, PlanCell, WindowPoint};
use floorguard_types::time::Stamp;
use plotters::prelude::*;

/// A square: middle and edge, metres, and its colour.
#[derive(Clone, Copy, Debug)]
pub struct Square {
    /// To the right.
    pub x: f64,
    /// Upwards.
    pub y: f64,
    /// Metres.
    pub edge: f64,
    /// Its colour.
    pub colour: RGBColor,
}

/// Draws squares on a plane in metres; `title` and `path` of the picture, and a line over them.
///
/// # Errors
/// A file that cannot be written.
pub fn draw(path: &Path, title: &str, squares: &[Square], line: &[(f64, f64)]) -> anyhow::Result<()> {
    draw_all(path, title, squares, line).map_err(|problem| anyhow!("{}: {problem}", path.display()))
}

fn draw_all(
    path: &Path,
    title: &str,
    squares: &[Square],
    line: &[(f64, f64)],
) -> Result<(), Box<dyn std::error::Error>> {
    let ends = |of: fn(&Square) -> f64| {
        let low = squares.iter().map(|one| of(one) - one.edge).fold(f64::INFINITY, f64::min);
        let high = squares.iter().map(|one| of(one) + one.edge).fold(f64::NEG_INFINITY, f64::max);
        if low < high { low..high } else { 0.0..1.0 }
    };
    let (wide, high) = (ends(|one| one.x), ends(|one| one.y));
    let height = (900.0 * (high.end - high.start) / (wide.end - wide.start)).clamp(200.0, 1_200.0) as u32;
    let area = SVGBackend::new(path, (980, height + 90)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(title, ("sans-serif", 18))
        .margin(8)
        .x_label_area_size(28)
        .y_label_area_size(40)
        .build_cartesian_2d(wide, high)?;
    chart.configure_mesh().x_desc("m").y_desc("m").draw()?;
    chart.draw_series(squares.iter().map(|one| {
        let half = 0.5 * one.edge;
        let corners = [(one.x - half, one.y - half), (one.x + half, one.y + half)];
        Rectangle::new(corners, one.colour.filled())
    }))?;
    chart.draw_series(LineSeries::new(line.iter().copied(), BLUE.stroke_width(2)))?;
    area.present()?;
    Ok(())
}

/// A grid as the robot sees it: near surfaces dark, far ones light, places of people red.
#[must_use]
pub fn face_squares(points: &[WindowPoint], face: Face, edge: f64) -> Vec<Square> {
    let columns = (6.2 / edge).round() as usize;
    let of_face = points.iter().filter(|one| one.face == face);
    of_face
        .map(|one| {
            let range = f64::from(one.point.x_m).hypot(f64::from(one.point.y_m));
            let grey = (60.0 * range).clamp(0.0, 230.0) as u8;
            let colour = match one.content {
                CellContent::Person => RGBColor(220, 40, 60),
                CellContent::Surface | CellContent::Empty => RGBColor(grey, grey, grey),
            };
            // Left of the robot is left in the picture.
            let x = 3.1 - ((one.index % columns) as f64 + 0.5) * edge;
            Square { x, y: ((one.index / columns) as f64 + 0.5) * edge, edge, colour }
        })
        .collect()
}

/// The plan: free white, what stands dark with its height, people red, unknown grey.
#[must_use]
pub fn plan_squares(plan: &Plan<Vec<PlanCell>>, now: Stamp) -> Vec<Square> {
    let geometry = *plan.grid().geometry();
    let square = |(index, cell): (usize, &PlanCell)| {
        let middle = geometry.centre(index);
        let colour = match cell.floor_m() {
            _ if cell.is_person(now) => RGBColor(220, 40, 60),
            None => RGBColor(200, 200, 200),
            Some(height) if height > 0.05 => {
                let grey = (120.0 - 100.0 * f64::from(height)).clamp(0.0, 120.0) as u8;
                RGBColor(grey, grey, grey)
            }
            Some(_) => RGBColor(250, 250, 250),
        };
        let edge = f64::from(geometry.resolution_m());
        Square { x: f64::from(middle.x_m), y: f64::from(middle.y_m), edge, colour }
    };
    plan.grid().values().iter().enumerate().map(square).collect()
}
