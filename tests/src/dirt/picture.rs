//! Precision over recall, a panel for each floor.

use std::path::Path;

use anyhow::anyhow;
use floorguard_sim::floor::FloorKind;
use plotters::prelude::*;

use super::compare::Cell;

/// Writes the curves of all floors into one picture.
///
/// # Errors
/// The picture cannot be written.
pub fn draw(path: &Path, cells: &[Cell]) -> anyhow::Result<()> {
    draw_all(path, cells).map_err(|problem| anyhow!("{}: {problem}", path.display()))
}

fn draw_all(path: &Path, cells: &[Cell]) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::new(path, (1_080, 680)).into_drawing_area();
    area.fill(&WHITE)?;
    let area =
        area.titled("precision over recall, pixels: published (blue), ours (red)", ("sans-serif", 20))?;
    for (panel, floor) in area.split_evenly((2, 3)).iter().zip(FloorKind::ALL) {
        let mut chart = ChartBuilder::on(panel)
            .caption(floor.name(), ("sans-serif", 16))
            .margin(8)
            .x_label_area_size(28)
            .y_label_area_size(36)
            .build_cartesian_2d(0.0..1.0, 0.0..1.0)?;
        chart.configure_mesh().x_labels(6).y_labels(6).draw()?;
        for (method, colour) in [BLUE, RED].iter().enumerate() {
            let of_floor = cells.iter().filter(|cell| cell.floor == floor);
            let points: Vec<(f32, bool)> =
                of_floor.flat_map(|cell| cell.curves[method].iter().copied()).collect();
            chart.draw_series(LineSeries::new(precision_recall(points), colour.stroke_width(2)))?;
        }
    }
    area.present()?;
    Ok(())
}

/// Recall and precision for a hundred thresholds.
fn precision_recall(mut points: Vec<(f32, bool)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    let all = points.iter().filter(|(_, is_dirt)| *is_dirt).count().max(1);
    let (mut hits, mut curve) = (0_usize, Vec::new());
    for (index, (_, is_dirt)) in points.iter().enumerate() {
        hits += usize::from(*is_dirt);
        let recall = hits as f64 / all as f64;
        if *is_dirt && curve.last().is_none_or(|(last, _)| recall - last >= 0.01) {
            curve.push((recall, hits as f64 / (index + 1) as f64));
        }
    }
    curve
}
