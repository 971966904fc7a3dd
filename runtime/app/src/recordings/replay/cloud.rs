//! Anybody's point clouds as sweeps: sixteen rings, columns of a fifth of a degree, ranges in 2 mm.
//!
//! The people stages work on the range image of a lidar of 16 rings. A cloud that names its rings keeps them; of a lidar
//! with more rings, sixteen spread over its field of view are taken. A cloud without rings is sorted by elevation.

use floorguard_perception::people::RingAngles;
use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::sensing::{Sweep, SweepColumn};
use floorguard_types::time::Stamp;

use floorguard_recording::decode::{Cloud, Field};

/// Columns of a revolution.
const COLUMNS: usize = 1_800;
/// Hundredths of a degree from column to column.
const COLUMN_CDEG: u16 = 20;
/// Millimetres of a count.
const UNIT_MM: f32 = 2.0;
/// A revolution of a lidar that does not say otherwise, microseconds.
const REVOLUTION_US: u32 = 100_000;
/// A gap of fewer columns between measured ones is one without returns, not one out of sight: 6°.
const GAP_COLUMNS: usize = 30;
/// Elevations beyond this are of no use for people, degrees.
const ELEVATION_MAX_DEG: f32 = 45.0;

/// Why a cloud cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CloudError {
    /// It has no coordinates that we can read.
    #[error("the points have no x, y and z of type float32 or float64")]
    Coordinates,
    /// The sizes contradict each other.
    #[error("the sizes of the points contradict each other")]
    Sizes,
}

/// A point: where in the sensor's frame, and of which ring if the cloud says so.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Metres.
    pub position_m: [f32; 3],
    /// Its ring.
    pub ring: Option<u16>,
    /// Reflectivity of the return.
    pub reflectivity: u8,
}

/// Where a point belongs in a sweep.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Column.
    pub column: usize,
    /// Ring, 0 lowest.
    pub ring: usize,
    /// Range in counts.
    pub raw: u16,
}

/// Makes sweeps of clouds; remembers the elevations of the rings.
#[derive(Debug, Default)]
pub struct CloudSorter {
    elevations_rad: Option<Vec<(u16, f32)>>,
}

impl CloudSorter {
    /// The elevations of the sixteen rings, once a cloud has shown them; of a VLP-16 otherwise.
    pub fn angles(&self) -> RingAngles {
        let mut angles = RingAngles::vlp16();
        // Coordinates are about the sensor's middle already: no offset of the lasers.
        for ring in &mut angles.rings {
            ring.2 = 0.0;
        }
        for (slot, (_, elevation_rad)) in angles.rings.iter_mut().zip(self.elevations_rad.iter().flatten()) {
            let (sin, cos) = libm::sincosf(*elevation_rad);
            *slot = (sin, cos, 0.0);
        }
        angles
    }

    /// A cloud as a sweep.
    ///
    /// # Errors
    /// The cloud cannot be read.
    pub fn sweep(&mut self, cloud: &Cloud<'_>, sweep: &mut Sweep) -> Result<(), CloudError> {
        self.sweep_of(&points(cloud)?, (cloud.header.stamp, REVOLUTION_US), sweep);
        Ok(())
    }

    /// Points of a revolution that began at that moment and took so many microseconds, as a sweep.
    pub fn sweep_of(&mut self, points: &[Point], (stamp, took_us): (Stamp, u32), sweep: &mut Sweep) {
        if self.elevations_rad.is_none() {
            self.elevations_rad = rings(points);
        }
        begin(sweep, (stamp, took_us));
        for point in points {
            self.place(point, sweep);
        }
        mark_measured(sweep);
    }

    fn ring_of(&self, point: &Point, elevation_rad: f32) -> Option<usize> {
        let rings = self.elevations_rad.as_deref();
        match (point.ring, rings) {
            (Some(ring), Some(rings)) => rings.iter().position(|(number, _)| *number == ring),
            _ => {
                let ring = ((elevation_rad.to_degrees() + 15.0) / 2.0).round();
                ((0.0..16.0).contains(&ring)).then_some(ring as usize)
            }
        }
    }

    /// Column, ring and counts of a point in a sweep; `None` where the sweep has no place for it.
    pub fn cell(&self, point: &Point) -> Option<Cell> {
        let [x, y, z] = point.position_m;
        let level_m = libm::hypotf(x, y);
        let counts = libm::hypotf(level_m, z) * 1_000.0 / UNIT_MM;
        if !(1.0..=f32::from(u16::MAX)).contains(&counts) {
            return None;
        }
        let ring = self.ring_of(point, libm::atan2f(z, level_m))?;
        // Clockwise from straight ahead; columns begin behind the robot.
        let azimuth_deg = -libm::atan2f(y, x).to_degrees();
        let column = ((azimuth_deg + 180.0) * 100.0 / f32::from(COLUMN_CDEG)).round() as usize % COLUMNS;
        Some(Cell { column, ring, raw: counts as u16 })
    }

    fn place(&self, point: &Point, sweep: &mut Sweep) {
        let Some(Cell { column, ring, raw }) = self.cell(point) else { return };
        let Some(column) = sweep.columns.get_mut(column) else { return };
        let (Some(cell), Some(reflectivity)) =
            (column.range_raw.get_mut(ring), column.reflectivity.get_mut(ring))
        else {
            return;
        };
        if *cell == 0 || raw < *cell {
            (*cell, *reflectivity) = (raw, point.reflectivity);
        }
        column.measured = true;
    }
}

fn begin(sweep: &mut Sweep, (stamp, took_us): (Stamp, u32)) {
    (sweep.stamp, sweep.end_stamp) = (stamp, stamp.plus_micros(u64::from(took_us)));
    (sweep.range_unit_mm, sweep.column_count) = (UNIT_MM as u8, COLUMNS);
    (sweep.packets, sweep.lost_packets, sweep.dropped_columns) = (0, 0, 0);
    for (index, column) in sweep.columns.iter_mut().enumerate() {
        let azimuth_cdeg = (18_000 + index as u32 * u32::from(COLUMN_CDEG)) % 36_000;
        let offset_us = took_us / COLUMNS as u32 * index as u32;
        *column = SweepColumn { azimuth_cdeg: azimuth_cdeg as u16, offset_us, ..SweepColumn::UNKNOWN };
    }
}

/// A column without a return between measured ones was measured, too.
fn mark_measured(sweep: &mut Sweep) {
    let seen: Vec<usize> = (0..COLUMNS)
        .filter(|index| sweep.columns.get(*index).is_some_and(|column| column.measured))
        .collect();
    for pair in seen.windows(2) {
        if let [from, to] = *pair
            && to - from <= GAP_COLUMNS
        {
            sweep.columns.iter_mut().take(to).skip(from).for_each(|column| column.measured = true);
        }
    }
}

/// The rings of a cloud that names them: sixteen at most, lowest first, each with the middle of its elevations.
fn rings(points: &[Point]) -> Option<Vec<(u16, f32)>> {
    let mut by_ring = std::collections::BTreeMap::<u16, Vec<f32>>::new();
    for point in points {
        let [x, y, z] = point.position_m;
        let level_m = libm::hypotf(x, y);
        if level_m > 0.3 {
            by_ring.entry(point.ring?).or_default().push(libm::atan2f(z, level_m));
        }
    }
    let mut rings: Vec<(u16, f32)> = by_ring
        .into_iter()
        .map(|(ring, mut elevations)| {
            let middle = elevations.len() / 2;
            (ring, *elevations.select_nth_unstable_by(middle, f32::total_cmp).1)
        })
        .filter(|(_, elevation_rad)| elevation_rad.to_degrees().abs() <= ELEVATION_MAX_DEG)
        .collect();
    rings.sort_by(|a, b| a.1.total_cmp(&b.1));
    let count = rings.len();
    if count > SWEEP_RINGS {
        rings = (0..SWEEP_RINGS).map(|index| rings[index * (count - 1) / (SWEEP_RINGS - 1)]).collect();
    }
    (count > 1).then_some(rings)
}

/// The points of a cloud that have a place.
///
/// # Errors
/// The cloud cannot be read.
pub fn points(cloud: &Cloud<'_>) -> Result<Vec<Point>, CloudError> {
    let field = |name: &str| cloud.fields.iter().find(|field| field.name == name);
    let floating = |name: &str| field(name).filter(|field| matches!(field.datatype, 7 | 8));
    let (Some(x), Some(y), Some(z)) = (floating("x"), floating("y"), floating("z")) else {
        return Err(CloudError::Coordinates);
    };
    let ring = field("ring").or_else(|| field("channel")).or_else(|| field("line"));
    let intensity = field("intensity").or_else(|| field("reflectivity")).or_else(|| field("i"));
    let row_bytes = cloud.width.checked_mul(cloud.point_step).ok_or(CloudError::Sizes)?;
    let row_step = if cloud.row_step >= row_bytes { cloud.row_step } else { row_bytes };
    if cloud.point_step == 0 || row_step == 0 {
        return if cloud.width * cloud.height == 0 { Ok(Vec::new()) } else { Err(CloudError::Sizes) };
    }
    let number = |point: &[u8], field: &Field| cloud_number(point, field, cloud.big_endian);
    let mut found = Vec::new();
    for (row, bytes) in (0_u16..).zip(cloud.data.chunks(row_step).take(cloud.height)) {
        for point in bytes.chunks_exact(cloud.point_step).take(cloud.width) {
            let position = [number(point, x), number(point, y), number(point, z)];
            let [Some(x), Some(y), Some(z)] = position else { return Err(CloudError::Sizes) };
            if !(x.is_finite() && y.is_finite() && z.is_finite()) {
                continue;
            }
            // An organised cloud has a row for each ring.
            let row = (cloud.height > 1 && cloud.height <= 256).then_some(row);
            let ring = ring.map_or(row, |field| number(point, field).map(|ring| ring as u16));
            let reflectivity = intensity.and_then(|field| number(point, field)).unwrap_or(0.0);
            found.push(Point {
                position_m: [x as f32, y as f32, z as f32],
                ring,
                reflectivity: reflectivity.clamp(0.0, 255.0) as u8,
            });
        }
    }
    Ok(found)
}

/// A number of a point; the types are those of `sensor_msgs/msg/PointField`.
pub(crate) fn cloud_number(point: &[u8], field: &Field, big_endian: bool) -> Option<f64> {
    fn take<const N: usize>(point: &[u8], at: usize, big_endian: bool) -> Option<[u8; N]> {
        let mut bytes = *point.get(at..)?.first_chunk::<N>()?;
        if big_endian {
            bytes.reverse();
        }
        Some(bytes)
    }
    let at = field.offset;
    Some(match field.datatype {
        1 => f64::from(i8::from_le_bytes(take(point, at, big_endian)?)),
        2 => f64::from(u8::from_le_bytes(take(point, at, big_endian)?)),
        3 => f64::from(i16::from_le_bytes(take(point, at, big_endian)?)),
        4 => f64::from(u16::from_le_bytes(take(point, at, big_endian)?)),
        5 => f64::from(i32::from_le_bytes(take(point, at, big_endian)?)),
        6 => f64::from(u32::from_le_bytes(take(point, at, big_endian)?)),
        7 => f64::from(f32::from_le_bytes(take(point, at, big_endian)?)),
        8 => f64::from_le_bytes(take(point, at, big_endian)?),
        _ => return None,
    })
}
