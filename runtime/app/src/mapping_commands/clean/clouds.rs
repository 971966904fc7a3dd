//! `PointCloud2` messages of any bag as sweeps: rings by the field `ring`, `channel` or `line`, the rows of an organised
//! cloud, or the elevation; times by the field `t`, `time`, `timestamp` or `offset_time`, or the azimuth.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use floorguard_host::outcome::BadInput;
use floorguard_host::packing::unpacked;
use floorguard_mapping_host::clean::{CleanConfig, FAN_RINGS, RawReturn, RawSweep};
use floorguard_recording::decode::{self, Cloud, Field};
use floorguard_recording::{Recorded, Recording};
use floorguard_types::geometry::Point3;

use crate::recordings::cloud_number;

/// Clouds of one topic of a bag.
pub struct CloudBag {
    path: PathBuf,
    topic: String,
    /// Ring of the message and its elevation in radians, lowest first, at most 32.
    rings: Vec<(u16, f32)>,
}

/// A revolution of a cloud without times, seconds.
const REVOLUTION_S: f32 = 0.1;
/// Times above this are seconds since 1970, not since the message.
const ABSOLUTE_S: f64 = 1.0e8;
/// Whole numbers count nanoseconds; floats above this do, too.
const NANOSECONDS_FROM: f64 = 1.0e3;
/// Nearer returns say nothing about elevations, metres.
const NEAR_M: f32 = 0.3;
/// Ring of returns that belong to none of the fan.
const NO_RING: u8 = u8::MAX;

/// A return as the message has it.
struct Row {
    point: Point3,
    ring: Option<u16>,
    time_s: Option<f64>,
}

impl CloudBag {
    /// Chooses the topic with most clouds.
    ///
    /// # Errors
    /// It cannot be read, or holds no cloud with coordinates.
    pub fn open(path: &Path) -> anyhow::Result<Self> {
        let bad = |what: &str| BadInput(format!("{}: {what}", path.display()));
        let mut counts: BTreeMap<String, u64> = BTreeMap::new();
        for message in messages(path)? {
            *counts.entry(message?.topic.to_string()).or_default() += 1;
        }
        let most = counts.into_iter().max_by_key(|(_, count)| *count);
        let (topic, _) =
            most.ok_or_else(|| bad("no PointCloud2 in it; lidar packets are read from .pcap"))?;
        let mut bag = Self { path: path.to_owned(), topic, rings: Vec::new() };
        let mut first = Vec::new();
        bag.for_each_message(&mut |cloud| {
            if first.is_empty() {
                first = rows(cloud).ok_or_else(|| bad("the points have no readable x, y and z"))?;
            }
            Ok(())
        })?;
        bag.rings = rings(&first);
        Ok(bag)
    }

    fn for_each_message(&self, each: &mut dyn FnMut(&Cloud<'_>) -> anyhow::Result<()>) -> anyhow::Result<()> {
        for message in messages(&self.path)? {
            let message = message?;
            let cloud = (*message.topic == self.topic).then(|| decode::cloud(&message.data)).flatten();
            cloud.map_or(Ok(()), |cloud| each(&cloud))?;
        }
        Ok(())
    }

    /// Calls `each` for every cloud; empty and damaged ones are left out.
    ///
    /// # Errors
    /// The bag is cut off, or `each` refuses.
    pub fn for_each(&self, each: &mut dyn FnMut(&RawSweep) -> anyhow::Result<()>) -> anyhow::Result<()> {
        self.for_each_message(&mut |cloud| {
            let Some(rows) = rows(cloud).filter(|rows| !rows.is_empty()) else { return Ok(()) };
            each(&self.sweep(cloud.header.stamp.as_micros() as f64 * 1.0e-6, &rows))
        })
    }

    fn sweep(&self, stamp_s: f64, rows: &[Row]) -> RawSweep {
        let least_s = rows.iter().filter_map(|row| row.time_s).fold(f64::INFINITY, f64::min);
        let start_s = match least_s {
            least_s if !least_s.is_finite() => stamp_s,
            least_s if least_s > ABSOLUTE_S => least_s,
            least_s => stamp_s + least_s,
        };
        let azimuth = |point: Point3| -libm::atan2f(point.y_m, point.x_m);
        let first_rad = rows.first().map_or(0.0, |row| azimuth(row.point));
        let mut returns: Vec<RawReturn> = rows
            .iter()
            .map(|row| {
                let turned = (azimuth(row.point) - first_rad).rem_euclid(std::f32::consts::TAU);
                let by_azimuth = turned / std::f32::consts::TAU * REVOLUTION_S;
                let offset_s = row.time_s.map_or(by_azimuth, |time_s| (time_s - least_s) as f32);
                RawReturn { point_in_sensor: row.point, offset_s, ring: self.ring(row) }
            })
            .collect();
        returns.sort_by(|a, b| a.offset_s.total_cmp(&b.offset_s));
        RawSweep { start_s, returns }
    }

    fn ring(&self, row: &Row) -> u8 {
        let elevation = elevation_rad(row.point);
        let found = match row.ring {
            Some(ring) => self.rings.iter().position(|(number, _)| *number == ring),
            None => {
                let away = |index: &usize| (self.rings[*index].1 - elevation).abs();
                (0..self.rings.len()).min_by(|a, b| away(a).total_cmp(&away(b)))
            }
        };
        found.and_then(|index| u8::try_from(index).ok()).unwrap_or(NO_RING)
    }

    /// Values for a lidar of these rings.
    pub fn config(&self) -> CleanConfig {
        CleanConfig::new(std::array::from_fn::<f32, FAN_RINGS, _>(|ring| {
            self.rings.get(ring).map_or(f32::NAN, |(_, elevation_rad)| *elevation_rad)
        }))
    }

    /// The topic.
    pub fn topic(&self) -> &str {
        &self.topic
    }
}

/// The clouds of a bag; others are left out.
fn messages(path: &Path) -> Result<impl Iterator<Item = Result<Recorded, BadInput>>, BadInput> {
    let name = path.display().to_string();
    let opened = File::open(path).and_then(unpacked).map_err(|error| BadInput(format!("{name}: {error}")))?;
    let is_cloud =
        |message: &Recorded| message.schema.ends_with("/PointCloud2") && &*message.encoding == "cdr";
    let recording = Recording::new(BufReader::new(opened));
    Ok(recording.filter_map(move |message| match message {
        Ok(message) => is_cloud(&message).then_some(Ok(message)),
        Err(error) => Some(Err(BadInput(format!("{name}: {error}")))),
    }))
}

fn elevation_rad(point: Point3) -> f32 {
    libm::atan2f(point.z_m, libm::hypotf(point.x_m, point.y_m))
}

/// Rings with the middle of their elevations; those of a VLP-16 for a cloud without rings. Of more than 32, 32 spread evenly.
fn rings(rows: &[Row]) -> Vec<(u16, f32)> {
    let mut by_ring: BTreeMap<u16, Vec<f32>> = BTreeMap::new();
    for row in rows.iter().filter(|row| libm::hypotf(row.point.x_m, row.point.y_m) > NEAR_M) {
        if let Some(ring) = row.ring {
            by_ring.entry(ring).or_default().push(elevation_rad(row.point));
        }
    }
    let mut rings: Vec<(u16, f32)> = by_ring
        .into_iter()
        .map(|(ring, mut elevations)| {
            let middle = elevations.len() / 2;
            (ring, *elevations.select_nth_unstable_by(middle, f32::total_cmp).1)
        })
        .collect();
    if rings.len() < 2 {
        return (0..16_u16).map(|ring| (ring, (2.0 * f32::from(ring) - 15.0).to_radians())).collect();
    }
    rings.sort_by(|a, b| a.1.total_cmp(&b.1));
    let count = rings.len();
    if count > FAN_RINGS {
        rings = (0..FAN_RINGS).map(|index| rings[index * (count - 1) / (FAN_RINGS - 1)]).collect();
    }
    rings
}

/// `None` without coordinates, or where the sizes contradict each other.
fn rows(cloud: &Cloud<'_>) -> Option<Vec<Row>> {
    let field = |names: &[&str]| cloud.fields.iter().find(|field| names.contains(&field.name.as_str()));
    let (x, y, z) = (field(&["x"])?, field(&["y"])?, field(&["z"])?);
    let ring = field(&["ring", "channel", "line"]);
    let time = field(&["t", "time", "timestamp", "offset_time", "time_offset"]);
    let row_bytes = cloud.width.checked_mul(cloud.point_step)?;
    let row_step = cloud.row_step.max(row_bytes);
    if cloud.point_step == 0 || row_step == 0 {
        return (cloud.width * cloud.height == 0).then(Vec::new);
    }
    let number = |point: &[u8], field: &Field| cloud_number(point, field, cloud.big_endian);
    let mut found = Vec::new();
    for (row, bytes) in (0_u16..).zip(cloud.data.chunks(row_step).take(cloud.height)) {
        for point in bytes.chunks_exact(cloud.point_step).take(cloud.width) {
            let place = [number(point, x)?, number(point, y)?, number(point, z)?].map(|value| value as f32);
            let is_return = place.iter().all(|value| value.is_finite()) && place != [0.0; 3];
            if !is_return {
                continue;
            }
            // An organised cloud has a row for each ring.
            let of_row = (2..=256).contains(&cloud.height).then_some(row);
            let [x_m, y_m, z_m] = place;
            found.push(Row {
                point: Point3::new(x_m, y_m, z_m),
                ring: ring.map_or(of_row, |field| number(point, field).map(|ring| ring as u16)),
                time_s: time.and_then(|field| seconds(number(point, field)?, field)),
            });
        }
    }
    Some(found)
}

/// Whole numbers are nanoseconds, floats seconds, or nanoseconds where they are too large for an offset.
fn seconds(value: f64, field: &Field) -> Option<f64> {
    let is_whole = field.datatype <= 6;
    let is_offset_in_ns = value.abs() > NANOSECONDS_FROM && value.abs() < ABSOLUTE_S;
    let is_time_in_ns = value > 1.0e15;
    let seconds = if is_whole || is_offset_in_ns || is_time_in_ns { value * 1.0e-9 } else { value };
    seconds.is_finite().then_some(seconds)
}

#[cfg(test)]
mod tests {
    use floorguard_recording::{NamedCloud, PointRow, map_clouds};
    use floorguard_types::time::Stamp;

    use super::*;

    #[test]
    fn clouds_of_a_bag_become_sweeps() {
        let point = |ring: u16, x: f32, time_s: f32| PointRow {
            position_m: [x, 0.0, x * (2.0 * f32::from(ring) - 15.0).to_radians().tan()],
            reflectivity: 9,
            ring,
            time_s,
        };
        let points = [point(0, 3.0, 0.04), point(15, 4.0, 0.01), point(7, 5.0, 0.09)];
        let cloud = NamedCloud { topic: "/lidar/points", points: &points };
        let bytes = map_clouds(&[cloud], Stamp::from_micros(2_000_000)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bag.mcap");
        std::fs::write(&path, bytes).unwrap();
        let bag = CloudBag::open(&path).unwrap();
        let mut sweeps = Vec::new();
        bag.for_each(&mut |sweep| {
            sweeps.push(sweep.clone());
            Ok(())
        })
        .unwrap();
        let [sweep] = &sweeps[..] else { panic!("{} sweeps", sweeps.len()) };
        assert!((sweep.start_s - 2.01).abs() < 1.0e-6);
        let rings: Vec<u8> = sweep.returns.iter().map(|each| each.ring).collect();
        // Three rings of the cloud, lowest first; returns in the order of their times.
        assert_eq!(rings, [2, 0, 1]);
        assert!((sweep.duration_s() - 0.08).abs() < 1.0e-6);
        std::fs::write(&path, map_clouds(&[], Stamp::ZERO).unwrap()).unwrap();
        assert!(CloudBag::open(&path).is_err_and(|error| error.to_string().contains("no PointCloud2")));
    }
}
