//! At which heights the rays of the sensors pass over a place of the floor.

use floorguard_guard::GuardConfig;
use floorguard_runtime::configuration::ScannerConfiguration;
use floorguard_types::geometry::{Point2, Point3, Transform3};
use floorguard_types::sensing::ImageSize;

use crate::camera::CameraConfiguration;

/// The protective field of a safety scanner ends here for black clothes, metres (book, Coverage of the sensors).
const SCANNER_RANGE_M: [f32; 2] = [0.05, 3.0];
/// The lidar measures nothing nearer, metres, and the memory keeps nothing farther.
const LIDAR_RANGE_M: [f32; 2] = [0.46, 10.0];
/// A depth camera tells an object from the floor between these distances, metres.
const CAMERA_RANGE_M: [f32; 2] = [0.45, 2.5];
/// The lowest object that the floor camera reports, metres.
const CAMERA_OBJECT_M: f32 = 0.02;
/// Rounding of a solved height, metres.
const SOLVED_M: f32 = 1.0e-3;

/// The rays that one sensor sends around its own axis: a ring of the lidar, or the plane of the scanner.
#[derive(Clone, Debug)]
struct Fan {
    mounting: Transform3,
    /// Of the elevation above the plane across the axis.
    tangent: f32,
    sector_rad: [f32; 2],
    range_m: [f32; 2],
}

impl Fan {
    /// Heights above the floor at which its rays pass over a place, metres: one, or up to two of a steeply tilted fan.
    fn heights_over(&self, place: Point2, found: &mut Vec<f32>) {
        let at = self.mounting.translation;
        let (dx, dy) = (place.x_m - at.x_m, place.y_m - at.y_m);
        let [row_x, row_y, row_z] = &self.mounting.rotation;
        // The vertical line over the place in the sensor frame: a + s·b, s metres above the sensor.
        let [(ax, bx), (ay, by), (az, bz)] =
            [0, 1, 2].map(|axis: usize| (row_x[axis] * dx + row_y[axis] * dy, row_z[axis]));
        // On the cone of the fan: (az + s·bz)² = tangent²·((ax + s·bx)² + (ay + s·by)²).
        let squared = self.tangent * self.tangent;
        let square = bz * bz - squared * (bx * bx + by * by);
        let half = az * bz - squared * (ax * bx + ay * by);
        let constant = az * az - squared * (ax * ax + ay * ay);
        let root = (half * half - square * constant).max(0.0).sqrt();
        let one = if self.tangent == 0.0 {
            [-az / bz, f32::NAN]
        } else {
            [(-half + root) / square, (-half - root) / square]
        };
        for above_m in one.into_iter().filter(|above_m| above_m.is_finite()) {
            let (x, y, z) = (ax + above_m * bx, ay + above_m * by, az + above_m * bz);
            let plane = x.hypot(y);
            let is_on_fan = (z - self.tangent * plane).abs() < SOLVED_M * (1.0 + plane);
            let range_m = plane.hypot(z);
            let azimuth_rad = y.atan2(x);
            let [first_rad, last_rad] = self.sector_rad;
            let [nearest_m, farthest_m] = self.range_m;
            if is_on_fan
                && (nearest_m..=farthest_m).contains(&range_m)
                && (first_rad..=last_rad).contains(&azimuth_rad)
            {
                found.push(at.z_m + above_m);
            }
        }
    }
}

/// The view of the floor camera: x ahead along its axis, y left, z up.
#[derive(Clone, Debug)]
struct Frustum {
    mounting: Transform3,
    /// Tangents of half the angles of view: across and upwards.
    half: [f32; 2],
}

impl Frustum {
    fn of(camera: &CameraConfiguration) -> Self {
        let ([fx, fy], [cx, cy]) = (camera.camera.focal_px(), camera.camera.centre_px());
        let ImageSize { width, height } = camera.size;
        // The narrower side counts for both.
        let half = |centre: f32, pixels: usize, focal: f32| {
            centre.min(pixels as f32 - 1.0 - centre).max(0.0) / focal
        };
        Self { mounting: camera.mounting.transform(), half: [half(cx, width, fx), half(cy, height, fy)] }
    }

    fn has(&self, point: Point3) -> bool {
        let at = self.mounting.translation;
        let path = [point.x_m - at.x_m, point.y_m - at.y_m, point.z_m - at.z_m];
        let [ahead_m, aside_m, up_m] = [0, 1, 2].map(|axis: usize| {
            let rows = self.mounting.rotation.iter().zip(path);
            rows.map(|(row, metres)| row[axis] * metres).sum::<f32>()
        });
        let [nearest_m, farthest_m] = CAMERA_RANGE_M;
        let [across, upwards] = self.half;
        (nearest_m..=farthest_m).contains(&ahead_m)
            && aside_m.abs() <= across * ahead_m
            && up_m.abs() <= upwards * ahead_m
    }
}

/// Heights at which rays pass over one place, metres above the floor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayHeights {
    /// Of the lidar.
    pub lidar_m: Vec<f32>,
    /// Of the safety scanner.
    pub scanner_m: Vec<f32>,
    /// From here on the floor camera sees what stands there.
    pub camera_m: Option<f32>,
}

/// All rays of a robot's sensors, in the robot frame.
#[derive(Clone, Debug)]
pub struct SensorRays {
    lidar: Vec<Fan>,
    scanner: Fan,
    camera: Option<Frustum>,
}

impl SensorRays {
    /// Of the sensors that a file describes.
    #[must_use]
    pub fn of(
        guard: &GuardConfig,
        scanner: &ScannerConfiguration,
        camera: Option<&CameraConfiguration>,
    ) -> Self {
        let all_around = [-core::f32::consts::PI, core::f32::consts::PI];
        let ring = |elevation_rad: &f32| Fan {
            mounting: guard.lidar.mounting,
            tangent: elevation_rad.tan(),
            sector_rad: all_around,
            range_m: LIDAR_RANGE_M,
        };
        let first_rad = scanner.model.first_angle_rad();
        let [from_rad, to_rad] = scanner.sector_rad;
        Self {
            lidar: guard.lidar.elevations_rad.iter().map(ring).collect(),
            scanner: Fan {
                mounting: scanner.mounting.transform(),
                tangent: 0.0,
                sector_rad: [from_rad.max(first_rad), to_rad.min(-first_rad)],
                range_m: SCANNER_RANGE_M,
            },
            camera: camera.map(Frustum::of),
        }
    }

    /// The same without a lidar, which such a robot does not have.
    #[must_use]
    pub(super) fn without_lidar(self) -> Self {
        Self { lidar: Vec::new(), ..self }
    }

    /// Where rays pass over a place.
    #[must_use]
    pub fn over(&self, place: Point2) -> RayHeights {
        let mut heights = RayHeights::default();
        self.lidar.iter().for_each(|ring| ring.heights_over(place, &mut heights.lidar_m));
        self.scanner.heights_over(place, &mut heights.scanner_m);
        let lowest = Point3::new(place.x_m, place.y_m, CAMERA_OBJECT_M);
        let is_in_view = self.camera.as_ref().is_some_and(|camera| camera.has(lowest));
        heights.camera_m = is_in_view.then_some(CAMERA_OBJECT_M);
        heights
    }
}
