//! Files with one point cloud: PLY, PCD, or the bare numbers of KITTI.

use std::io::Read as _;
use std::path::Path;

use floorguard_host::packing::unpacked;
use floorguard_recording::decode::{Cloud, Field, Header};
use floorguard_types::time::Stamp;

use super::{pcd, ply};
use crate::recordings::replay::{Point, points};

/// A cloud is no larger, bytes.
const BYTES_MAX: u64 = 1 << 30;
/// x, y, z and reflectivity of KITTI's files, four bytes each.
const KITTI_POINT: usize = 16;

/// Numbers as ROS numbers them, little-endian and in rows.
#[derive(Debug, Default)]
pub struct Table {
    /// What a point holds.
    pub fields: Vec<Field>,
    /// Bytes from point to point.
    pub step: usize,
    /// How many.
    pub count: usize,
    /// The numbers are big-endian.
    pub big_endian: bool,
    /// The points.
    pub data: Vec<u8>,
}

/// `sensor_msgs/msg/PointField`: float64.
pub const FLOAT64: u8 = 8;
/// The same: float32.
const FLOAT32: u8 = 7;

impl Table {
    /// Columns of that name, all float64, without rows.
    pub fn of_doubles(names: &[String]) -> Self {
        let field = |(index, name): (usize, &String)| Field {
            name: name.clone(),
            offset: 8 * index,
            datatype: FLOAT64,
        };
        let fields = names.iter().enumerate().map(field).collect();
        Self { fields, step: 8 * names.len(), ..Self::default() }
    }

    /// Adds a row of text.
    pub fn add_row(&mut self, line: &str) -> Option<()> {
        let mut words = line.split_ascii_whitespace();
        for _ in &self.fields {
            let number: f64 = words.next()?.parse().ok()?;
            self.data.extend(number.to_le_bytes());
        }
        self.count += 1;
        Some(())
    }
}

/// Reads the points of a cloud.
///
/// # Errors
/// Why it cannot be read.
pub fn read(path: &Path) -> anyhow::Result<Vec<Point>> {
    let name = path.display();
    let mut bytes = Vec::new();
    unpacked(std::fs::File::open(path)?)?.take(BYTES_MAX).read_to_end(&mut bytes)?;
    let table = if bytes.starts_with(b"ply") {
        ply::table(&bytes)?
    } else if bytes.windows(7).take(4_096).any(|word| word == b"VERSION") {
        pcd::table(&bytes)?
    } else if is_kitti(path, &bytes) {
        kitti(bytes)
    } else {
        anyhow::bail!(
            "{name}: no cloud that we know; known are PLY, PCD, and KITTI's .bin of x, y, z and reflectivity"
        );
    };
    let Table { fields, step, count, big_endian, data } = table;
    let need = step.checked_mul(count).filter(|need| *need <= data.len());
    if need.is_none() {
        anyhow::bail!("{name}: it announces {count} points of {step} bytes and holds {} bytes", data.len());
    }
    let header = Header { stamp: Stamp::ZERO, frame: String::new() };
    let row_step = step * count;
    let cloud = Cloud {
        header,
        height: 1,
        width: count,
        fields,
        point_step: step,
        row_step,
        big_endian,
        data: &data,
    };
    points(&cloud).map_err(|error| anyhow::anyhow!("{name}: {error}"))
}

/// Its name says so, and its size fits.
fn is_kitti(path: &Path, bytes: &[u8]) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    name.trim_end_matches(".gz").ends_with(".bin")
        && !bytes.is_empty()
        && bytes.len().is_multiple_of(KITTI_POINT)
}

fn kitti(data: Vec<u8>) -> Table {
    let field =
        |(index, name): (usize, &str)| Field { name: name.to_owned(), offset: 4 * index, datatype: FLOAT32 };
    let fields = ["x", "y", "z", "intensity"].into_iter().enumerate().map(field).collect();
    Table { fields, step: KITTI_POINT, count: data.len() / KITTI_POINT, big_endian: false, data }
}
