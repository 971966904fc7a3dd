//! The file of a camera beside a lidar: size, intrinsics, lens, and once calibrated where it is mounted.

use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_mapping::people_removal::{BrownLens, LensCamera};
use floorguard_mapping_host::calibrate::CameraIntrinsics;
use floorguard_mapping_host::clean::SizedCamera;
use floorguard_types::geometry::{Point3, Transform3};
use floorguard_types::sensing::PinholeCamera;
use serde::{Deserialize, Serialize};

use crate::files::text;

/// JSON; lengths of the lists are part of the format.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    /// Of the pictures, pixels.
    pub width: u32,
    /// Of the pictures, pixels.
    pub height: u32,
    /// Focal lengths along columns and rows, pixels.
    pub focal_px: [f64; 2],
    /// Column and row of the optical axis, pixels.
    pub centre_px: [f64; 2],
    /// k1, k2, p1, p2, k3 of OpenCV; left out for rectified pictures.
    #[serde(default)]
    pub distortion: [f64; 5],
    /// Rows of the 4 × 4 matrix that takes points of the lidar to the camera (x right, y down, z forward), metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera_from_lidar: Option<[[f64; 4]; 4]>,
}

impl CameraFile {
    /// Reads it.
    ///
    /// # Errors
    /// It cannot be read, or a value is missing or impossible.
    pub fn read(path: &Path) -> Result<Self, BadInput> {
        let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
        let file: Self = serde_json::from_str(&text(path)?).map_err(|error| bad(&error))?;
        if file.width == 0 || file.height == 0 {
            return Err(bad(&"width and height are those of the camera's pictures, not 0"));
        }
        file.pinhole().ok_or_else(|| bad(&"focal_px is at least 1 and centre_px finite"))?;
        Ok(file)
    }

    fn pinhole(&self) -> Option<PinholeCamera> {
        PinholeCamera::new(self.focal_px.map(|f| f as f32), self.centre_px.map(|c| c as f32))
    }

    /// The intrinsics.
    pub fn intrinsics(&self) -> CameraIntrinsics {
        let [k1, k2, p1, p2, k3] = self.distortion;
        CameraIntrinsics {
            focal_px: self.focal_px,
            centre_px: self.centre_px,
            radial: [k1, k2, k3],
            tangential: [p1, p2],
        }
    }

    /// The camera where it is mounted.
    ///
    /// # Errors
    /// The mounting is missing, or its matrix is no rotation.
    pub fn mounted(&self, path: &Path) -> Result<SizedCamera, BadInput> {
        let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
        let without = "camera_from_lidar is missing: floorguard calibrate camera-lidar finds it";
        let [a, b, c, last] = self.camera_from_lidar.ok_or_else(|| bad(&without))?;
        if last != [0.0, 0.0, 0.0, 1.0] {
            return Err(bad(&"the last row of camera_from_lidar is 0 0 0 1"));
        }
        let row = |row: [f64; 4]| [row[0] as f32, row[1] as f32, row[2] as f32];
        let camera_from_lidar = Transform3 {
            rotation: [row(a), row(b), row(c)],
            translation: Point3::new(a[3] as f32, b[3] as f32, c[3] as f32),
        };
        let [k1, k2, p1, p2, k3] = self.distortion.map(|value| value as f32);
        let lens = BrownLens { radial: [k1, k2, k3], tangential: [p1, p2] };
        let pinhole = self.pinhole().ok_or_else(|| bad(&"no pinhole camera"))?;
        let camera = LensCamera::new(pinhole, lens, camera_from_lidar).map_err(|error| bad(&error))?;
        Ok(SizedCamera { camera, size: [self.width, self.height] })
    }
}
