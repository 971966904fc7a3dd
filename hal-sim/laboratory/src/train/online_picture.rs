//! How precision and recall move while a robot learns in a new place, as a picture.

use std::path::Path;

use plotters::prelude::*;

use super::online::OnlineReport;
use floorguard_host::outcome::BadInput;

/// Writes the picture `online_PLACE.svg` into a folder, which is made where it is missing.
///
/// # Errors
/// The folder or the file cannot be written.
pub fn draw_online(folder: &Path, report: &OnlineReport) -> anyhow::Result<()> {
    let path = folder.join(format!("online_{}.svg", report.place));
    let bad = |problem: &dyn std::fmt::Display| BadInput(format!("{}: {problem}", path.display()));
    std::fs::create_dir_all(folder).map_err(|error| bad(&error))?;
    draw(&path, report).map_err(|error| bad(&error))?;
    Ok(())
}

fn draw(path: &Path, report: &OnlineReport) -> Result<(), Box<dyn std::error::Error>> {
    let end_s = report.windows.last().map_or(1.0, |window| window.until_s);
    let area = SVGBackend::new(path, (760, 440)).into_drawing_area();
    area.fill(&WHITE)?;
    let title = format!("{}, seed {}: grey shipped, colours learned", report.place, report.seed);
    let mut chart = ChartBuilder::on(&area)
        .caption(title, ("sans-serif", 16))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(48)
        .build_cartesian_2d(0.0..end_s, 0.0..1.0)?;
    chart.configure_mesh().x_desc("seconds").y_desc("precision blue, recall red").draw()?;
    for (classifier, figure, colour) in
        [(0, 0, RGBColor(150, 150, 190)), (0, 1, RGBColor(200, 150, 150)), (1, 0, BLUE), (1, 1, RED)]
    {
        let points =
            report.windows.iter().map(|window| (window.until_s, window.precision_recall[classifier][figure]));
        chart.draw_series(LineSeries::new(points, colour.stroke_width(2)))?;
    }
    area.present()?;
    Ok(())
}
