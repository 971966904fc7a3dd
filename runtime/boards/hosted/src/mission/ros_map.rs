//! Reads a ROS `map_server` map: a YAML file beside a picture (PNG or PGM).

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use floorguard_core::geometry::Point2;
use floorguard_core::maps::{Grid, GridGeometry, Occupancy};

/// An occupancy map in memory.
pub type OccupancyMap = Grid<Occupancy, Vec<Occupancy>>;

/// The fields of the YAML file that matter here.
#[derive(Debug, PartialEq)]
struct Description {
    image: PathBuf,
    resolution_m: f32,
    origin: [f32; 3],
    negate: bool,
    occupied_threshold: f32,
    free_threshold: f32,
}

/// Loads a map. A bare picture is taken as 0.05 m a pixel with the usual thresholds.
///
/// # Errors
/// A file that cannot be read, a field that is missing or out of range, a map turned against the axes.
pub fn load(path: &Path) -> anyhow::Result<OccupancyMap> {
    let is_yaml = path.extension().is_some_and(|e| e == "yaml" || e == "yml");
    let description = if is_yaml {
        let text =
            std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        describe(&text).with_context(|| format!("in {}", path.display()))?
    } else {
        bare(path)
    };
    let picture_path = path.parent().unwrap_or(Path::new(".")).join(&description.image);
    let picture = image::open(&picture_path)
        .with_context(|| format!("cannot read the picture {}", picture_path.display()))?
        .into_luma8();
    convert(&description, &picture)
}

fn bare(path: &Path) -> Description {
    Description {
        image: path.file_name().map(PathBuf::from).unwrap_or_default(),
        resolution_m: 0.05,
        origin: [0.0; 3],
        negate: false,
        occupied_threshold: 0.65,
        free_threshold: 0.196,
    }
}

/// The subset of YAML that `map_server` writes: one `key: value` a line, a list in brackets.
fn describe(text: &str) -> anyhow::Result<Description> {
    let value = |key: &str| {
        text.lines()
            .filter_map(|line| line.split_once(':'))
            .find(|(name, _)| name.trim() == key)
            .map(|(_, value)| value.split(" #").next().unwrap_or("").trim().trim_matches(['"', '\'']))
    };
    let number = |key: &str, default: Option<f32>| match value(key) {
        Some(text) => text.parse::<f32>().with_context(|| format!("{key} is not a number: {text}")),
        None => default.with_context(|| format!("{key} is missing")),
    };
    let origin = value("origin").context("origin is missing")?.trim_matches(['[', ']']);
    let origin: Vec<f32> = origin
        .split(',')
        .map(|n| n.trim().parse().with_context(|| format!("origin: {n} is not a number")))
        .collect::<anyhow::Result<_>>()?;
    let origin: [f32; 3] = origin.try_into().ok().context("origin needs three numbers")?;
    if origin[2].abs() > 1e-6 {
        bail!("origin turns the map by {} rad; only maps along the axes are supported", origin[2]);
    }
    Ok(Description {
        image: PathBuf::from(value("image").context("image is missing")?),
        resolution_m: number("resolution", None)?,
        origin,
        negate: number("negate", Some(0.0))? != 0.0,
        occupied_threshold: number("occupied_thresh", Some(0.65))?,
        free_threshold: number("free_thresh", Some(0.196))?,
    })
}

fn convert(description: &Description, picture: &image::GrayImage) -> anyhow::Result<OccupancyMap> {
    let (width, height) = picture.dimensions();
    let side = |n: u32| u16::try_from(n).with_context(|| format!("the picture is {width} × {height} pixels"));
    let origin = Point2::new(description.origin[0], description.origin[1]);
    let geometry = GridGeometry::new(side(width)?, side(height)?, description.resolution_m, origin)
        .with_context(|| format!("a resolution of {} m makes no map", description.resolution_m))?;
    let mut cells = Vec::with_capacity(geometry.cell_count());
    // The picture's first row is the top of the map.
    for row in (0..height).rev() {
        for column in 0..width {
            let grey = f32::from(picture.get_pixel(column, row).0[0]) / 255.0;
            let probability = if description.negate { grey } else { 1.0 - grey };
            cells.push(Occupancy::from_probability(
                probability,
                description.free_threshold,
                description.occupied_threshold,
            ));
        }
    }
    Ok(Grid::new(geometry, cells)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "image: \"a.pgm\"\nresolution: 0.1 # metres\norigin: [-1.0, 2.5, 0.0]\nnegate: 0\n";

    #[test]
    fn reads_the_fields_and_turns_the_picture_the_right_way_up() {
        let description = describe(TEXT).unwrap();
        assert_eq!(description.image, PathBuf::from("a.pgm"));
        let mut picture = image::GrayImage::from_pixel(3, 2, image::Luma([254]));
        picture.put_pixel(0, 0, image::Luma([0]));
        picture.put_pixel(2, 1, image::Luma([205]));
        let map = convert(&description, &picture).unwrap();
        let state = |x, y| *map.get(map.geometry().cell_at(Point2::new(x, y)).unwrap()).unwrap();
        assert_eq!(state(-0.95, 2.65), Occupancy::Occupied);
        assert_eq!(state(-0.95, 2.55), Occupancy::Free);
        assert_eq!(state(-0.75, 2.55), Occupancy::Unknown);
    }

    #[test]
    fn says_what_is_wrong() {
        let missing = describe("image: a.png\norigin: [0,0,0]").unwrap_err();
        assert!(format!("{missing:#}").contains("resolution is missing"));
        assert!(describe("image: a.png\nresolution: 0.1\norigin: [0,0,0.5]").is_err());
    }
}
