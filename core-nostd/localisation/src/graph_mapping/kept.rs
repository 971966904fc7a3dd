//! Scans that are kept, with some of their returns.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::{count_f32, nearest_f32, saturating_i16, saturating_usize, short_usize};
use heapless::Vec;

/// Units of a short point in a metre: 2 mm, ±65 m.
const UNITS_PER_METRE: f32 = 500.0;

/// Kept returns lie at least so far apart, metres; where they are more than fit, farther by this factor until they fit.
const APART_LEAST_M: f32 = 0.05;
const APART_GROWTH: f32 = 1.4;
const TRIES: usize = 16;
/// Two returns lie on one surface if they are so many times as far apart as kept returns are at least, and this share of their range.
const GAP_FACTOR: f32 = 1.3;
const GAP_SHARE: f32 = 0.08;
/// Points between them, metres and at most.
const FILLED_M: f32 = 0.15;
const PARTS_MAX: usize = 12;

/// A return in the scanner's frame, in steps of 2 mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShortPoint {
    x: i16,
    y: i16,
}

impl From<Point2> for ShortPoint {
    fn from(point: Point2) -> Self {
        let unit = |value_m: f32| saturating_i16(libm::roundf(value_m * UNITS_PER_METRE));
        Self { x: unit(point.x_m), y: unit(point.y_m) }
    }
}

impl From<ShortPoint> for Point2 {
    fn from(point: ShortPoint) -> Self {
        let metres = |value: i16| nearest_f32(value) * (1.0 / UNITS_PER_METRE);
        Self::new(metres(point.x), metres(point.y))
    }
}

/// A kept scan: 24 bytes and 4 for each return.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptScan<const POINTS: usize> {
    /// The scanner in the map.
    pub pose: Pose2,
    /// Path from the first scan to here, metres.
    pub path_m: f32,
    /// Distance that its returns have at least from the one before, metres.
    pub apart_m: f32,
    /// Returns in the scanner's frame, in the order of the beams.
    pub points: Vec<ShortPoint, POINTS, u16>,
}

impl<const POINTS: usize> KeptScan<POINTS> {
    /// Keeps as many returns as fit, as evenly along the surfaces as they allow.
    pub(super) fn new(pose: Pose2, path_m: f32, returns: &[Point2]) -> Self {
        let mut scan = Self { pose, path_m, apart_m: APART_LEAST_M, points: Vec::new() };
        for _ in 0..TRIES {
            if scan.thin(returns) {
                break;
            }
            scan.apart_m *= APART_GROWTH;
        }
        scan
    }

    /// Takes returns that lie so far from the one before; false: they do not all fit.
    fn thin(&mut self, returns: &[Point2]) -> bool {
        self.points.clear();
        let mut last = None::<Point2>;
        for point in returns {
            if last.is_some_and(|last| last.distance(*point) < self.apart_m) {
                continue;
            }
            last = Some(*point);
            if self.points.push(ShortPoint::from(*point)).is_err() {
                return false;
            }
        }
        true
    }

    /// The middle of its returns, in the map: what it looks at.
    pub(super) fn middle(&self) -> Point2 {
        let count = count_f32(self.points.len().max(1));
        let (mut x_m, mut y_m) = (0.0, 0.0);
        for point in self.returns() {
            x_m += point.x_m / count;
            y_m += point.y_m / count;
        }
        self.pose.transform(Point2::new(x_m, y_m))
    }

    /// Neighbours that lie on one surface as far as one can see.
    pub(super) fn lines(&self) -> impl Iterator<Item = [Point2; 2]> + '_ {
        let next = self.points.get(1..).unwrap_or_default().iter().map(|point| Point2::from(*point));
        self.returns()
            .zip(next)
            .filter(|(from, to)| self.is_one_surface(*from, *to))
            .map(|(from, to)| [from, to])
    }

    /// The returns in the scanner's frame, and points between two of them that lie on one surface as far as one can see.
    pub fn surfaces(&self) -> impl Iterator<Item = Point2> + '_ {
        let gaps = self.lines().flat_map(|[from, to]| {
            let parts = saturating_usize(from.distance(to) / FILLED_M).min(PARTS_MAX);
            (1..=parts).map(move |part| {
                let share = count_f32(part) / count_f32(parts.saturating_add(1));
                Point2::new(from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m))
            })
        });
        self.returns().chain(gaps)
    }

    /// Two neighbours that are hardly farther apart than all are.
    fn is_one_surface(&self, from: Point2, to: Point2) -> bool {
        from.distance(to) < GAP_FACTOR * self.apart_m + GAP_SHARE * from.norm().min(to.norm())
    }

    /// The returns in the scanner's frame.
    pub fn returns(&self) -> impl Iterator<Item = Point2> + '_ {
        self.points.iter().map(|point| Point2::from(*point))
    }
}

/// The number of a scan as an index.
pub(super) const fn index(number: u16) -> usize {
    short_usize(number)
}
