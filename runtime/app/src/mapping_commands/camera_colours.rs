//! Colours of a cloud from pictures that were taken while the lidar drove.

use std::path::{Path, PathBuf};

use floorguard_mapping_host::colouring::{CameraView, Colouring};
use floorguard_mapping_host::lidar3d::{CloudPoint, SpaceMap};
use floorguard_mapping_host::metrics::{TimedPose, pose_at};
use floorguard_mapping_host::turn_angle_rad;
use serde::Serialize;

use super::arguments::Map3dArguments;
use super::progress::Progress;
use crate::cameras::{CameraFile, TakenPicture, for_each_picture};

/// Sweeps farther apart than this have no pose between them, seconds.
const GAP_S: f64 = 0.5;
/// Who moved and turned less since the picture before sees the same again, metres and radians.
const MOVED: (f64, f64) = (0.1, 0.035);
/// No picture shows the point.
const UNSEEN: [u8; 3] = [96; 3];

/// What became of the pictures; field names say the units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PictureCounts {
    /// All that were read.
    pub pictures: u64,
    /// Their colours count.
    pub used: u64,
    /// The lidar had hardly moved since the one before.
    pub same_again: u64,
    /// Taken before the first sweep, after the last one or in a gap between them.
    pub without_pose: u64,
    /// Of another size than the camera's file says.
    pub of_other_size: u64,
    /// Points that have the colour of a picture; the others are grey.
    pub points_coloured: usize,
}

/// The colour of each point, and what became of the pictures.
///
/// # Errors
/// The camera's file or the pictures cannot be read, or no picture was taken during the drive.
pub fn camera_colours(
    (map, points): (&SpaceMap, &[CloudPoint]),
    arguments: &Map3dArguments,
) -> anyhow::Result<(Vec<[u8; 3]>, PictureCounts)> {
    let file = arguments.camera.as_deref().unwrap_or(Path::new(""));
    let camera = CameraFile::read(file)?.mounted(file)?;
    let pictures = pictures_of(arguments);
    let mut colouring = Colouring::new(points, arguments.cell_m as f32);
    let (mut counts, mut last) = (PictureCounts::default(), None);
    let progress = Progress::new(0);
    progress.phase("looking at pictures");
    let read = for_each_picture(&pictures, &mut |taken| {
        counts.pictures += 1;
        if taken.size != camera.size {
            counts.of_other_size += 1;
        } else if let Some(pose) = pose_of(&taken, map, (&mut last, &mut counts)) {
            colouring.add(&CameraView { camera: &camera, lidar_in_map: &pose, rgb: &taken.rgb });
            counts.used += 1;
        }
        Ok(())
    });
    progress.finish();
    read?;
    check(&counts, &pictures)?;
    let found = colouring.colours();
    counts.points_coloured = found.iter().flatten().count();
    Ok((found.into_iter().map(|colour| colour.unwrap_or(UNSEEN)).collect(), counts))
}

/// The pictures lie in the recording itself where nothing else is named.
fn pictures_of(arguments: &Map3dArguments) -> PathBuf {
    arguments.pictures.clone().or_else(|| arguments.files.first().cloned()).unwrap_or_default()
}

/// Where the lidar was; `None`: not known, or the same place again.
fn pose_of(
    taken: &TakenPicture,
    map: &SpaceMap,
    (last, counts): (&mut Option<TimedPose>, &mut PictureCounts),
) -> Option<TimedPose> {
    let Some(pose) = pose_at(&map.trajectory, taken.stamp.as_micros() as f64 * 1.0e-6, GAP_S) else {
        counts.without_pose += 1;
        return None;
    };
    let has_moved = last.as_ref().is_none_or(|last| {
        (pose.place_m - last.place_m).norm() >= MOVED.0
            || turn_angle_rad(&last.rotation.rotation_to(&pose.rotation)) >= MOVED.1
    });
    if !has_moved {
        counts.same_again += 1;
        return None;
    }
    *last = Some(pose);
    Some(pose)
}

fn check(counts: &PictureCounts, pictures: &Path) -> Result<(), floorguard_host::outcome::BadInput> {
    if counts.used > 0 {
        return Ok(());
    }
    let PictureCounts { pictures: all, of_other_size, without_pose, .. } = counts;
    Err(floorguard_host::outcome::BadInput(format!(
        "{}: none of {all} pictures has the camera's size and was taken during the drive ({of_other_size} of another size, \
         {without_pose} at another time): their times are seconds on the clock of the sweeps",
        pictures.display()
    )))
}
