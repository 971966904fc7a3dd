//! Heat maps as pictures: from dark blue over red to yellow; grey is unobserved.

use std::path::Path;

use anyhow::Context;
use floorguard_mapping::environment::{HeatCell, HourCount};
use image::{Rgb, RgbImage};

use super::model::Model;
use super::question::WeekHours;

/// Pixels along the longer side, about.
const SIDE_PX: u32 = 1_000;
const UNSEEN: Rgb<u8> = Rgb([200, 200, 200]);

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// How many tracks passed a cell.
    Trajectories,
    /// How long people were there.
    Presence,
}

/// Colours from nothing to the largest value: black over blue, red and orange to white, in even steps of lightness.
const RAMP: [[u8; 3]; 6] =
    [[13, 8, 60], [75, 15, 110], [150, 40, 110], [215, 80, 65], [250, 150, 30], [252, 250, 160]];

fn colour(value: f32) -> Rgb<u8> {
    let place = value.clamp(0.0, 1.0) * (RAMP.len() - 1) as f32;
    let index = (place as usize).min(RAMP.len() - 2);
    let share = place - index as f32;
    let mix = |channel: usize| {
        let (a, b) = (f32::from(RAMP[index][channel]), f32::from(RAMP[index + 1][channel]));
        (a + share * (b - a)).round() as u8
    };
    Rgb([mix(0), mix(1), mix(2)])
}

/// One value a cell: `None` for an unobserved cell; in all hours, or in some.
#[must_use]
pub fn values(model: &Model, layer: Layer, hours: Option<&WeekHours>) -> Vec<Option<f32>> {
    let heat = &model.core.heat;
    let of_cell = |cell: &HeatCell| HourCount { visits: cell.visits, dwell_cs: cell.dwell_cs };
    let mut counts: Vec<HourCount> = heat.cells().values().iter().map(of_cell).collect();
    if let Some(hours) = hours {
        counts.fill(HourCount::default());
        heat.of_hours(&mut counts, |hour| hours.contains(hour));
    }
    let value = |HourCount { visits, dwell_cs }: HourCount| match layer {
        Layer::Trajectories => visits as f32,
        Layer::Presence => dwell_cs as f32 / 100.0,
    };
    let watched = heat.cells().values().iter().map(|cell| cell.watched_cs > 0 || cell.visits > 0);
    counts.iter().zip(watched).map(|(count, watched)| watched.then(|| value(*count))).collect()
}

/// The picture. Values are shown by their square root, or one busy door would hide every path.
#[must_use]
pub fn draw(model: &Model, values: &[Option<f32>]) -> RgbImage {
    let geometry = model.core.heat.cells().geometry();
    let (wide, high) = (u32::from(geometry.width()), u32::from(geometry.height()));
    let scale = (SIDE_PX / wide.max(high)).max(1);
    let largest = values.iter().flatten().fold(0.0_f32, |a, b| a.max(*b));
    let mut picture = RgbImage::from_pixel(wide * scale, high * scale, UNSEEN);
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        let (column, row) = ((x / scale) as i32, (high - 1 - y / scale) as i32);
        let value = geometry.index(column, row).and_then(|index| values.get(index).copied().flatten());
        if let Some(value) = value {
            *pixel = colour(if largest > 0.0 { (value / largest).sqrt() } else { 0.0 });
        }
    }
    picture
}

/// Writes a heat map.
///
/// # Errors
/// The file cannot be written.
pub fn write(path: &Path, model: &Model, layer: Layer, hours: Option<&WeekHours>) -> anyhow::Result<()> {
    draw(model, &values(model, layer, hours))
        .save(path)
        .with_context(|| format!("{}: cannot be written", path.display()))
}
