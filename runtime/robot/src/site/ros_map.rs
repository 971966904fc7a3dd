//! Reads a ROS `map_server` map: a YAML file beside a picture (PNG or PGM), in each of its three modes.
//!
//! A map whose origin is turned is drawn anew along the axes of the map frame, so that places in metres mean the same as to
//! ROS. Where its pixels meet those of the new raster, the worse of them counts: no wall gets a hole.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use floorguard_mapping::{Grid, GridGeometry, Occupancy};
use floorguard_types::geometry::{Point2, Pose2};

/// An occupancy map in memory.
pub type OccupancyMap = Grid<Occupancy, Vec<Occupancy>>;

/// Pixels coarser than this show no walls that a robot could find itself by, metres.
const PIXEL_MAX_M: f32 = 0.5;
/// An origin turned by less is not turned, radians.
const TURNED_RAD: f32 = 1.0e-6;

/// What the grey of a pixel means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    /// Free, occupied, or unknown in between; `scale` keeps what lies in between, which is neither for us.
    Grey,
    /// The number is the occupancy in percent; above 100 nothing is known.
    Raw,
}

/// The fields of the YAML file that matter here.
#[derive(Debug, PartialEq)]
struct Description {
    image: PathBuf,
    resolution_m: f32,
    origin: [f32; 3],
    negate: bool,
    mode: Mode,
    occupied_threshold: f32,
    free_threshold: f32,
}

/// Loads a map. A bare picture is taken as 0.05 m a pixel with the usual thresholds.
///
/// # Errors
/// A file that cannot be read, a field that is missing or out of range.
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
        .into_luma_alpha8();
    let map = convert(&description, &picture)?;
    let yaw_rad = description.origin[2];
    if yaw_rad.abs() > TURNED_RAD { along_the_axes(&map, yaw_rad) } else { Ok(map) }
}

fn bare(path: &Path) -> Description {
    Description {
        image: path.file_name().map(PathBuf::from).unwrap_or_default(),
        resolution_m: 0.05,
        origin: [0.0; 3],
        negate: false,
        mode: Mode::Grey,
        occupied_threshold: 0.65,
        free_threshold: 0.196,
    }
}

/// The subset of YAML that `map_server` and its relatives write: one `key: value` a line, a list in brackets or one item a
/// line.
fn describe(text: &str) -> anyhow::Result<Description> {
    let number = |key: &str, default: Option<f32>| match value(text, key) {
        Some(text) => {
            let number = text.parse::<f32>().ok().filter(|number| number.is_finite());
            number.with_context(|| format!("{key} is not a number: {text}"))
        }
        None => default.with_context(|| format!("{key} is missing")),
    };
    let resolution_m = number("resolution", None)?;
    ensure!(
        resolution_m > 0.0 && resolution_m <= PIXEL_MAX_M,
        "resolution: {resolution_m} m a pixel; a map for cleaning has up to {PIXEL_MAX_M} m"
    );
    let (free, occupied) = (number("free_thresh", Some(0.196))?, number("occupied_thresh", Some(0.65))?);
    ensure!(
        free < occupied && free >= 0.0 && occupied <= 1.0,
        "free_thresh {free} and occupied_thresh {occupied}: 0 ≤ free < occupied ≤ 1 is needed"
    );
    let mode = match value(text, "mode").as_deref() {
        None | Some("trinary" | "scale") => Mode::Grey,
        Some("raw") => Mode::Raw,
        Some(other) => bail!("mode '{other}' is none of trinary, scale, raw"),
    };
    let negate = match value(text, "negate").as_deref() {
        None | Some("0" | "false") => false,
        Some("1" | "true") => true,
        Some(other) => bail!("negate is 0 or 1, not '{other}'"),
    };
    Ok(Description {
        image: PathBuf::from(
            value(text, "image").filter(|name| !name.is_empty()).context("image is missing")?,
        ),
        resolution_m,
        origin: origin_of(text)?,
        negate,
        mode,
        occupied_threshold: occupied,
        free_threshold: free,
    })
}

/// The value of a key without comment and quotes; of a list with one item a line, the items with commas between.
fn value(text: &str, key: &str) -> Option<String> {
    let bare =
        |value: &str| value.split(" #").next().unwrap_or("").trim().trim_matches(['"', '\'']).to_owned();
    let mut lines =
        text.lines().skip_while(|line| line.split_once(':').is_none_or(|(name, _)| name.trim() != key));
    let (_, first) = lines.next()?.split_once(':')?;
    let first = bare(first);
    if !first.is_empty() {
        return Some(first);
    }
    let items = lines.map(str::trim).map_while(|line| line.strip_prefix('-').map(bare));
    Some(items.collect::<Vec<String>>().join(","))
}

fn origin_of(text: &str) -> anyhow::Result<[f32; 3]> {
    let list = value(text, "origin").context("origin is missing")?;
    let number = |item: &str| {
        let number = item.trim().parse::<f32>().ok().filter(|number| number.is_finite());
        number.with_context(|| format!("origin: '{}' is not a number", item.trim()))
    };
    let numbers: Vec<f32> =
        list.trim_matches(['[', ']']).split(',').map(number).collect::<anyhow::Result<_>>()?;
    numbers.try_into().ok().context("origin needs three numbers")
}

impl Description {
    fn state(&self, image::LumaA([grey, alpha]): image::LumaA<u8>) -> Occupancy {
        let probability = match self.mode {
            // A pixel that is not all there is not known.
            _ if alpha < u8::MAX => return Occupancy::Unknown,
            Mode::Raw if grey > 100 => return Occupancy::Unknown,
            Mode::Raw => f32::from(grey) / 100.0,
            Mode::Grey if self.negate => f32::from(grey) / 255.0,
            Mode::Grey => 1.0 - f32::from(grey) / 255.0,
        };
        Occupancy::from_probability(probability, self.free_threshold, self.occupied_threshold)
    }
}

fn convert(description: &Description, picture: &image::GrayAlphaImage) -> anyhow::Result<OccupancyMap> {
    let (width, height) = picture.dimensions();
    let side = |n: u32| u16::try_from(n).with_context(|| format!("the picture is {width} × {height} pixels"));
    let origin = Point2::new(description.origin[0], description.origin[1]);
    let geometry = GridGeometry::new(side(width)?, side(height)?, description.resolution_m, origin)
        .with_context(|| format!("a resolution of {} m is too small for a map", description.resolution_m))?;
    // The picture's first row is the top of the map.
    let pixels = (0..height).rev().flat_map(|row| (0..width).map(move |column| (column, row)));
    let cells = pixels.map(|(column, row)| description.state(*picture.get_pixel(column, row)));
    Ok(Grid::new(geometry, cells.collect())?)
}

/// Draws a map anew that is turned about its lower left corner.
fn along_the_axes(turned: &OccupancyMap, yaw_rad: f32) -> anyhow::Result<OccupancyMap> {
    let (grid, pixel_m) = (turned.geometry(), turned.geometry().resolution_m());
    let corner = grid.origin_in_map();
    let to_map = Pose2::new(corner.x_m, corner.y_m, yaw_rad);
    let (wide_m, high_m) = (f32::from(grid.width()) * pixel_m, f32::from(grid.height()) * pixel_m);
    let corners = [(0.0, 0.0), (wide_m, 0.0), (0.0, high_m), (wide_m, high_m)]
        .map(|(x_m, y_m)| to_map.transform(Point2::new(x_m, y_m)));
    let bounds = |of: fn(&Point2) -> f32| {
        let least = corners.iter().map(of).fold(f32::INFINITY, f32::min);
        (least, corners.iter().map(of).fold(f32::NEG_INFINITY, f32::max) - least)
    };
    let ((x_m, along_m), (y_m, across_m)) = (bounds(|p| p.x_m), bounds(|p| p.y_m));
    let side = |length_m: f32| u16::try_from((length_m / pixel_m).ceil() as u32).ok();
    let geometry = side(along_m)
        .zip(side(across_m))
        .and_then(|(w, h)| GridGeometry::new(w, h, pixel_m, Point2::new(x_m, y_m)))
        .context("the map is too large to be turned")?;
    let from_map = to_map.inverse();
    let state = |place: Point2| {
        let in_grid = from_map.transform(place);
        let source = grid.cell_at(Point2::new(corner.x_m + in_grid.x_m, corner.y_m + in_grid.y_m));
        source.and_then(|cell| turned.get(cell)).copied().unwrap_or(Occupancy::Unknown)
    };
    let worst = |index: usize| {
        let (centre, quarter_m) = (geometry.centre(index), 0.25 * pixel_m);
        let around = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        let states =
            around.map(|(x, y)| state(Point2::new(centre.x_m + x * quarter_m, centre.y_m + y * quarter_m)));
        let any = |asked: Occupancy| states.contains(&asked).then_some(asked);
        any(Occupancy::Occupied).or(any(Occupancy::Unknown)).unwrap_or(Occupancy::Free)
    };
    Ok(Grid::new(geometry, (0..geometry.cell_count()).map(worst).collect())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "image: \"a.pgm\"\nresolution: 0.1 # metres\norigin: [-1.0, 2.5, 0.0]\nnegate: 0\n";

    fn grey(width: u32, height: u32, pixels: &[((u32, u32), u8)]) -> image::GrayAlphaImage {
        let mut picture = image::GrayAlphaImage::from_pixel(width, height, image::LumaA([254, 255]));
        pixels.iter().for_each(|((x, y), grey)| picture.put_pixel(*x, *y, image::LumaA([*grey, 255])));
        picture
    }

    #[test]
    fn reads_fields_and_flips_the_picture() {
        let description = describe(TEXT).unwrap();
        assert_eq!(description.image, PathBuf::from("a.pgm"));
        let mut picture = grey(3, 2, &[((0, 0), 0), ((2, 1), 205)]);
        picture.put_pixel(1, 0, image::LumaA([254, 100]));
        let map = convert(&description, &picture).unwrap();
        let state = |x, y| *map.get(map.geometry().cell_at(Point2::new(x, y)).unwrap()).unwrap();
        assert_eq!(state(-0.95, 2.65), Occupancy::Occupied);
        assert_eq!(state(-0.95, 2.55), Occupancy::Free);
        assert_eq!(state(-0.75, 2.55), Occupancy::Unknown);
        assert_eq!(state(-0.85, 2.65), Occupancy::Unknown, "half transparent");
    }

    /// As ROS tools in Python write it, with the numbers as they are.
    #[test]
    fn reads_lists_of_lines_and_raw_pictures() {
        let text = "free_thresh: 0.25\nimage: 'a.pgm'\nmode: raw\norigin:\n- -1.0\n- 2.5 # y\n- 0.0\nresolution: 0.1\n";
        let description = describe(text).unwrap();
        assert_eq!(description.origin, [-1.0, 2.5, 0.0]);
        let picture = grey(5, 1, &[((0, 0), 0), ((1, 0), 100), ((2, 0), 255), ((3, 0), 40), ((4, 0), 101)]);
        let map = convert(&description, &picture).unwrap();
        use Occupancy::{Free, Occupied, Unknown};
        assert_eq!(map.values(), [Free, Occupied, Unknown, Unknown, Unknown]);
    }

    /// A quarter turn is exact; by any angle a wall stays a wall, and what lies beyond the picture is not known.
    #[test]
    fn a_turned_map_lies_where_ros_sees_it() {
        let picture = grey(40, 20, &[((39, 19), 0)]);
        let map = |yaw: f32| {
            let text = TEXT.replace("2.5, 0.0", &format!("2.5, {yaw}"));
            along_the_axes(&convert(&describe(&text).unwrap(), &picture).unwrap(), yaw).unwrap()
        };
        let state = |map: &OccupancyMap, x, y| {
            map.geometry().cell_at(Point2::new(x, y)).and_then(|cell| map.get(cell)).copied()
        };
        let quarter = map(std::f32::consts::FRAC_PI_2);
        assert_eq!(state(&quarter, -1.05, 6.45), Some(Occupancy::Occupied), "the far end of the first row");
        assert_eq!(state(&quarter, -1.05, 2.65), Some(Occupancy::Free));
        let half = map(0.5);
        let end = Pose2::new(-1.0, 2.5, 0.5).transform(Point2::new(3.95, 0.05));
        assert_eq!(state(&half, end.x_m, end.y_m), Some(Occupancy::Occupied));
        assert_eq!(state(&half, 2.4, 2.6), Some(Occupancy::Unknown));
    }

    #[test]
    fn says_what_is_wrong() {
        let complaint = |from: &str, to: &str| {
            assert!(TEXT.contains(from));
            format!("{:#}", describe(&TEXT.replace(from, to)).unwrap_err())
        };
        assert!(complaint("resolution: 0.1", "").contains("resolution is missing"));
        assert!(
            complaint("0.1", "50").contains("up to 0.5 m")
                && complaint("0.1", "nan").contains("not a number")
        );
        assert!(complaint("2.5, 0.0", "2.5").contains("three numbers"));
        assert!(complaint("-1.0", "inf").contains("'inf' is not a number"));
        assert!(complaint("negate: 0", "negate: no").contains("0 or 1"));
        assert!(complaint("negate: 0", "mode: grey").contains("trinary, scale, raw"));
        assert!(complaint("negate: 0", "free_thresh: 0.9").contains("free < occupied"));
    }
}
