//! What is known about pairs of kept scans.

use floorguard_types::geometry::Pose2;
use nalgebra::{Matrix3, Vector3};

/// Where one scan stands, seen from another: 40 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GraphEdge {
    /// From this scan...
    pub from: u16,
    /// ... to this one.
    pub to: u16,
    /// The second one in the frame of the first.
    pub measured: Pose2,
    /// Inverse covariance of x, y and heading in the frame of the first: xx, xy, xh, yy, yh, hh.
    pub information: [f32; 6],
    /// Its two ends follow each other on the path.
    pub is_step: bool,
}

impl GraphEdge {
    /// From a matrix.
    pub(super) fn new(
        [from, to]: [u16; 2],
        measured: Pose2,
        information: &Matrix3<f32>,
        is_step: bool,
    ) -> Self {
        let [[xx, xy, xh], [_, yy, yh], [_, _, hh]] = information.transpose().data.0;
        Self { from, to, measured, information: [xx, xy, xh, yy, yh, hh], is_step }
    }

    /// Inverse covariance as a matrix.
    pub(super) fn matrix(&self) -> Matrix3<f32> {
        let [xx, xy, xh, yy, yh, hh] = self.information;
        Matrix3::new(xx, xy, xh, xy, yy, yh, xh, yh, hh)
    }

    /// The error at two poses, and its derivatives by the first and by the second pose.
    pub(super) fn linearised(&self, from: Pose2, to: Pose2) -> Linearised {
        let (sin, cos) = libm::sincosf(from.heading_rad);
        let (x, y) = (to.x_m - from.x_m, to.y_m - from.y_m);
        let (ahead, aside) = (cos * x + sin * y, cos * y - sin * x);
        let turn =
            Pose2::new(0.0, 0.0, to.heading_rad - from.heading_rad - self.measured.heading_rad).heading_rad;
        Linearised {
            error: Vector3::new(ahead - self.measured.x_m, aside - self.measured.y_m, turn),
            by_from: Matrix3::new(-cos, -sin, aside, sin, -cos, -ahead, 0.0, 0.0, -1.0),
            by_to: Matrix3::new(cos, sin, 0.0, -sin, cos, 0.0, 0.0, 0.0, 1.0),
        }
    }
}

/// An edge at two poses.
pub(super) struct Linearised {
    pub(super) error: Vector3<f32>,
    pub(super) by_from: Matrix3<f32>,
    pub(super) by_to: Matrix3<f32>,
}
