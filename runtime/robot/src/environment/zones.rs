//! Parts of the floor that have a name.

use std::path::Path;

use anyhow::{Context, bail, ensure};
use floorguard_mapping::GridGeometry;
use floorguard_types::geometry::Point2;
use serde::Deserialize;

/// Places along the side of a tile: 8 m.
const TILE_PLACES: i32 = 4;
/// Corners of a zone at most.
const CORNERS_MAX: usize = 64;

/// A zone.
#[derive(Clone, Debug, PartialEq)]
pub struct Zone {
    /// Name.
    pub name: String,
    /// Corners in the map frame, in order.
    pub corners: Vec<Point2>,
    /// Never to be cleaned wet: a wooden floor, a ramp.
    pub is_always_dry: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ZoneFile {
    zone: Vec<ZoneEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ZoneEntry {
    name: String,
    corners_m: Vec<[f32; 2]>,
    #[serde(default)]
    always_dry: bool,
}

/// Reads zones: `[[zone]]` with `name`, `corners_m = [[x, y], …]` and, where it is so, `always_dry = true`.
///
/// # Errors
/// A file that cannot be read, or an invalid zone.
pub fn read_zones(path: &Path) -> anyhow::Result<Vec<Zone>> {
    let text =
        std::fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    let file: ZoneFile = toml::from_str(&text).with_context(|| format!("{}", path.display()))?;
    file.zone
        .into_iter()
        .map(|entry| {
            let corners = entry.corners_m.iter().map(|[x_m, y_m]| Point2::new(*x_m, *y_m)).collect();
            Zone::new(entry.name, corners, entry.always_dry).with_context(|| format!("{}", path.display()))
        })
        .collect()
}

impl Zone {
    /// A zone from its corners.
    ///
    /// # Errors
    /// Fewer than three or too many corners, non-finite numbers, no name.
    pub fn new(name: String, corners: Vec<Point2>, is_always_dry: bool) -> anyhow::Result<Self> {
        ensure!(!name.trim().is_empty() && name.len() <= 80, "a zone needs a name of up to 80 bytes");
        let count = corners.len();
        ensure!(
            (3..=CORNERS_MAX).contains(&count),
            "zone {name}: {count} corners; 3 to {CORNERS_MAX} make a zone"
        );
        let all_finite = corners.iter().all(|corner| corner.x_m.is_finite() && corner.y_m.is_finite());
        ensure!(all_finite, "zone {name}: a corner is not a number");
        Ok(Self { name, corners, is_always_dry })
    }

    /// `NAME=X0,Y0,X1,Y1`: a rectangle, or a name alone among `known`.
    ///
    /// # Errors
    /// Neither.
    pub fn parse(text: &str, known: &[Self]) -> anyhow::Result<Self> {
        if let Some(zone) = known.iter().find(|zone| zone.name.eq_ignore_ascii_case(text)) {
            return Ok(zone.clone());
        }
        let Some((name, numbers)) = text.split_once('=') else {
            let names: Vec<&str> = known.iter().map(|zone| zone.name.as_str()).collect();
            bail!(
                "there is no zone '{text}'; there are: {}; or write NAME=X0,Y0,X1,Y1 in metres",
                names.join(", ")
            );
        };
        let numbers: Vec<f32> = numbers.split(',').filter_map(|number| number.trim().parse().ok()).collect();
        let [x0, y0, x1, y1] = numbers.as_slice() else {
            bail!("zone '{text}': write NAME=X0,Y0,X1,Y1 in metres");
        };
        let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x_m, y_m)| Point2::new(*x_m, *y_m));
        Self::new(name.to_owned(), corners.to_vec(), false)
    }

    /// The raster in tiles.
    #[must_use]
    pub fn tiles(places: &GridGeometry) -> Vec<Self> {
        let tiles = |side: u16| (i32::from(side) + TILE_PLACES - 1) / TILE_PLACES;
        let origin = places.origin_in_map();
        let edge_m = places.resolution_m();
        let at = |column: i32, row: i32| {
            let limited = |value: i32, side: u16| value.min(i32::from(side)) as f32 * edge_m;
            Point2::new(
                origin.x_m + limited(column, places.width()),
                origin.y_m + limited(row, places.height()),
            )
        };
        let mut all = Vec::new();
        for row in 0..tiles(places.height()) {
            for column in 0..tiles(places.width()) {
                let (x0, y0) = (column * TILE_PLACES, row * TILE_PLACES);
                let (x1, y1) = (x0 + TILE_PLACES, y0 + TILE_PLACES);
                let corners = vec![at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)];
                all.push(Self {
                    name: format!("{}{}", letters(column), row + 1),
                    corners,
                    is_always_dry: false,
                });
            }
        }
        all
    }

    /// The point lies inside, by the even-odd rule (book, Conventions: Point in polygon).
    #[must_use]
    pub fn contains(&self, point: Point2) -> bool {
        let mut inside = false;
        let mut previous = self.corners.last().copied().unwrap_or_default();
        for &corner in &self.corners {
            let crosses = (corner.y_m > point.y_m) != (previous.y_m > point.y_m);
            if crosses {
                let share = (point.y_m - corner.y_m) / (previous.y_m - corner.y_m);
                inside ^= point.x_m < corner.x_m + share * (previous.x_m - corner.x_m);
            }
            previous = corner;
        }
        inside
    }

    /// Mean of the corners.
    #[must_use]
    pub fn middle(&self) -> Point2 {
        let count = self.corners.len().max(1) as f32;
        let sum = |value: fn(&Point2) -> f32| self.corners.iter().map(value).sum::<f32>() / count;
        Point2::new(sum(|corner| corner.x_m), sum(|corner| corner.y_m))
    }

    /// Area, m².
    #[must_use]
    pub fn area_m2(&self) -> f32 {
        let mut previous = self.corners.last().copied().unwrap_or_default();
        let mut twice = 0.0;
        for &corner in &self.corners {
            twice += previous.x_m * corner.y_m - corner.x_m * previous.y_m;
            previous = corner;
        }
        0.5 * twice.abs()
    }
}

/// A, B, … Z, AA, AB …
fn letters(column: i32) -> String {
    let letter = |value: i32| char::from(b'A' + (value % 26) as u8);
    if column < 26 {
        letter(column).to_string()
    } else {
        format!("{}{}", letter(column / 26 - 1), letter(column))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_a_name_and_tiles() {
        let shop = Zone::parse("shop=0,0,4,2", &[]).unwrap();
        assert_eq!((shop.area_m2(), shop.middle()), (8.0, Point2::new(2.0, 1.0)));
        assert!(shop.contains(Point2::new(3.9, 0.1)) && !shop.contains(Point2::new(4.1, 0.1)));
        assert_eq!(Zone::parse("SHOP", std::slice::from_ref(&shop)).unwrap(), shop);
        let unknown = Zone::parse("bar", &[shop]).unwrap_err().to_string();
        assert!(unknown.contains("shop"), "{unknown}");
        let places = GridGeometry::new(110, 5, 2.0, Point2::new(-3.0, 0.0)).unwrap();
        let tiles = Zone::tiles(&places);
        assert_eq!((tiles.len(), tiles[0].name.as_str(), tiles[27].name.as_str()), (56, "A1", "AB1"));
        assert_eq!(tiles[55].area_m2(), 8.0);
        for wrong in ["x=1,2,3", "x=", "=0,0,1,1", "x=0,0,nan,1"] {
            assert!(Zone::parse(wrong, &[]).is_err(), "{wrong}");
        }
    }
}
