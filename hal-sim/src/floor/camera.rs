//! The floor camera: where each of its pixels meets the floor.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{ImageSize, Pixel};

/// A pinhole camera on the robot, looking forward and down, without roll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorCamera {
    /// Columns and rows.
    pub size: ImageSize,
    /// Focal length, pixels; the principal point is the middle of the picture.
    pub focal_px: f32,
    /// Metres above the floor.
    pub height_m: f32,
    /// Downwards from the horizon, radians.
    pub pitch_rad: f32,
    /// Metres before the robot's origin.
    pub forward_m: f32,
    /// Beyond this distance on the floor a pixel is not judged, metres.
    pub reach_m: f32,
}

impl Default for FloorCamera {
    fn default() -> Self {
        Self {
            size: ImageSize { width: 640, height: 480 },
            focal_px: 525.0,
            height_m: 0.72,
            pitch_rad: 0.85,
            forward_m: 0.3,
            reach_m: 1.8,
        }
    }
}

/// The ray of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sight {
    /// Place on the floor before (x) and left of (y) the camera's foot point, metres.
    pub(super) place_m: (f32, f32),
    /// Unit ray in the robot's directions: forward, left, up.
    pub(super) ray: [f32; 3],
    /// Metres of floor along the longer side of a pixel.
    pub(super) footprint_m: f32,
}

impl FloorCamera {
    /// The ray of a pixel; `None` above the horizon.
    pub(super) fn sight(&self, column: f32, row: f32) -> Option<Sight> {
        let (sin, cos) = libm::sincosf(self.pitch_rad);
        let x = (column - (self.size.width as f32 - 1.0) / 2.0) / self.focal_px;
        let y = (row - (self.size.height as f32 - 1.0) / 2.0) / self.focal_px;
        let ray = [cos - y * sin, -x, -sin - y * cos];
        if ray[2] > -0.05 {
            return None;
        }
        let depth = self.height_m / -ray[2];
        let length = (ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]).sqrt();
        Some(Sight {
            place_m: (depth * ray[0], depth * ray[1]),
            ray: ray.map(|value| value / length),
            footprint_m: depth / self.focal_px * length / -ray[2],
        })
    }

    /// Where a point of the floor appears; `None` behind the camera.
    #[must_use]
    pub fn pixel(&self, robot_in_world: Pose2, point_in_world: Point2) -> Option<Pixel> {
        let point = robot_in_world.inverse().transform(point_in_world);
        let (forward, left) = (point.x_m - self.forward_m, point.y_m);
        let (sin, cos) = libm::sincosf(self.pitch_rad);
        let depth = forward * cos + self.height_m * sin;
        let down = self.height_m * cos - forward * sin;
        let middle = |pixels: usize| (pixels as f32 - 1.0) / 2.0;
        (depth > 0.05).then(|| Pixel {
            column: middle(self.size.width) - self.focal_px * left / depth,
            row: middle(self.size.height) + self.focal_px * down / depth,
        })
    }

    /// The place on the floor that a pixel looks at, in the world; `None` above the horizon.
    #[must_use]
    pub fn floor_place(&self, robot_in_world: Pose2, pixel: Pixel) -> Option<Point2> {
        let (forward, left) = self.sight(pixel.column, pixel.row)?.place_m;
        Some(robot_in_world.transform(Point2 { x_m: forward + self.forward_m, y_m: left }))
    }
}
