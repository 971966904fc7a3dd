//! Anybody's `PointCloud2` as a revolution: each return with its time and its laser, where the cloud names them.

use std::f64::consts::{PI, TAU};

use floorguard_mapping::lidar_odometry::{RINGS_MAX, SweepReturn};
use floorguard_mapping_host::lidar3d::SweepRecord;
use floorguard_recording::decode::Cloud;
use floorguard_types::geometry::Point3;
use nalgebra::Vector3;

use crate::recordings::cloud_number;

/// A revolution of a lidar that does not say otherwise, seconds.
const REVOLUTION_S: f64 = 0.1;
/// Numbers above this are seconds of a calendar, not since the cloud's stamp.
const CALENDAR_S: f64 = 1.0e6;
/// Lasers that are not named lie in bands of this elevation, from the lowest one on, degrees.
const BAND_DEG: f64 = 0.8;
const LOWEST_DEG: f64 = -26.0;

/// A return and when it came, seconds after the stamp.
struct Timed {
    time_s: Option<f64>,
    ring: u8,
    point: Vector3<f64>,
    reflectivity: u8,
}

/// `None` of a cloud without coordinates, whose sizes contradict each other, or with fewer than two returns.
pub fn sweep_of_cloud(cloud: &Cloud<'_>) -> Option<SweepRecord> {
    let stamp_s = cloud.header.stamp.as_micros() as f64 * 1.0e-6;
    let mut returns = returns(cloud, stamp_s)?;
    if returns.len() < 2 {
        return None;
    }
    time_by_azimuth(&mut returns);
    let time = |each: &Timed| each.time_s.unwrap_or(0.0);
    returns.sort_by(|a, b| time(a).total_cmp(&time(b)));
    let (first_s, last_s) = (time(returns.first()?), time(returns.last()?));
    let duration_s = last_s - first_s;
    if !(duration_s > 0.0 && duration_s < 2.0) {
        return None;
    }
    let sweep_return = |each: &Timed| {
        let [x, y, z] = each.point.map(|value| value as f32).into();
        SweepReturn::new(Point3::new(x, y, z), ((time(each) - first_s) / duration_s) as f32, each.ring)
    };
    Some(SweepRecord {
        end_s: stamp_s + last_s,
        duration_s,
        returns: returns.iter().map(sweep_return).collect(),
        reflectivity: returns.iter().map(|each| each.reflectivity).collect(),
    })
}

fn returns(cloud: &Cloud<'_>, stamp_s: f64) -> Option<Vec<Timed>> {
    let field = |names: &[&str]| cloud.fields.iter().find(|field| names.contains(&field.name.as_str()));
    let (x, y, z) = (field(&["x"])?, field(&["y"])?, field(&["z"])?);
    let ring = field(&["ring", "channel", "line"]);
    let time = field(&["time", "t", "timestamp", "time_stamp", "offset_time"]);
    let intensity = field(&["intensity", "reflectivity", "i"]);
    // Integers are nanoseconds, floating numbers seconds.
    let unit_s = if time.is_some_and(|time| matches!(time.datatype, 7 | 8)) { 1.0 } else { 1.0e-9 };
    let row_bytes = cloud.width.checked_mul(cloud.point_step).filter(|bytes| *bytes > 0)?;
    let row_step = cloud.row_step.max(row_bytes);
    let mut found = Vec::new();
    for (row, bytes) in cloud.data.chunks(row_step).take(cloud.height).enumerate() {
        for octets in bytes.chunks_exact(cloud.point_step).take(cloud.width) {
            let number = |field| cloud_number(octets, field, cloud.big_endian);
            let point = Vector3::new(number(x)?, number(y)?, number(z)?);
            if !point.iter().all(|value| value.is_finite()) || point.norm_squared() == 0.0 {
                continue;
            }
            let named = ring.and_then(number).or((cloud.height > 1).then_some(row as f64));
            let ring = named.map_or_else(|| band(&point), |ring| ring as u8);
            let since_stamp = |time_s: f64| if time_s > CALENDAR_S { time_s - stamp_s } else { time_s };
            let time_s = time.and_then(number).map(|time| since_stamp(time * unit_s));
            let reflectivity = intensity.and_then(number).unwrap_or(0.0).clamp(0.0, 255.0) as u8;
            found.push(Timed { time_s, ring, point, reflectivity });
        }
    }
    Some(found)
}

fn band(point: &Vector3<f64>) -> u8 {
    let elevation_deg = libm::atan2(point.z, libm::hypot(point.x, point.y)).to_degrees();
    ((elevation_deg - LOWEST_DEG) / BAND_DEG).clamp(0.0, RINGS_MAX as f64 - 1.0) as u8
}

/// Of clouds without times: the lidar turned evenly, clockwise from above, beginning behind itself.
fn time_by_azimuth(returns: &mut [Timed]) {
    if returns.iter().all(|each| each.time_s.is_some()) {
        return;
    }
    for each in returns {
        let azimuth_rad = libm::atan2(each.point.y, each.point.x);
        each.time_s = Some(REVOLUTION_S * (PI - azimuth_rad) / TAU);
    }
}

#[cfg(test)]
mod tests {
    use floorguard_recording::decode::{Field, Header};
    use floorguard_types::time::Stamp;

    use super::*;

    fn field(name: &str, offset: usize, datatype: u8) -> Field {
        Field { name: name.to_owned(), offset, datatype }
    }

    fn cloud(fields: Vec<Field>, step: usize, data: &[u8]) -> Cloud<'_> {
        let header = Header { stamp: Stamp::from_micros(5_000_000), frame: "lidar".to_owned() };
        let width = data.len() / step;
        Cloud {
            header,
            height: 1,
            width,
            fields,
            point_step: step,
            row_step: data.len(),
            big_endian: false,
            data,
        }
    }

    #[test]
    fn times_of_other_lidars_are_understood() {
        let place = vec![field("x", 0, 7), field("y", 4, 7), field("z", 8, 7)];
        let point = |x: f32, time: &[u8]| {
            let place: Vec<u8> = [x, 1.0, 0.5].iter().flat_map(|value| value.to_le_bytes()).collect();
            [place, time.to_vec()].concat()
        };
        // Nanoseconds since the stamp; seconds before it; seconds of a calendar. The later return comes first.
        let nanoseconds = [point(2.0, &100_000_000_u32.to_le_bytes()), point(3.0, &50_000_u32.to_le_bytes())];
        let before = [point(2.0, &0.0_f32.to_le_bytes()), point(3.0, &(-0.09_f32).to_le_bytes())];
        let calendar = |seconds: f64| (2.0e9 + seconds).to_le_bytes();
        let kinds = [
            (field("t", 12, 6), nanoseconds.concat(), 5.1),
            (field("time", 12, 7), before.concat(), 5.0),
            (
                field("timestamp", 12, 8),
                [point(2.0, &calendar(0.1)), point(3.0, &calendar(0.0))].concat(),
                2.0e9 + 0.1,
            ),
        ];
        for (time, data, end_s) in kinds {
            let step = if time.datatype == 8 { 20 } else { 16 };
            let name = time.name.clone();
            let sweep = sweep_of_cloud(&cloud([place.clone(), vec![time]].concat(), step, &data)).unwrap();
            assert!((sweep.end_s - end_s).abs() < 1e-6, "{name}: {}", sweep.end_s);
            assert!((0.08..0.11).contains(&sweep.duration_s), "{name}: {}", sweep.duration_s);
            assert_eq!(sweep.returns[0].point_in_sensor.x, 3.0, "{name}");
            assert_eq!([sweep.returns[0].time_share, sweep.returns[1].time_share], [0.0, 1.0]);
        }
    }

    #[test]
    fn plain_clouds_are_sorted_by_direction() {
        let place = vec![field("x", 0, 7), field("y", 4, 7), field("z", 8, 7)];
        let points: [[f32; 3]; 3] = [[1.0, 0.0, 0.1], [0.0, 1.0, -0.1], [-1.0, -0.01, 0.1]];
        let data: Vec<u8> = points.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        let sweep = sweep_of_cloud(&cloud(place.clone(), 12, &data)).unwrap();
        // To the left first, then ahead, then behind.
        let x: Vec<f32> = sweep.returns.iter().map(|each| each.point_in_sensor.x).collect();
        assert_eq!(x, [0.0, 1.0, -1.0]);
        let ring: Vec<u8> = sweep.returns.iter().map(|each| each.ring).collect();
        assert!(ring[0] < ring[1] && ring[1] == ring[2], "{ring:?}");
        assert!(sweep_of_cloud(&cloud(vec![field("x", 0, 7)], 12, &data)).is_none());
        assert!(sweep_of_cloud(&cloud(place, 12, &data[..20])).is_none());
    }
}
