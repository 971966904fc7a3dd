//! From pixels to places on the floor and heights above it, row by row, and on into the robot's frame.

use crate::floor::{Plane, dot};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::nearest_f32;
use floorguard_types::sensing::PinholeCamera;

/// Where the camera's foot point lies on the robot and which way the camera looks, robot frame.
pub type CameraMount = Pose2;

/// A place as the camera sees it: metres to the right of its foot point, ahead of it, and above the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FloorPoint {
    pub right_m: f32,
    pub ahead_m: f32,
    pub height_m: f32,
}

/// The camera above its floor.
#[derive(Clone, Copy, Debug)]
pub(super) struct FloorFrame {
    camera: PinholeCamera,
    plane: Plane,
    axes: [[f32; 3]; 2],
}

/// The rays of one row of pixels: a place is the depth times an affine function of the column.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowFrame {
    first: [f32; 3],
    step: [f32; 3],
    distance_m: f32,
}

impl FloorFrame {
    pub(super) fn new(camera: PinholeCamera, plane: Plane) -> Self {
        Self { camera, plane, axes: plane.axes() }
    }

    pub(super) const fn camera(&self) -> &PinholeCamera {
        &self.camera
    }

    /// The rays of a row.
    pub(super) fn row(&self, row: usize) -> RowFrame {
        let [right, ahead] = self.axes;
        let directions = [right, ahead, self.plane.normal];
        let ray = self.camera.ray(0.0, nearest_f32(row));
        let [fx, _] = self.camera.focal_px();
        let along = |[x, _, _]: [f32; 3]| x / fx;
        RowFrame {
            first: directions.map(|direction| dot(direction, ray)),
            step: directions.map(along),
            distance_m: self.plane.distance_m,
        }
    }

    /// Where a depth at a pixel lies.
    pub(super) fn point(&self, column: f32, row: f32, depth_m: f32) -> FloorPoint {
        let [right, ahead] = self.axes;
        let point = self.camera.ray(column, row).map(|value| value * depth_m);
        FloorPoint {
            right_m: dot(right, point),
            ahead_m: dot(ahead, point),
            height_m: self.plane.height_m(point),
        }
    }

    /// Height above the floor by which a depth error moves a point, per metre of the error, at a pixel.
    pub(super) fn height_gain(&self, column: f32, row: f32) -> f32 {
        dot(self.plane.normal, self.camera.ray(column, row)).abs()
    }
}

impl RowFrame {
    /// Where a depth in a column of this row lies.
    #[inline]
    pub(super) fn point(&self, column: usize, depth_m: f32) -> FloorPoint {
        let column = nearest_f32(column);
        let ([a, b, c], [da, db, dc]) = (self.first, self.step);
        FloorPoint {
            right_m: depth_m * (a + da * column),
            ahead_m: depth_m * (b + db * column),
            height_m: depth_m * (c + dc * column) + self.distance_m,
        }
    }
}

impl FloorPoint {
    /// The place in the robot's frame (x forward, y left).
    pub(super) fn in_base(&self, mount: CameraMount) -> Point2 {
        mount.transform(Point2::new(self.ahead_m, -self.right_m))
    }

    /// Distance from the camera's foot point, metres.
    pub(super) fn range_m(&self) -> f32 {
        libm::hypotf(self.right_m, self.ahead_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_match_points_and_floor_is_zero() {
        let camera = PinholeCamera::new([525.0, 525.0], [319.5, 239.5]).unwrap();
        let frame = FloorFrame::new(camera, Plane::of_mounting(0.55, 0.1).unwrap());
        let (by_row, by_point) = (frame.row(300).point(100, 2.0), frame.point(100.0, 300.0, 2.0));
        assert!((by_row.right_m - by_point.right_m).abs() < 1e-5);
        assert!((by_row.ahead_m - by_point.ahead_m).abs() < 1e-5);
        assert!((by_row.height_m - by_point.height_m).abs() < 1e-5);
        // Straight ahead and down by 0.1 rad the floor is 0.55 / sin 0.1 away along the optical axis.
        let foot = frame.point(319.5, 239.5, 0.55 / libm::sinf(0.1));
        assert!(foot.height_m.abs() < 1e-5 && foot.right_m.abs() < 1e-5, "{foot:?}");
        assert!((foot.ahead_m - 0.55 / libm::tanf(0.1)).abs() < 1e-4);
        // The robot's y points left, the camera's x right.
        let left = FloorPoint { right_m: -1.0, ahead_m: 3.0, height_m: 0.0 };
        assert_eq!(left.in_base(Pose2::new(0.5, 0.0, 0.0)), Point2::new(3.5, 1.0));
    }
}
