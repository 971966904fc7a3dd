//! The 14 numbers of a segment, in the order of the published code. Source: book, Legs: Features.

use super::segments::Segment;
use floorguard_types::geometry::Point2;
use floorguard_types::number::nearest_f32;

/// Numbers of the vector.
pub const LEG_FEATURES: usize = 14;
/// The vector.
pub type LegFeatures = [f32; LEG_FEATURES];

/// What each number is.
pub const LEG_FEATURE_NAMES: [&str; LEG_FEATURES] = [
    "spread",
    "mean deviation from the median",
    "jump to the preceding beam",
    "jump to the next beam",
    "width",
    "linearity",
    "circularity",
    "radius",
    "boundary length",
    "mean angular difference",
    "mean curvature",
    "boundary regularity",
    "mean inscribed angle",
    "deviation of the inscribed angle",
];

/// Fewer returns have no shape.
pub(super) const POINTS_MIN: usize = 3;
/// More returns are no leg: at 0.1° a leg fills 190 beams at 0.3 m.
pub(super) const POINTS_MAX: usize = 256;
/// Radius of what is straight, metres: the fit of a line.
const RADIUS_MAX_M: f32 = 100.0;

/// The vector of a segment; `None` with fewer than three returns or more than 256. Quadratic in the returns (medians).
#[must_use]
pub fn leg_features(segment: &Segment<'_>) -> Option<LegFeatures> {
    let points = segment.points;
    if !(POINTS_MIN..=POINTS_MAX).contains(&points.len()) {
        return None;
    }
    let (first, last) = (points.first()?, points.last()?);
    let count = nearest_f32(points.len());
    let mean = Point2::new(
        points.iter().map(|point| point.x_m).sum::<f32>() / count,
        points.iter().map(|point| point.y_m).sum::<f32>() / count,
    );
    let median = Point2::new(median(points, |point| point.x_m), median(points, |point| point.y_m));
    let squares: f32 = points.iter().map(|point| square(point.distance(mean))).sum();
    let deviation: f32 = points.iter().map(|point| point.distance(median)).sum();
    let jump = |end: &Point2, beside: Option<Point2>| beside.map_or(0.0, |point| end.distance(point));
    let (linearity, circularity, radius_m) = fits(points, mean);
    let steps = points.iter().zip(points.iter().skip(1)).map(|(a, b)| a.distance(*b));
    let (length_m, step_squares) =
        steps.fold((0.0, 0.0), |(sum, sums), step| (sum + step, sums + step * step));
    let (turn, curvature) = corners(points);
    let inscribed =
        points.get(1..points.len().saturating_sub(1))?.iter().map(|point| angle(*first, *point, *last));
    let (inside, inside_squares) =
        inscribed.fold((0.0, 0.0), |(sum, sums), each| (sum + each, sums + each * each));
    Some([
        libm::sqrtf(squares / (count - 1.0)),
        deviation / count,
        jump(first, segment.previous),
        jump(last, segment.next),
        first.distance(*last),
        linearity,
        circularity,
        radius_m,
        length_m,
        turn / count,
        curvature / count,
        scatter(length_m, step_squares, count),
        inside / count,
        scatter(inside, inside_squares, count),
    ])
}

fn square(value: f32) -> f32 {
    value * value
}

/// √((Σ² − (Σ)²/n)/(n − 1)) with n the number of points, as coded.
fn scatter(sum: f32, squares: f32, count: f32) -> f32 {
    libm::sqrtf(((squares - sum * sum / count) / (count - 1.0)).max(0.0))
}

/// Mean of the two middle values (of the one, for an odd number).
fn median(points: &[Point2], of: impl Fn(&Point2) -> f32) -> f32 {
    let ranked = |rank: usize| {
        let has_rank = |value: f32| {
            let below = points.iter().filter(|point| of(point) < value).count();
            let not_above = points.iter().filter(|point| of(point) <= value).count();
            (below..not_above).contains(&rank)
        };
        points.iter().map(&of).find(|value| has_rank(*value)).unwrap_or(0.0)
    };
    let upper = points.len() / 2;
    let lower = points.len().saturating_sub(1) / 2;
    0.5 * (ranked(lower) + ranked(upper))
}

/// Squared distances from the best line, from the best circle, and the circle's radius. The algebraic circle does not
/// depend on the origin, so it is fitted around the mean, where single precision is enough.
fn fits(points: &[Point2], mean: Point2) -> (f32, f32, f32) {
    let centred = points.iter().map(|point| (point.x_m - mean.x_m, point.y_m - mean.y_m));
    let [mut xx, mut xy, mut yy, mut px, mut py] = [0.0_f32; 5];
    for (x, y) in centred.clone() {
        let square = x * x + y * y;
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        (px, py) = (px + 0.5 * x * square, py + 0.5 * y * square);
    }
    let half = 0.5 * (xx + yy);
    let root = libm::sqrtf(square(0.5 * (xx - yy)) + xy * xy);
    let linearity = (half - root).max(0.0);
    let determinant = xx * yy - xy * xy;
    if determinant <= 1.0e-6 * half * half {
        return (linearity, linearity, RADIUS_MAX_M);
    }
    let centre = ((px * yy - py * xy) / determinant, (py * xx - px * xy) / determinant);
    let mean_square = 2.0 * half / nearest_f32(points.len().max(1));
    let radius_m = libm::sqrtf((square(centre.0) + square(centre.1) + mean_square).max(0.0));
    let residual = |(x, y): (f32, f32)| square(radius_m - libm::hypotf(x - centre.0, y - centre.1));
    (linearity, centred.map(residual).sum(), radius_m.min(RADIUS_MAX_M))
}

/// Sums over the inner points: angle from the next to the preceding point, and curvature of the three (Heron).
fn corners(points: &[Point2]) -> (f32, f32) {
    let threes = points.iter().zip(points.iter().skip(1)).zip(points.iter().skip(2));
    let (mut turn, mut curvature) = (0.0, 0.0);
    for ((before, at), after) in threes {
        turn += angle(*after, *at, *before);
        let (a, b, c) = (before.distance(*at), at.distance(*after), after.distance(*before));
        let half = 0.5 * (a + b + c);
        let area = libm::sqrtf((half * (half - a) * (half - b) * (half - c)).max(0.0));
        let product = a * b * c;
        if product > 0.0 {
            curvature += 4.0 * area / product;
        }
    }
    (turn, curvature)
}

/// From `from` to `to` as seen from `at`, counter-clockwise, 0 to 2π.
fn angle(from: Point2, at: Point2, to: Point2) -> f32 {
    let (ax, ay) = (from.x_m - at.x_m, from.y_m - at.y_m);
    let (bx, by) = (to.x_m - at.x_m, to.y_m - at.y_m);
    let angle_rad = libm::atan2f(ax * by - ay * bx, ax * bx + ay * by);
    if angle_rad < 0.0 { angle_rad + core::f32::consts::TAU } else { angle_rad }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test values of the book, Legs: Features.
    #[test]
    fn a_leg_equals_the_vector() {
        let centre = Point2::new(2.0, 0.1);
        let towards = libm::atan2f(-centre.y_m, -centre.x_m);
        let mut points = [Point2::default(); 7];
        for (index, point) in points.iter_mut().enumerate() {
            // Bearing rises while the angle about the centre falls.
            let at = towards + (60.0 - 20.0 * index as f32).to_radians();
            *point = Point2::new(centre.x_m + 0.06 * libm::cosf(at), centre.y_m + 0.06 * libm::sinf(at));
        }
        let next = Point2::new(2.5 * libm::cosf(0.1), 2.5 * libm::sinf(0.1));
        let segment = Segment { points: &points, previous: Some(Point2::new(3.0, 0.0)), next: Some(next) };
        let found = leg_features(&segment).expect("seven points");
        let wanted = [
            0.041_109, 0.034_808, 1.028_424, 0.529_441, 0.103_923, 0.000_923, 0.0, 0.06, 0.125_027,
            2.493_328, 11.904_762, 0.007_876, 1.495_997, 1.021_96,
        ];
        for (index, (value, expected)) in found.iter().zip(wanted).enumerate() {
            let allowed = 1.0e-4 * f32::max(expected, 0.1);
            assert!((value - expected).abs() < allowed, "{}: {value}", LEG_FEATURE_NAMES[index]);
        }
    }

    #[test]
    fn degenerate_segments_have_finite_features_or_none() {
        let line = [0.0, 0.1, 0.2, 0.3].map(|y| Point2::new(2.0, y));
        let bare = |points| Segment { points, previous: None, next: None };
        let found = leg_features(&bare(&line)).expect("four points");
        assert!(found.iter().all(|value| value.is_finite()) && found[7] == RADIUS_MAX_M, "{found:?}");
        let same = [Point2::new(1.0, 1.0); 5];
        assert!(leg_features(&bare(&same)).expect("five points").iter().all(|value| value.is_finite()));
        assert_eq!(leg_features(&bare(&line[..2])), None);
    }
}
