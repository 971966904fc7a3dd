//! The box of a person, without what the person touches, pushes or pulls.
//!
//! A customer and a trolley are one cluster for a lidar, and its box is half trolley. What stands out above desks and
//! trolleys is the torso: around its axis the body ends within an arm's length, and what is farther is something else.
//! The foot ahead is often one cluster with the trolley, or alone, and belongs to the body all the same. On demand
//! only: tracks need no boxes.

use super::context::SweepContext;
use super::state::PeoplePipelineOf;
use crate::clusters::SweepFrame;
use floorguard_types::geometry::{Point2, Point3};
use floorguard_types::profile::Profile;
use floorguard_types::sensing::SweepOf;

/// Higher than trolleys, suitcases and tables, metres.
const TORSO_M: f32 = 1.05;
/// Returns that make an axis.
const AXIS_MIN: u16 = 4;
/// Shoulders and arms around the axis, metres.
const SHOULDERS_M: f32 = 0.40;
/// The axis is that of the side that is seen; the middle of the body lies this far behind it, metres.
const BEHIND_M: f32 = 0.10;
/// A body with its arms ends within this of its middle, whatever it touches, metres.
const BODY_M: f32 = 0.34;
/// Below the knees, metres, a foot may be part of another cluster, or one of its own.
const KNEE_M: f32 = 0.45;
/// A stride before and behind the axis, metres.
const STRIDE_M: f32 = 0.38;
/// Lower returns may be the floor, metres.
const FLOOR_M: f32 = 0.1;
/// A candidate that begins higher has no feet: they are another cluster below it, metres.
const HANGING_M: f32 = 0.45;
/// Knees, feet and wheels around the torso of somebody who sits, metres.
const SEATED_M: f32 = 0.45;
/// Rounding of the bounds, metres.
const MARGIN_M: f32 = 0.02;

/// A box in the making.
#[derive(Default)]
struct Growing {
    bounds: Option<[Point3; 2]>,
}

impl Growing {
    fn include(&mut self, point: Point3) {
        let [lower, upper] = self.bounds.get_or_insert([point, point]);
        *lower = Point3::new(lower.x_m.min(point.x_m), lower.y_m.min(point.y_m), lower.z_m.min(point.z_m));
        *upper = Point3::new(upper.x_m.max(point.x_m), upper.y_m.max(point.y_m), upper.z_m.max(point.z_m));
    }
}

fn middle_of([lower, upper]: &[Point3; 2]) -> Point2 {
    Point2::new(0.5 * (lower.x_m + upper.x_m), 0.5 * (lower.y_m + upper.y_m))
}

fn is_within(point: &Point3, [lower, upper]: &[Point3; 2]) -> bool {
    let inside = |low: f32, high: f32, value: f32| (low - MARGIN_M..=high + MARGIN_M).contains(&value);
    inside(lower.x_m, upper.x_m, point.x_m)
        && inside(lower.y_m, upper.y_m, point.y_m)
        && inside(lower.z_m, upper.z_m, point.z_m)
}

/// Where the returns of a body are.
enum Body {
    /// Of somebody who stands or walks: the axis of the torso, and the middle.
    Upright(Point2, Point2),
    /// Of somebody who sits far away: around the middle of what is seen.
    Seated(Point2),
}

impl Body {
    fn upright(axis: Point2, context: &SweepContext) -> Self {
        let sensor = context.sensor_in_base.translation;
        let (dx, dy) = (axis.x_m - sensor.x_m, axis.y_m - sensor.y_m);
        let share = BEHIND_M / libm::sqrtf(dx * dx + dy * dy).max(BEHIND_M);
        Self::Upright(axis, Point2::new(axis.x_m + share * dx, axis.y_m + share * dy))
    }

    /// Whether a return belongs to it; `is_own` says that it belongs to the cluster that the body was found
    /// in.
    fn takes(&self, point: &Point3, is_own: bool) -> bool {
        let at = Point2::new(point.x_m, point.y_m);
        match self {
            Self::Upright(_, middle) if middle.distance(at) <= BODY_M => true,
            Self::Upright(axis, _) if point.z_m < KNEE_M => axis.distance(at) <= STRIDE_M,
            Self::Upright(axis, _) => is_own && point.z_m >= TORSO_M && axis.distance(at) <= SHOULDERS_M,
            Self::Seated(middle) => is_own && middle.distance(at) <= SEATED_M,
        }
    }
}

impl<P: Profile> PeoplePipelineOf<P> {
    /// Lowest and highest coordinates of the body of a detection of the newest sweep, by its index; robot frame, metres.
    /// `sweep` and `context` are those of that sweep. One or two passes over the sweep.
    #[must_use]
    pub fn body_bounds(
        &self,
        sweep: &SweepOf<P>,
        context: &SweepContext,
        detection: usize,
    ) -> Option<[Point3; 2]> {
        let bounds = self.bounds(detection)?;
        let hangs = bounds[0].z_m > HANGING_M;
        let body = match self.torso_axis(sweep, context, &bounds) {
            Some(axis) => Body::upright(axis, context),
            None if hangs => Body::Seated(middle_of(&bounds)),
            None => return Some(bounds),
        };
        let mut growing = Growing::default();
        self.returns(sweep, context, |point| {
            let is_own = is_within(&point, &bounds) || hangs && point.z_m < bounds[0].z_m;
            // What hangs over the head is no part of anybody.
            if point.z_m <= bounds[1].z_m + MARGIN_M && body.takes(&point, is_own) {
                growing.include(point);
            }
        });
        growing.bounds
    }

    /// Where the torso stands, of somebody who stands.
    fn torso_axis(&self, sweep: &SweepOf<P>, context: &SweepContext, bounds: &[Point3; 2]) -> Option<Point2> {
        let (mut sum, mut returns) = (Point2::default(), 0_u16);
        self.returns(sweep, context, |point| {
            if point.z_m >= TORSO_M && is_within(&point, bounds) {
                sum = Point2::new(sum.x_m + point.x_m, sum.y_m + point.y_m);
                returns = returns.saturating_add(1);
            }
        });
        let count = f32::from(returns);
        (returns >= AXIS_MIN).then(|| Point2::new(sum.x_m / count, sum.y_m / count))
    }

    /// Every return above the floor, robot frame.
    fn returns(&self, sweep: &SweepOf<P>, context: &SweepContext, mut found: impl FnMut(Point3)) {
        let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
        for column in sweep.used_columns().iter().filter(|column| column.measured) {
            let frame = frames.column(column);
            for (raw, angle) in column.range_raw.iter().zip(self.angles.rings) {
                let point = frame.point(*raw, angle);
                if *raw != 0 && point.z_m >= FLOOR_M {
                    found(point);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::vlp16_tests::{SENSOR_M, seen, standing};

    /// Farther than what belongs together.
    const FOOT_AHEAD_M: f32 = 0.3;

    /// How far the beam of a direction goes: somebody 4 m ahead, half a metre broad and 1.7 m tall, who touches a trolley of
    /// three quarters of a metre on the left; one foot stands a step before the other.
    fn range_m(bearing: f32, elevation: f32) -> f32 {
        let (left_m, distance_m) = (4.0 * libm::tanf(bearing), 4.0 / libm::cosf(bearing));
        let height_m = SENSOR_M + distance_m * libm::tanf(elevation);
        let body = left_m.abs() < 0.25 && (0.0..1.7).contains(&height_m);
        let trolley = (0.25..1.0).contains(&left_m) && (0.45..0.95).contains(&height_m);
        let foot_m = 4.0 - FOOT_AHEAD_M;
        let foot_height_m = SENSOR_M + foot_m / libm::cosf(bearing) * libm::tanf(elevation);
        let is_foot = (foot_m * libm::tanf(bearing)).abs() < 0.06 && (0.0..0.3).contains(&foot_height_m);
        if is_foot {
            return foot_m / libm::cosf(bearing) / libm::cosf(elevation);
        }
        if body || trolley { distance_m / libm::cosf(elevation) } else { 0.0 }
    }

    #[test]
    fn customer_box_ends_at_the_trolley() {
        let (pipeline, sweep) = seen(range_m);
        let context = standing();
        assert_eq!(pipeline.detections().len(), 1, "{:?}", pipeline.detections());
        let cluster = pipeline.clusters().iter().max_by_key(|cluster| cluster.points).expect("two clusters");
        let (whole_low, whole) = (cluster.lower, cluster.upper);
        assert!(whole.y_m > 0.9, "one cluster with the trolley: {whole:?}");
        let [lower, upper] = pipeline.body_bounds(&sweep, &context, 0).expect("somebody was found");
        assert!(upper.y_m < 0.45 && lower.y_m < -0.2, "{lower:?} {upper:?}");
        assert!(whole_low.x_m > 3.9, "the foot is no part of that cluster: {whole_low:?}");
        assert!(lower.x_m < 3.75, "the foot ahead belongs to the body: {lower:?}");
        assert!(lower.z_m < 0.5 && upper.z_m > 1.4, "from foot to head: {lower:?} {upper:?}");
        assert_eq!(pipeline.body_bounds(&sweep, &context, 1), None);
    }
}
