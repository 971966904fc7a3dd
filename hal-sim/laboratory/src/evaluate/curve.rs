//! The curve of precision over recall as a picture.

use std::path::Path;

use plotters::prelude::*;

use super::legs::LegsReport;
use floorguard_host::outcome::BadInput;

/// Name of the picture in its folder.
const FILE: &str = "legs_precision_recall.svg";

/// Writes the curve of a report into a folder, which is made where it is missing.
///
/// # Errors
/// The folder or the file cannot be written.
pub fn draw_legs(folder: &Path, report: &LegsReport) -> anyhow::Result<()> {
    let path = folder.join(FILE);
    let bad = |problem: &dyn std::fmt::Display| BadInput(format!("{}: {problem}", path.display()));
    std::fs::create_dir_all(folder).map_err(|error| bad(&error))?;
    draw(&path, report).map_err(|error| bad(&error))?;
    Ok(())
}

fn draw(path: &Path, report: &LegsReport) -> Result<(), Box<dyn std::error::Error>> {
    let title = format!("legs: F1 {:.3}, average precision {:.3}", report.f1, report.average_precision);
    let area = SVGBackend::new(path, (640, 480)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(48)
        .build_cartesian_2d(0.0..1.0, 0.0..1.0)?;
    chart.configure_mesh().x_desc("recall").y_desc("precision").draw()?;
    chart.draw_series(LineSeries::new(report.curve.iter().copied(), BLUE.stroke_width(2)))?;
    let chosen = [(report.recall, report.precision)];
    chart.draw_series(chosen.map(|point| Circle::new(point, 5, RED.filled())))?;
    area.present()?;
    Ok(())
}
