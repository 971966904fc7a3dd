//! Maps and plots of missions as pictures.

use std::path::Path;

use floorguard_cleaning::Verdict;
use floorguard_types::geometry::Point2;
use image::{Rgb, RgbImage};
use plotters::prelude::*;

use super::outcome::TrialResult;
use floorguard_robot::site::Floor;

/// Pixels along the edge of a cell.
const SCALE: u32 = 8;

const WALL: Rgb<u8> = Rgb([40, 40, 40]);
const NOT_ANSWERED: Rgb<u8> = Rgb([205, 205, 205]);
const FLOOR: Rgb<u8> = Rgb([250, 250, 250]);
const CLAIMED: Rgb<u8> = Rgb([120, 195, 130]);
const DIRTY: Rgb<u8> = Rgb([200, 120, 50]);
const UNCERTAIN: Rgb<u8> = Rgb([235, 205, 80]);
const FALSE_CLAIM: Rgb<u8> = Rgb([220, 30, 60]);
const PATH: Rgb<u8> = Rgb([60, 90, 200]);

/// The map of a mission: claimed cells that had been dirty green, dirty ones brown, uncertain ones yellow, falsely
/// claimed ones red, floor that the mission does not answer for grey, the true path blue.
///
/// # Errors
/// The file cannot be written.
pub fn mission_map(
    path: &Path,
    floor: &Floor,
    result: &TrialResult,
    (expected, tolerated): (&[f32], u32),
) -> anyhow::Result<()> {
    let (wide, high) = (u32::from(floor.cells.width()), u32::from(floor.cells.height()));
    let mut picture = RgbImage::from_pixel(wide * SCALE, high * SCALE, NOT_ANSWERED);
    let fine = floor.occupancy.geometry();
    let top = high * SCALE;
    let cell_m = floor.cells.resolution_m();
    let origin = floor.cells.origin_in_map();
    for y in 0..top {
        for x in 0..wide * SCALE {
            let at = |n: u32| (n as f32 + 0.5) / SCALE as f32 * cell_m;
            let point = Point2::new(origin.x_m + at(x), origin.y_m + at(y));
            let Some(cell) = floor.cells.cell_at(point) else { continue };
            let is_wall = fine
                .cell_at(point)
                .and_then(|i| floor.occupancy.get(i))
                .is_some_and(|o| *o == floorguard_mapping::Occupancy::Occupied);
            let colour = if is_wall { WALL } else { colour_of(result, cell, (expected, tolerated)) };
            picture.put_pixel(x, top - 1 - y, colour);
        }
    }
    for pair in result.path.windows(2) {
        let steps = (pair[0].distance(pair[1]) / cell_m * SCALE as f32 * 2.0).ceil().max(1.0) as u32;
        for step in 0..=steps {
            let t = step as f32 / steps as f32;
            let x = pair[0].x_m + t * (pair[1].x_m - pair[0].x_m) - origin.x_m;
            let y = pair[0].y_m + t * (pair[1].y_m - pair[0].y_m) - origin.y_m;
            let (x, y) = ((x / cell_m * SCALE as f32) as u32, (y / cell_m * SCALE as f32) as u32);
            if x < wide * SCALE && y < top {
                picture.put_pixel(x, top - 1 - y, PATH);
            }
        }
    }
    picture.save(path)?;
    Ok(())
}

fn colour_of(result: &TrialResult, cell: usize, (expected, tolerated): (&[f32], u32)) -> Rgb<u8> {
    match result.verdicts.get(cell).copied().flatten() {
        None => NOT_ANSWERED,
        Some(Verdict::Dirty | Verdict::Active) => DIRTY,
        Some(Verdict::Uncertain) => UNCERTAIN,
        Some(Verdict::Clean) if result.left.get(cell).is_some_and(|&left| left > tolerated) => FALSE_CLAIM,
        Some(Verdict::Clean) if expected.get(cell).is_some_and(|&units| units > 0.0) => CLAIMED,
        Some(Verdict::Clean) => FLOOR,
    }
}

/// A named line of a plot.
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Points.
    pub points: Vec<(f64, f64)>,
}

/// A plot of lines with a legend.
///
/// # Errors
/// The file cannot be written.
pub fn line_plot(
    path: &Path,
    (title, x_name, y_name): (&str, &str, &str),
    series: &[Series],
) -> anyhow::Result<()> {
    let all = || series.iter().flat_map(|s| s.points.iter().copied());
    let x0 = all().map(|p| p.0).fold(f64::MAX, f64::min);
    let x1 = all().map(|p| p.0).fold(f64::MIN, f64::max);
    let y1 = all().map(|p| p.1).fold(0.0, f64::max);
    anyhow::ensure!(x0 <= x1, "{title}: nothing to plot");
    let area = SVGBackend::new(path, (720, 480)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(title, ("sans-serif", 20))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d(x0..x1 + 1e-9, 0.0..y1 * 1.05 + 1e-9)?;
    chart.configure_mesh().x_desc(x_name).y_desc(y_name).light_line_style(WHITE).draw()?;
    for (index, line) in series.iter().enumerate() {
        let colour = Palette99::pick(index).to_rgba();
        chart
            .draw_series(LineSeries::new(line.points.iter().copied(), colour.stroke_width(2)))?
            .label(line.name.clone())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2)));
    }
    chart.configure_series_labels().background_style(WHITE.mix(0.8)).border_style(BLACK).draw()?;
    area.present()?;
    Ok(())
}
