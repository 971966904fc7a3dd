//! Point clouds in files of their own.

use std::path::Path;

use super::page::{Page, Stream};
use super::timeline::Timeline;
use crate::recordings::ground::read_cloud;

/// A PLY or PCD, known by its beginning, or KITTI's numbers, known by the name; `None` if it is none of them.
///
/// # Errors
/// It begins as one, and cannot be read.
pub fn page(file: &Path, begins: &[u8]) -> anyhow::Result<Option<Page>> {
    let name = file.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_kitti = name.trim_end_matches(".gz").ends_with(".bin");
    let is_pcd =
        begins.windows(11).take(512).any(|word| word == b"FIELDS x y z".get(..11).unwrap_or_default());
    if !begins.starts_with(b"ply") && !is_pcd && !is_kitti {
        return Ok(None);
    }
    let points = match read_cloud(file) {
        Ok(points) => points,
        Err(_) if is_kitti => return Ok(None),
        Err(error) => return Err(floorguard_host::outcome::BadInput(format!("{error:#}")).into()),
    };
    let mut page = Page::new("a point cloud");
    let mut stream = Stream::new("points", "x, y, z in metres", &Timeline::default());
    stream.count = points.len() as u64;
    let rings: std::collections::BTreeSet<u16> = points.iter().filter_map(|point| point.ring).collect();
    if !rings.is_empty() {
        stream.fields.push(format!("{} rings", rings.len()));
    }
    let range_m = points.iter().map(|point| {
        let [x, y, z] = point.position_m;
        libm::hypotf(libm::hypotf(x, y), z)
    });
    stream.fields.push(format!("up to {:.1} m away", range_m.fold(0.0, f32::max)));
    if points.is_empty() {
        stream.faults.push("no point in it".to_owned());
    }
    page.streams.push(stream);
    page.commands.push("floorguard eval ground: its floor, as the robot finds it".to_owned());
    Ok(Some(page))
}
