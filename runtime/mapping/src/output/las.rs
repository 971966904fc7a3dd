//! Clouds as LAS 1.2 (ASPRS 2008), the format of surveyors, through the crate `las`.

use std::io::Cursor;

use floorguard_types::geometry::Point3;
use las::point::Format;
use las::{Builder, Color, Point, Transform, Vector, Writer};

/// A point of a survey.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LasPoint {
    /// Place in the map, metres.
    pub place_m: [f64; 3],
    /// Reflectivity; 0 where it is not known.
    pub intensity: u16,
    /// Seconds on the clock of the recording.
    pub time_s: f64,
    /// Red, green, blue; all points of a cloud have one, or none has.
    pub colour: Option<[u8; 3]>,
}

/// Places are whole millimetres.
const SCALE_M: f64 = 0.001;

/// A cloud with times and reflectivity: version 1.2, format 1, or 3 where the first point has a colour. The header bears no date: the
/// same points give the same bytes.
///
/// # Errors
/// A place is beyond ±2,147 km or not finite.
pub fn las(points: impl Iterator<Item = LasPoint>) -> Result<Vec<u8>, las::Error> {
    let mut points = points.peekable();
    let has_colour = points.peek().is_some_and(|point| point.colour.is_some());
    let axis = Transform { scale: SCALE_M, offset: 0.0 };
    let mut builder = Builder::from((1, 2));
    builder.point_format = Format::new(if has_colour { 3 } else { 1 })?;
    builder.transforms = Vector { x: axis, y: axis, z: axis };
    builder.date = None;
    builder.generating_software = "floorguard".to_owned();
    builder.system_identifier = "lidar".to_owned();
    let mut writer = Writer::new(Cursor::new(Vec::new()), builder.into_header()?)?;
    for point in points {
        let [x, y, z] = point.place_m;
        writer.write_point(Point {
            x,
            y,
            z,
            intensity: point.intensity,
            return_number: 1,
            number_of_returns: 1,
            gps_time: Some(point.time_s),
            color: has_colour.then(|| {
                let [red, green, blue] = point.colour.unwrap_or_default().map(|part| u16::from(part) * 257);
                Color::new(red, green, blue)
            }),
            ..Point::default()
        })?;
    }
    Ok(writer.into_inner()?.into_inner())
}

/// A cloud of places alone.
///
/// ```
/// use floorguard_mapping_host::output::cloud_las;
/// use floorguard_types::geometry::Point3;
///
/// let bytes = cloud_las(&[Point3::new(1.25, -2.0, 3.0)])?;
/// let mut reader = las::Reader::new(std::io::Cursor::new(bytes))?;
/// let cloud = reader.read_all()?;
/// let point = cloud.points().next().unwrap()?;
/// assert_eq!((point.x, point.y, point.z), (1.25, -2.0, 3.0));
/// # Ok::<(), las::Error>(())
/// ```
///
/// # Errors
/// As [`las`].
pub fn cloud_las(points: &[Point3]) -> Result<Vec<u8>, las::Error> {
    las(points.iter().map(|point| LasPoint {
        place_m: [point.x_m, point.y_m, point.z_m].map(f64::from),
        ..LasPoint::default()
    }))
}
