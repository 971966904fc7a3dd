//! Writes pictures into a folder from which `run` takes them as from a camera.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use floorguard_types::geometry::Pose2;
use floorguard_types::sensing::ImageSize;
use floorguard_types::time::Stamp;
use image::{ImageBuffer, Luma, RgbImage};

use floorguard_host::outcome::BadInput;

/// How `robot.toml` says where the pictures are.
const SECTION: &str = "camera.toml";

/// What the camera was, for `[camera]` of `robot.toml`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureCamera {
    /// Columns and rows of the colour pictures; depth pictures of a part of it are enlarged.
    pub size: ImageSize,
    /// Focal length of the colour pictures, pixels; the principal point is the middle of the picture.
    pub focal_px: f32,
    /// Where it is.
    pub mounting: FloorMounting,
}

/// Where a camera looks down from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorMounting {
    /// Above the floor, metres.
    pub height_m: f32,
    /// Before the robot's origin, metres.
    pub forward_m: f32,
    /// Downwards from the horizon, radians.
    pub pitch_rad: f32,
}

/// A depth picture to write.
#[derive(Clone, Copy)]
pub struct DepthPicture<'a> {
    /// Millimetres, row by row from the top left; 0 where nothing was measured.
    pub depth_mm: &'a [u16],
    /// Columns and rows.
    pub size: ImageSize,
}

/// The folder: `depth/STAMP.png`, `rgb/STAMP.png`, `poses.csv`, and the section for `robot.toml`.
pub struct PictureFolder {
    root: PathBuf,
    camera: PictureCamera,
    poses: String,
    /// Of both kinds together.
    pub pictures: u32,
}

impl PictureFolder {
    /// A folder; made if there is none.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn new(root: &Path, camera: PictureCamera) -> anyhow::Result<Self> {
        for kind in ["depth", "rgb"] {
            fs::create_dir_all(root.join(kind)).map_err(|problem| unwritable(root, &problem))?;
        }
        let FloorMounting { height_m, forward_m, pitch_rad } = camera.mounting;
        let PictureCamera { size: ImageSize { width, height }, focal_px, .. } = camera;
        let middle = |side: usize| (side as f32 - 1.0) / 2.0;
        let section = format!(
            "[camera]\nsource = \"folder:{}\"\nwidth = {width}\nheight = {height}\nfx = {focal_px:.2}\nfy = {focal_px:.2}\n\
             cx = {:.1}\ncy = {:.1}\nmounting = {{ x_m = {forward_m:.3}, y_m = 0.0, z_m = {height_m:.3}, pitch_deg = {:.3} }}\n",
            // A user who copies the section may have the robot.toml elsewhere.
            std::path::absolute(root).unwrap_or_else(|_| root.to_owned()).display(),
            middle(width),
            middle(height),
            pitch_rad.to_degrees(),
        );
        fs::write(root.join(SECTION), section).map_err(|problem| unwritable(root, &problem))?;
        let poses = "name,x_m,y_m,heading_rad\n".to_owned();
        Ok(Self { root: root.to_owned(), camera, poses, pictures: 0 })
    }

    /// Both pictures of a moment: millimetres of a size, red, green and blue.
    ///
    /// # Errors
    /// The disk is full, or a picture has another size than it should.
    pub fn add(
        &mut self,
        (stamp, robot): (Stamp, Pose2),
        depth: DepthPicture<'_>,
        rgb: &[u8],
    ) -> anyhow::Result<()> {
        let stamp_us = stamp.as_micros();
        let name = format!("{}.{:06}", stamp_us / 1_000_000, stamp_us % 1_000_000);
        let ImageSize { width, height } = self.camera.size;
        let shown = |x: u32, y: u32| {
            let (column, row) =
                (x as usize * depth.size.width / width, y as usize * depth.size.height / height);
            Luma([depth.depth_mm.get(row * depth.size.width + column).copied().unwrap_or(0)])
        };
        let depth_file = ImageBuffer::<Luma<u16>, Vec<u16>>::from_fn(width as u32, height as u32, shown);
        let colour = RgbImage::from_raw(width as u32, height as u32, rgb.to_vec());
        let colour =
            colour.ok_or_else(|| anyhow::anyhow!("{} bytes are no {width} × {height}", rgb.len()))?;
        let path = |kind: &str| self.root.join(kind).join(format!("{name}.png"));
        depth_file.save(path("depth")).map_err(|problem| unwritable(&self.root, &problem))?;
        colour.save(path("rgb")).map_err(|problem| unwritable(&self.root, &problem))?;
        let _ = writeln!(self.poses, "{name},{:.4},{:.4},{:.5}", robot.x_m, robot.y_m, robot.heading_rad);
        self.pictures += 2;
        Ok(())
    }

    /// Writes the poses.
    ///
    /// # Errors
    /// The disk is full.
    pub fn finish(self) -> anyhow::Result<u32> {
        fs::write(self.root.join("poses.csv"), self.poses)
            .map_err(|problem| unwritable(&self.root, &problem))?;
        Ok(self.pictures)
    }
}

fn unwritable(root: &Path, problem: &dyn std::fmt::Display) -> BadInput {
    BadInput(format!("{}: cannot be written ({problem}); give another place", root.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wherever the section is pasted, it names the same folder.
    #[test]
    fn the_section_names_its_folder_from_anywhere() {
        let folder = tempfile::tempdir().unwrap();
        let here = std::env::current_dir().unwrap();
        let up = "../".repeat(here.components().count() - 1);
        let relative = Path::new(&up).join(folder.path().strip_prefix("/").unwrap());
        assert!(relative.is_relative());
        let camera = PictureCamera {
            size: ImageSize { width: 4, height: 2 },
            focal_px: 2.0,
            mounting: FloorMounting { height_m: 0.7, forward_m: 0.9, pitch_rad: 0.8 },
        };
        PictureFolder::new(&relative, camera).unwrap();
        let section = fs::read_to_string(folder.path().join(SECTION)).unwrap();
        let named = section.lines().find_map(|line| line.strip_prefix("source = \"folder:")).unwrap();
        assert!(named.starts_with('/'), "{named}");
    }
}
