//! Where the body goes until the robot stands: its true outline along the arc of a motion, and how far it may move before it
//! touches a point.
//!
//! The way is measured at the fastest point of the body, so that driving, turning and spinning are one and the same.
//! The outline is examined in [`STEPS`] places along the arc; between two of them the gap to a point is taken as
//! linear.

use super::config::DriveLimits;
use super::field::{edges, point_in_polygon};
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::number::nearest_f32;

/// Places of the outline along the arc: a step of a stop from 1 m/s is 9 cm.
pub const STEPS: usize = 14;
/// Where a point is near, each step is examined in so many parts: no more than a centimetre slips through at a corner.
const PARTS_OF_STEP: u8 = 4;
/// From something that comes into the field to the order that answers it, seconds: two scans of 40 ms that must agree, one that
/// is not in step, one that may be lost, 22 ms of transfer, a tick (safety manual, section 3).
pub const REACTION_S: f32 = 0.22;
/// Kept before whatever stands in the way, at the fastest point of the body, metres: the general tolerance of a safety scanner
/// (Z_G).
pub const STANDOFF_M: f32 = 0.10;
/// Kept beside the body, metres: half a cell of the memory, and what the wheels slip while an object passes along the
/// body.
pub const MARGIN_M: f32 = 0.05;
/// Brake wear Z_B as a share of the braking distance.
pub const BRAKE_WEAR: f32 = 0.1;
/// What already stands nearer than the margin must not come nearer by more than this, metres.
pub(super) const NEARER_M: f32 = 0.005;
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
    if twist.angular_radps == 0.0 {
        return twist.linear_mps.abs();
    }
    let squared = |corner: &Point2| {
        let along_mps = twist.linear_mps - twist.angular_radps * corner.y_m;
        let aside_mps = twist.angular_radps * corner.x_m;
        along_mps * along_mps + aside_mps * aside_mps
    };
    libm::sqrtf(outline.iter().map(squared).fold(0.0, f32::max))
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
        // The fastest of the driven wheels is what brakes: the one in the middle, or the outer one of two (FG-REQ-081).
        let middle_mps = Point2::new(twist.linear_mps, twist.angular_radps * drive.wheelbase_m).norm();
        let outer_mps = twist.linear_mps.abs() + twist.angular_radps.abs() * drive.wheel_lever_m;
        let wheel_mps = middle_mps.max(outer_mps);
        let braking_s = (1.0 + BRAKE_WEAR) * wheel_mps / (2.0 * drive.braking_mps2);
        Self { delay_m: fastest_mps * (reaction_s + drive.response_s), braking_m: fastest_mps * braking_s }
    }

    /// Way until standstill, metres, without any standoff.
    #[must_use]
    pub fn path_m(&self) -> f32 {
        self.delay_m + self.braking_m
    }

    /// The share of the speed from which the robot stands within a way: 0…1. The root of `braking·k² + delay·k = path`.
    #[must_use]
    pub fn share_within(&self, path_m: f32) -> f32 {
        if path_m >= self.path_m() {
            return 1.0;
        }
        let path_m = path_m.max(0.0);
        let root = libm::sqrtf(self.delay_m * self.delay_m + 4.0 * self.braking_m * path_m);
        // The form that loses no digits where the braking is small.
        (2.0 * path_m / (self.delay_m + root).max(1.0e-9)).clamp(0.0, 1.0)
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
    /// The place that is reached from this one by a step that begins at the origin.
    fn then(&self, step: &Self) -> Self {
        let to = self.moved(Point2::new(step.x_m, step.y_m));
        Self {
            x_m: to.x_m,
            y_m: to.y_m,
            sin: self.sin * step.cos + self.cos * step.sin,
            cos: self.cos * step.cos - self.sin * step.sin,
        }
    }

    /// A point of the robot frame of now, as it is seen from this place.
    fn seen_from(&self, point: Point2) -> Point2 {
        let (dx, dy) = (point.x_m - self.x_m, point.y_m - self.y_m);
        Point2::new(self.cos * dx + self.sin * dy, self.cos * dy - self.sin * dx)
    }

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
    step_m: f32,
    body: [[f32; 2]; 2],
    /// The box around all of it, with the margin: least and greatest x and y, metres, robot frame.
    pub around: [[f32; 2]; 2],
}

impl<'a> Sweep<'a> {
    /// The arc of a motion over a way of the fastest point; `None`: nothing moves.
    #[must_use]
    pub fn along(outline: &'a [Point2], twist: Twist2, path_m: f32) -> Option<Self> {
        let fastest_mps = fastest_mps(outline, twist);
        if fastest_mps < STANDS_MPS || !twist.is_finite() {
            return None;
        }
        let step_m = path_m / nearest_f32(STEPS);
        let mut body = EMPTY;
        outline.iter().for_each(|corner| reach(&mut body, *corner));
        let mut sweep = Self { outline, places: [Place::default(); STEPS], step_m, body, around: body };
        let step = place_after(twist, step_m / fastest_mps);
        let mut place = Place { cos: 1.0, ..Place::default() };
        for slot in &mut sweep.places {
            place = place.then(&step);
            outline.iter().for_each(|corner| reach(&mut sweep.around, place.moved(*corner)));
            *slot = place;
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

    /// The point lies in the box around the sweep.
    #[must_use]
    pub fn is_near(&self, point: Point2) -> bool {
        is_within(self.around, point)
    }

    /// How far the fastest point of the body may go before the body comes nearer to a point than the margin; before it comes
    /// nearer at all, where the point is within the margin already. `known_m`: nothing beyond is asked for. Metres.
    #[must_use]
    pub fn free_m(&self, point: Point2, known_m: f32) -> f32 {
        let kept_m = if self.is_beside(point) {
            MARGIN_M.min(signed_distance_m(self.outline, point) - NEARER_M)
        } else {
            MARGIN_M
        };
        let (mut gone_m, mut before) = (0.0, point);
        for place in &self.places {
            if gone_m >= known_m {
                break;
            }
            let seen = place.seen_from(point);
            if self.passes_near(before, seen)
                && let Some(share) = self.contact_between((before, seen), kept_m)
            {
                return known_m.min(gone_m + self.step_m * share);
            }
            before = seen;
            gone_m += self.step_m;
        }
        known_m
    }

    /// Where, between two places next to each other, the point comes nearer to the outline than it may: share of the step.
    fn contact_between(&self, (from, to): (Point2, Point2), kept_m: f32) -> Option<f32> {
        let mut before = from;
        for part in 1..=PARTS_OF_STEP {
            let share = f32::from(part) / f32::from(PARTS_OF_STEP);
            let between =
                Point2::new(from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m));
            if self.is_beside(between) {
                let gap_m = signed_distance_m(self.outline, between);
                if gap_m < kept_m {
                    let gap_before_m = signed_distance_m(self.outline, before);
                    let of_part = (gap_before_m - kept_m) / (gap_before_m - gap_m).max(1.0e-6);
                    return Some(share - (1.0 - of_part.clamp(0.0, 1.0)) / f32::from(PARTS_OF_STEP));
                }
            }
            before = between;
        }
        None
    }

    /// The way of the point between two places may meet the box around the outline and its margin.
    fn passes_near(&self, from: Point2, to: Point2) -> bool {
        let [[x_min, x_max], [y_min, y_max]] = self.body;
        from.x_m.max(to.x_m) >= x_min
            && from.x_m.min(to.x_m) <= x_max
            && from.y_m.max(to.y_m) >= y_min
            && from.y_m.min(to.y_m) <= y_max
    }

    /// Within the box around the outline and its margin: only then is it worth a look at the outline itself.
    fn is_beside(&self, point: Point2) -> bool {
        is_within(self.body, point)
    }
}

fn is_within([[x_min, x_max], [y_min, y_max]]: [[f32; 2]; 2], point: Point2) -> bool {
    point.x_m >= x_min && point.x_m <= x_max && point.y_m >= y_min && point.y_m <= y_max
}

fn reach(around: &mut [[f32; 2]; 2], corner: Point2) {
    for ([least_m, greatest_m], value_m) in around.iter_mut().zip([corner.x_m, corner.y_m]) {
        *least_m = least_m.min(value_m - MARGIN_M);
        *greatest_m = greatest_m.max(value_m + MARGIN_M);
    }
}

/// Nothing is around it yet.
const EMPTY: [[f32; 2]; 2] = [[f32::INFINITY, f32::NEG_INFINITY]; 2];

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
