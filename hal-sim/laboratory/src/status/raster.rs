//! The maps of the report as pictures.

use floorguard_cleaning::Verdict;
use floorguard_mapping::Occupancy;
use floorguard_types::geometry::Point2;
use image::{ImageEncoder, Rgb, RgbImage};

use super::account::MissionStatus;

/// Pixels along the longer side, about.
const SIDE_PX: u32 = 1_200;

const WALL: Rgb<u8> = Rgb([45, 50, 58]);
const BEYOND: Rgb<u8> = Rgb([206, 210, 215]);
const FLOOR: Rgb<u8> = Rgb([250, 250, 248]);
const SWEPT: Rgb<u8> = Rgb([226, 236, 246]);
const CLEANED: Rgb<u8> = Rgb([86, 180, 150]);
const UNCERTAIN: Rgb<u8> = Rgb([240, 200, 60]);
const DIRTY: Rgb<u8> = Rgb([150, 75, 20]);
const LIGHT_DIRT: Rgb<u8> = Rgb([235, 190, 140]);

/// Which map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// Dirt as it was expected when the mission began.
    Before,
    /// What is promised at its end.
    After,
}

/// A colour of the map and what it means, for the legend.
pub const LEGEND: [(&str, Rgb<u8>); 7] = [
    ("dirty", DIRTY),
    ("a little dirt", LIGHT_DIRT),
    ("cleaned, promised", CLEANED),
    ("driven over", SWEPT),
    ("uncertain, not promised", UNCERTAIN),
    ("out of reach, not promised", BEYOND),
    ("wall", WALL),
];

/// The picture as PNG.
///
/// # Errors
/// None in practice: it is written to memory.
pub fn png(status: &MissionStatus, moment: Moment) -> anyhow::Result<Vec<u8>> {
    let picture = draw(status, moment);
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes).write_image(
        picture.as_raw(),
        picture.width(),
        picture.height(),
        image::ExtendedColorType::Rgb8,
    )?;
    Ok(bytes)
}

fn draw(status: &MissionStatus, moment: Moment) -> RgbImage {
    let cells = &status.floor.cells;
    let (wide, high) = (u32::from(cells.width()), u32::from(cells.height()));
    let scale = (SIDE_PX / wide.max(high)).clamp(1, 24);
    let step_m = cells.resolution_m() / scale as f32;
    let origin = cells.origin_in_map();
    let fine = status.floor.occupancy.geometry();
    let largest = status.expected.iter().fold(f32::from(status.tolerated_units), |a, b| a.max(*b)).max(1.0);
    let colours: Vec<Rgb<u8>> =
        (0..cells.cell_count()).map(|cell| colour(status, moment, cell, largest)).collect();
    RgbImage::from_fn(wide * scale, high * scale, |x, y| {
        let along = |pixel: u32| (pixel as f32 + 0.5) * step_m;
        let point = Point2::new(origin.x_m + along(x), origin.y_m + along(high * scale - 1 - y));
        let seen = fine.cell_at(point).and_then(|index| status.floor.occupancy.get(index)).copied();
        match (seen, cells.cell_at(point).and_then(|cell| colours.get(cell))) {
            (Some(Occupancy::Occupied), _) => WALL,
            (_, Some(colour)) => *colour,
            _ => BEYOND,
        }
    })
}

fn colour(status: &MissionStatus, moment: Moment, cell: usize, largest: f32) -> Rgb<u8> {
    let units = status.expected.get(cell).copied().unwrap_or(0.0);
    let dirt = || if units > 0.0 { mix(LIGHT_DIRT, DIRTY, (units / largest).sqrt()) } else { FLOOR };
    let answered = status.floor.reachable[cell];
    match (moment, status.result.verdicts.get(cell).copied().flatten()) {
        (Moment::Before, _) if answered || units > 0.0 => dirt(),
        (Moment::After, Some(Verdict::Clean)) if status.is_dirty[cell] => CLEANED,
        (Moment::After, Some(Verdict::Clean)) if status.is_swept[cell] => SWEPT,
        (Moment::After, Some(Verdict::Clean)) => FLOOR,
        (Moment::After, Some(Verdict::Uncertain)) => UNCERTAIN,
        (Moment::After, Some(Verdict::Dirty | Verdict::Active)) => DIRTY,
        (Moment::After, None) if status.is_dirty[cell] => DIRTY,
        _ => BEYOND,
    }
}

fn mix(Rgb(from): Rgb<u8>, Rgb(to): Rgb<u8>, share: f32) -> Rgb<u8> {
    let channel = |index: usize| {
        let (a, b) = (f32::from(from[index]), f32::from(to[index]));
        (a + share.clamp(0.0, 1.0) * (b - a)).round() as u8
    };
    Rgb([channel(0), channel(1), channel(2)])
}
