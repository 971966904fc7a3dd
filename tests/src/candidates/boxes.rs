//! Boxes of returns: of people, of objects, and how much two of them overlap.

use floorguard_perception::people::{RingAngles, SweepContext};
use floorguard_sim::Truth;
use floorguard_sim::people::PersonKind;
use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::geometry::{Point2, Point3};
use floorguard_types::sensing::Sweep;

/// Metres per count of a range.
const RANGE_STEP_M: f32 = 0.002;
/// Returns lower than this may be the floor, metres.
const FLOOR_M: f32 = 0.1;
/// A return this near to a body belongs to it, metres: the noise of the lidar.
const SKIN_M: f32 = 0.06;
/// Higher than this a leg is under the body, metres.
const KNEE_M: f32 = 0.45;
/// What is broader than this near the floor is a suitcase, metres.
const FOOT_MAX_M: f32 = 0.15;
/// People of whom fewer returns are left are not labelled: two rings of eight.
const RETURNS_MIN: usize = 16;
/// Nor are those who are farther away, metres.
pub const RANGE_M: f32 = 20.0;

/// Axis-aligned, lowest and highest coordinates, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest.
    pub lower: Point3,
    /// Highest.
    pub upper: Point3,
    /// Returns within.
    pub points: usize,
}

impl Bounds {
    /// Of one point.
    #[must_use]
    pub const fn at(point: Point3) -> Self {
        Self { lower: point, upper: point, points: 1 }
    }

    /// Takes in a point.
    pub fn include(&mut self, point: Point3) {
        let Point3 { x_m, y_m, z_m } = point;
        self.lower = Point3::new(self.lower.x_m.min(x_m), self.lower.y_m.min(y_m), self.lower.z_m.min(z_m));
        self.upper = Point3::new(self.upper.x_m.max(x_m), self.upper.y_m.max(y_m), self.upper.z_m.max(z_m));
        self.points += 1;
    }

    /// Lengths of the sides, metres.
    #[must_use]
    pub fn sides_m(&self) -> [f32; 3] {
        let (low, high) = (self.lower, self.upper);
        [high.x_m - low.x_m, high.y_m - low.y_m, high.z_m - low.z_m]
    }

    /// From the robot to the middle, on the floor, metres.
    pub fn distance_m(&self) -> f32 {
        self.middle().norm()
    }

    /// Its middle on the floor, robot frame.
    #[must_use]
    pub fn middle(&self) -> Point2 {
        Point2::new(0.5 * (self.lower.x_m + self.upper.x_m), 0.5 * (self.lower.y_m + self.upper.y_m))
    }

    /// Shared volume over joint volume; 0 for a flat box (book, People: Evaluation).
    #[must_use]
    pub fn overlap(&self, other: &Self) -> f32 {
        let axis = |low: [f32; 2], high: [f32; 2]| (high[0].min(high[1]) - low[0].max(low[1])).max(0.0);
        let shared = axis([self.lower.x_m, other.lower.x_m], [self.upper.x_m, other.upper.x_m])
            * axis([self.lower.y_m, other.lower.y_m], [self.upper.y_m, other.upper.y_m])
            * axis([self.lower.z_m, other.lower.z_m], [self.upper.z_m, other.upper.z_m]);
        let volume = |sides: [f32; 3]| sides.iter().product::<f32>();
        let joint = volume(self.sides_m()) + volume(other.sides_m()) - shared;
        if shared > 0.0 && joint > 0.0 { shared / joint } else { 0.0 }
    }
}

/// The returns of a sweep, robot frame; `SWEEP_RINGS` a column.
#[must_use]
pub fn points(sweep: &Sweep, context: &SweepContext) -> Vec<Option<Point3>> {
    let origin = context.sensor_in_base.translation;
    let angles = RingAngles::vlp16();
    let mut points = Vec::with_capacity(sweep.column_count * SWEEP_RINGS);
    for column in sweep.used_columns() {
        let bearing_rad = -(f32::from(column.azimuth_cdeg) * 0.01).to_radians();
        for (raw, (sin, cos, height_m)) in column.range_raw.iter().zip(angles.rings) {
            let range_m = f32::from(*raw) * RANGE_STEP_M;
            let point = Point3::new(
                origin.x_m + range_m * cos * bearing_rad.cos(),
                origin.y_m + range_m * cos * bearing_rad.sin(),
                origin.z_m + range_m * sin + height_m,
            );
            points.push((*raw != 0 && column.measured).then_some(point));
        }
    }
    points
}

/// The people of a sweep.
#[derive(Clone, Debug, Default)]
pub struct Labels {
    /// Those of whom enough is seen, robot frame: what somebody would draw around their returns.
    pub people: Vec<(PersonKind, Bounds)>,
    /// Bodies and feet of all others.
    pub unlabelled: Vec<(Point2, f32)>,
}

impl Labels {
    /// Whether a claim without a label lies on somebody who has too few returns for one: it is neither right nor wrong.
    #[must_use]
    pub fn leaves_out(&self, claim: &Bounds) -> bool {
        let middle = claim.middle();
        self.unlabelled.iter().any(|(at, radius_m)| at.distance(middle) < radius_m + SKIN_M)
    }
}

/// Who is seen, and who is there.
#[must_use]
pub fn labels(points: &[Option<Point3>], truth: &Truth) -> Labels {
    let into_base = truth.robot.inverse();
    let mut labels = Labels::default();
    for person in &truth.people {
        let middle = into_base.transform(person.position);
        // The body and the feet; what a person pushes or pulls is no part of the person.
        let feet = person.ground_discs.iter().filter(|(_, radius_m)| *radius_m < FOOT_MAX_M);
        let discs: Vec<(Point2, f32)> = feet
            .copied()
            .chain([(person.position, person.radius_m)])
            .map(|(at, radius_m)| (into_base.transform(at), radius_m))
            .collect();
        let bounds = around(points, (middle, person.height_m), &discs);
        match bounds.filter(|bounds| bounds.points >= RETURNS_MIN && middle.norm() < RANGE_M) {
            Some(bounds) => labels.people.push((person.kind, bounds)),
            None => labels.unlabelled.extend(discs),
        }
    }
    labels
}

/// The returns of a body: its last disc reaches up to its height, all of them are feet.
fn around(
    points: &[Option<Point3>],
    (middle, height_m): (Point2, f32),
    discs: &[(Point2, f32)],
) -> Option<Bounds> {
    let mut bounds: Option<Bounds> = None;
    for point in points.iter().flatten() {
        let at = Point2::new(point.x_m, point.y_m);
        let high = (FLOOR_M..height_m + SKIN_M).contains(&point.z_m);
        let on_body = |disc: &(Point2, f32)| at.distance(disc.0) < disc.1 + SKIN_M;
        // A stride before the body is a foot near the floor, and the handle of a trolley higher up.
        let parts = if point.z_m < KNEE_M { discs } else { &discs[discs.len() - 1..] };
        if high && at.distance(middle) < 1.6 && parts.iter().any(on_body) {
            match &mut bounds {
                Some(bounds) => bounds.include(*point),
                None => bounds = Some(Bounds::at(*point)),
            }
        }
    }
    bounds
}
