//! Where the body goes until the robot stands: its true outline along the arc of a motion.
//!
//! The way is measured at the fastest point of the body, so that driving, turning and spinning are one and the same.
//! The outline is placed in [`STEPS`] places along the arc.

use super::config::DriveLimits;
use super::field::{edges, point_in_polygon};
use floorguard_types::geometry::{Point2, Twist2};

/// Places of the outline along the arc: a step of a stop from 1 m/s is 9 cm.
pub const STEPS: usize = 14;
/// From something that comes into the field to the order that answers it, seconds: two scans of 40 ms that must agree, one that
/// is not in step, one that may be lost, 22 ms of transfer, a tick (safety manual, section 3).
pub const REACTION_S: f32 = 0.22;
/// Kept before whatever stands in the way, at the fastest point of the body, metres: the general tolerance of a safety scanner
/// (Z_G).
pub const STANDOFF_M: f32 = 0.10;
/// Brake wear Z_B as a share of the braking distance.
pub const BRAKE_WEAR: f32 = 0.1;
/// Slower than this at its fastest point the body stands, m/s.
const STANDS_MPS: f32 = 1.0e-3;

/// Distance of a point from an outline, metres; negative inside. At most 16 corners: a few hundred instructions.
#[must_use]
pub fn signed_distance_m(outline: &[Point2], point: Point2) -> f32 {
    let mut least = f32::INFINITY;
    for (a, b) in edges(outline) {
        let (edge_x, edge_y) = (b.x_m - a.x_m, b.y_m - a.y_m);
        let (to_x, to_y) = (point.x_m - a.x_m, point.y_m - a.y_m);
        let squared = (edge_x * edge_x + edge_y * edge_y).max(1.0e-12);
        let along = ((to_x * edge_x + to_y * edge_y) / squared).clamp(0.0, 1.0);
        let (gap_x, gap_y) = (to_x - along * edge_x, to_y - along * edge_y);
        least = least.min(gap_x * gap_x + gap_y * gap_y);
    }
    let distance_m = libm::sqrtf(least);
    if point_in_polygon(point, outline) { -distance_m } else { distance_m }
}

/// Speed of the fastest corner of an outline, m/s.
#[must_use]
pub fn fastest_mps(outline: &[Point2], twist: Twist2) -> f32 {
    let speed = |corner: &Point2| {
        let along = twist.linear_mps - twist.angular_radps * corner.y_m;
        Point2::new(along, twist.angular_radps * corner.x_m).norm()
    };
    outline.iter().map(speed).fold(0.0, f32::max)
}

/// How the robot stops from a motion, at its fastest point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stopping {
    /// Way that grows with the speed, metres: reaction and response.
    delay_m: f32,
    /// Way that grows with its square, metres: braking with worn brakes.
    braking_m: f32,
}

impl Stopping {
    /// Of a motion at full speed. `reaction_s`: from the event to the order.
    #[must_use]
    pub fn from(outline: &[Point2], twist: Twist2, (drive, reaction_s): (&DriveLimits, f32)) -> Self {
        let fastest_mps = fastest_mps(outline, twist);
        // The driven wheel is what brakes.
        let wheel_mps = Point2::new(twist.linear_mps, twist.angular_radps * drive.wheelbase_m).norm();
        let braking_s = (1.0 + BRAKE_WEAR) * wheel_mps / (2.0 * drive.braking_mps2);
        Self { delay_m: fastest_mps * (reaction_s + drive.response_s), braking_m: fastest_mps * braking_s }
    }

    /// Way until standstill, metres, without any standoff.
    #[must_use]
    pub fn path_m(&self) -> f32 {
        self.delay_m + self.braking_m
    }
}

/// A place of the robot frame along the arc, seen from where it is now.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Place {
    x_m: f32,
    y_m: f32,
    sin: f32,
    cos: f32,
}

impl Place {
    /// A point of the body that has come to this place.
    fn moved(&self, corner: Point2) -> Point2 {
        let x_m = self.x_m + self.cos * corner.x_m - self.sin * corner.y_m;
        let y_m = self.y_m + self.sin * corner.x_m + self.cos * corner.y_m;
        Point2::new(x_m, y_m)
    }
}

/// The outline along the arc of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep<'a> {
    outline: &'a [Point2],
    places: [Place; STEPS],
}

impl<'a> Sweep<'a> {
    /// The arc of a motion over a way of the fastest point; `None`: nothing moves.
    #[must_use]
    pub fn along(outline: &'a [Point2], twist: Twist2, path_m: f32) -> Option<Self> {
        let fastest_mps = fastest_mps(outline, twist);
        if fastest_mps < STANDS_MPS || !twist.is_finite() {
            return None;
        }
        let step_m = path_m / STEPS as f32;
        let mut sweep = Self { outline, places: [Place::default(); STEPS] };
        let mut gone_m = 0.0;
        for slot in &mut sweep.places {
            gone_m += step_m;
            *slot = place_after(twist, gone_m / fastest_mps);
        }
        Some(sweep)
    }

    /// Every corner of the body at every place, the first one included.
    pub fn for_each_corner(&self, mut visit: impl FnMut(Point2)) {
        self.outline.iter().for_each(|corner| visit(*corner));
        for place in &self.places {
            self.outline.iter().for_each(|corner| visit(place.moved(*corner)));
        }
    }
}

/// Where the robot frame is after a time on the arc.
fn place_after(twist: Twist2, after_s: f32) -> Place {
    let turned_rad = twist.angular_radps * after_s;
    let (sin, cos) = libm::sincosf(turned_rad);
    let driven_m = twist.linear_mps * after_s;
    // sin(θ)/θ and (1 − cos θ)/θ, by their series where θ is small.
    let (ahead, aside) = if turned_rad.abs() < 1.0e-2 {
        (1.0 - turned_rad * turned_rad / 6.0, turned_rad / 2.0)
    } else {
        (sin / turned_rad, (1.0 - cos) / turned_rad)
    };
    Place { x_m: driven_m * ahead, y_m: driven_m * aside, sin, cos }
}
