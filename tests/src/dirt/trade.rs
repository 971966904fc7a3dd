//! Spills found over spots invented, while the limit of the map is moved: what the one costs of the other.

use std::path::Path;

use anyhow::anyhow;
use plotters::prelude::*;

use super::passes::{OFFSETS, Pass};

/// The picture ends here, false spots per 100 m².
const RATE_MAX: f64 = 12.0;
/// What this stage must reach.
const AIM: (f64, f64) = (1.0, 0.9);

/// Part of the spills found, and spots invented per 100 m², for each of the offsets, over all floors.
pub fn curve(floors: &[Pass]) -> Vec<(f64, f64)> {
    let area_m2: f64 = floors.iter().map(|pass| f64::from(pass.area_m2)).sum();
    let spills: u32 = floors.iter().flat_map(|pass| pass.found.iter().map(|(_, _, all)| all)).sum();
    let at = |index: usize| {
        let counts = floors.iter().filter_map(|pass| pass.trade.get(index));
        let (hits, invented) = counts.fold((0, 0), |sum, (hits, more)| (sum.0 + hits, sum.1 + more));
        (f64::from(hits) / f64::from(spills.max(1)), 100.0 * f64::from(invented) / area_m2.max(1e-9))
    };
    (0..OFFSETS.len()).map(at).collect()
}

/// Writes a curve for each floor and one for all, with the map's own limit as a dot and the aim as a box.
///
/// # Errors
/// The picture cannot be written.
pub fn draw(path: &Path, floors: &[Pass]) -> anyhow::Result<()> {
    draw_all(path, floors).map_err(|problem| anyhow!("{}: {problem}", path.display()))
}

fn draw_all(path: &Path, floors: &[Pass]) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::new(path, (860, 560)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption("map of seen dirt: spills found over spots invented, as the limit moves", ("sans-serif", 18))
        .margin(10)
        .x_label_area_size(40)
        .y_label_area_size(48)
        .build_cartesian_2d(-0.2..RATE_MAX, 0.0..1.02)?;
    chart
        .configure_mesh()
        .x_desc("false spots per 100 m² (dot: the map's own limit; green: the aim)")
        .y_desc("part of the spills found")
        .draw()?;
    chart.draw_series([Rectangle::new([(0.0, AIM.1), (AIM.0, 1.0)], GREEN.mix(0.2).filled())])?;
    let own = OFFSETS.iter().position(|offset| *offset == 0.0).unwrap_or(0);
    let mut lines: Vec<(String, Vec<(f64, f64)>)> =
        floors.iter().map(|pass| (pass.floor.name().to_owned(), curve(std::slice::from_ref(pass)))).collect();
    lines.push(("all".to_owned(), curve(floors)));
    for (index, (name, line)) in lines.into_iter().enumerate() {
        let is_all = index == floors.len();
        let colour = if is_all { BLACK.to_rgba() } else { Palette99::pick(index).to_rgba() };
        let points: Vec<(f64, f64)> = line.iter().map(|(found, rate)| (rate.min(RATE_MAX), *found)).collect();
        let style = colour.stroke_width(if is_all { 3 } else { 1 });
        chart
            .draw_series(LineSeries::new(points.iter().copied(), style))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
        chart.draw_series(points.get(own).map(|place| Circle::new(*place, 4, colour.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE.mix(0.8))
        .draw()?;
    area.present()?;
    Ok(())
}
