//! Which places around a scanner have stood and which were seen through, from its own scans alone. Source: book, Legs:
//! Places.
//!
//! The lattice is fixed to the frame in which the scanner's pose is known and wraps around at the edge of its window.
//! The window is that of a computer's memory: 80 KiB.

use crate::legs::PlaceEvidence;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::{
    count_f32, exact_usize, nearest_f32, saturating_i32, truncating_u8, truncating_u32,
};
use floorguard_types::profile::{Entry, Of, Profile, Size, Table, TableOf};
use floorguard_types::sensing::{BeamReturn, ScanOf};

/// Edge of a place, metres.
const PLACE_M: f32 = 0.1;
/// A ray goes free up to this far before its return, metres.
const BEFORE_RETURN_M: f32 = 0.2;
/// Observations of a place that are counted; then both counts are halved, so that older ones count for less.
const OBSERVATIONS_MAX: u8 = 250;
/// Observations that agree with nothing, added to both counts: the first observations say less.
const PRIOR_OBSERVATIONS: f32 = 2.0;
/// A return at a place with this share of returns before lies on what has stood.
const STOOD_MIN: f32 = 0.4;
/// Share of the returns that must, and the least number of returns: else the scanner moves unknown to us.
const SETTLED_MIN: f32 = 0.5;
const RETURNS_MIN: f32 = 20.0;

/// More observations than this say no more.
const OBSERVATIONS_COUNTED: f32 = 30.0;

/// A place. Its tags tell it from those that wrap onto the same cell; they repeat after 256 windows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    tags: [u8; 2],
    returns: u8,
    seen_through: u8,
    /// The scan that counted it last.
    counted_by: u8,
}

impl Entry for Place {
    const BLANK: Self = Self { tags: [0; 2], returns: 0, seen_through: 0, counted_by: 0 };
}

/// Column and row of a place.
type Cell = (i32, i32);

/// The places around one scanner, `S` along each side of the window.
///
/// ```
/// use floorguard_perception::any_scanner::Places;
/// use floorguard_types::{geometry::{Point2, Pose2}, sensing::{BeamReturn, Scan}};
///
/// // A wall 3 m away, seen ten times.
/// let mut scan = Scan { first_angle_rad: -0.3, step_rad: 0.01, ..Scan::EMPTY };
/// scan.beams.extend((0..60).map(|_| BeamReturn::Hit(3_000)));
/// let mut places = Box::new(Places::new());
/// for _ in 0..10 {
///     places.look(&scan, Pose2::default());
///     places.learn(&scan, |_| false);
/// }
/// places.look(&scan, Pose2::default());
/// let wall = places.evidence(&[Point2::new(3.0, 0.0)]).unwrap();
/// let before_it = places.evidence(&[Point2::new(2.0, 0.0)]).unwrap();
/// assert!(wall.stood > 0.8 && wall.seen_through == 0.0);
/// assert!(before_it.seen_through > 0.8);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PlacesOf<S: Size> {
    /// By y, then by x.
    places: TableOf<TableOf<Place, S>, S>,
    scanner: Pose2,
    is_settled: bool,
    settled_share: f32,
    scan: u8,
}

/// The places of a computer: 12.8 m along each side.
pub type Places = PlacesOf<Of<128>>;

impl<S: Size> Default for PlacesOf<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Size> PlacesOf<S> {
    /// Returns farther from the scanner than this are left out, metres.
    const REACH_M: f32 = count_f32(S::N) * PLACE_M * 0.5 - 2.0 * PLACE_M;

    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            places: Entry::BLANK,
            scanner: Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 },
            is_settled: false,
            settled_share: 0.0,
            scan: 0,
        }
    }

    /// Judges whether a scan fits what was seen before, with its scanner at this pose of the fixed frame. It does when half
    /// of its returns lie where something has stood: a scanner whose motion is not known has no places. Linear.
    pub fn look<P: Profile>(&mut self, scan: &ScanOf<P>, scanner_in_fixed: Pose2) {
        self.scanner = scanner_in_fixed;
        let (mut returns, mut on_standing) = (0.0_f32, 0.0_f32);
        for (index, beam) in scan.beams.iter().enumerate() {
            let Some((range_m, true)) = reached(*beam).filter(|(range_m, _)| *range_m < Self::REACH_M) else {
                continue;
            };
            let ray = Ray::of(scan, scanner_in_fixed, index);
            returns += 1.0;
            on_standing += if self.stood(ray.at(range_m)) > STOOD_MIN { 1.0 } else { 0.0 };
        }
        self.settled_share = if returns >= RETURNS_MIN { on_standing / returns } else { 0.0 };
        self.is_settled = self.settled_share > SETTLED_MIN;
    }

    /// Share of the newest scan's returns that lie where something has stood, 0…1; 0 with too few returns.
    #[must_use]
    pub const fn settled_share(&self) -> f32 {
        self.settled_share
    }

    /// The newest scan fits what was seen before.
    #[must_use]
    pub const fn is_settled(&self) -> bool {
        self.is_settled
    }

    /// What earlier scans showed at some points of the scanner's frame; `None` where the newest scan does not fit them.
    #[must_use]
    pub fn evidence(&self, points: &[Point2]) -> Option<PlaceEvidence> {
        if !self.is_settled || points.is_empty() {
            return None;
        }
        let mut sum = PlaceEvidence::default();
        for point in points {
            let place = self.scanner.transform(*point);
            sum.stood += self.stood(place);
            if let Some(known) = self.at(cell(place)) {
                let observations = nearest_f32(known.returns) + nearest_f32(known.seen_through);
                sum.seen_through += nearest_f32(known.seen_through) / (observations + PRIOR_OBSERVATIONS);
                sum.observations += observations;
            }
        }
        let count = nearest_f32(points.len());
        Some(PlaceEvidence {
            stood: sum.stood / count,
            seen_through: sum.seen_through / count,
            observations: (sum.observations / count).min(OBSERVATIONS_COUNTED),
        })
    }

    /// Takes in the scan that was looked at. Returns of which `is_left_out` holds (points of the fixed frame) are not
    /// learned: a person who stands does not become furniture. Beams × places along a ray.
    pub fn learn<P: Profile>(&mut self, scan: &ScanOf<P>, is_left_out: impl Fn(Point2) -> bool) {
        // 0 is that of a place nobody looked at.
        self.scan = self.scan.wrapping_add(1).max(1);
        for (index, beam) in scan.beams.iter().enumerate() {
            let Some((range_m, true)) = reached(*beam).filter(|(range_m, _)| *range_m < Self::REACH_M) else {
                continue;
            };
            let place = Ray::of(scan, self.scanner, index).at(range_m);
            if !is_left_out(place) {
                self.count(cell(place), true);
            }
        }
        for (index, beam) in scan.beams.iter().enumerate() {
            let Some((range_m, _)) = reached(*beam) else { continue };
            let ray = Ray::of(scan, self.scanner, index);
            let free_m = (range_m - BEFORE_RETURN_M).min(Self::REACH_M);
            for step in 1..S::N {
                let along_m = nearest_f32(step) * (0.7 * PLACE_M);
                if along_m >= free_m {
                    break;
                }
                self.count(cell(ray.at(along_m)), false);
            }
        }
    }

    /// Counts a look at a place, once a scan.
    fn count(&mut self, cell: Cell, has_return: bool) {
        let (scan, tags) = (self.scan, tags::<S>(cell));
        let row = self.places.get_mut(wrap::<S>(cell.1));
        let Some(place) = row.and_then(|row| row.get_mut(wrap::<S>(cell.0))) else { return };
        if place.tags != tags {
            *place = Place { tags, ..Place::BLANK };
        }
        if place.counted_by == scan {
            return;
        }
        place.counted_by = scan;
        let count = if has_return { &mut place.returns } else { &mut place.seen_through };
        *count = count.saturating_add(1);
        if *count >= OBSERVATIONS_MAX {
            (place.returns, place.seen_through) = (place.returns / 2, place.seen_through / 2);
        }
    }

    fn at(&self, cell: Cell) -> Option<&Place> {
        let place = self.places.get(wrap::<S>(cell.1))?.get(wrap::<S>(cell.0))?;
        (place.tags == tags::<S>(cell)).then_some(place)
    }

    /// Share of the observations with a return at a point or half a place beside it: a return on a border falls on either side.
    fn stood(&self, point: Point2) -> f32 {
        let half_m = 0.5 * PLACE_M;
        [(-half_m, -half_m), (-half_m, half_m), (half_m, -half_m), (half_m, half_m)]
            .into_iter()
            .filter_map(|(x_m, y_m)| self.at(cell(Point2::new(point.x_m + x_m, point.y_m + y_m))))
            .map(|place| {
                let returns = nearest_f32(place.returns);
                returns / (returns + nearest_f32(place.seen_through) + PRIOR_OBSERVATIONS)
            })
            .fold(0.0, f32::max)
    }
}

/// A beam in the fixed frame.
#[derive(Clone, Copy, Debug)]
struct Ray {
    from: Point2,
    direction: Point2,
}

impl Ray {
    fn of<P: Profile>(scan: &ScanOf<P>, scanner: Pose2, index: usize) -> Self {
        let bearing_rad = scanner.heading_rad + scan.first_angle_rad + scan.step_rad * nearest_f32(index);
        let (sin, cos) = libm::sincosf(bearing_rad);
        Self { from: Point2::new(scanner.x_m, scanner.y_m), direction: Point2::new(cos, sin) }
    }

    fn at(&self, range_m: f32) -> Point2 {
        let Self { from, direction } = self;
        Point2::new(from.x_m + range_m * direction.x_m, from.y_m + range_m * direction.y_m)
    }
}

/// How far a beam got, metres, and whether it ended on something.
fn reached(beam: BeamReturn) -> Option<(f32, bool)> {
    match beam {
        BeamReturn::Hit(range_mm) if range_mm > 0 => Some((f32::from(range_mm) * 1.0e-3, true)),
        BeamReturn::Free(range_mm) => Some((f32::from(range_mm) * 1.0e-3, false)),
        BeamReturn::Hit(_) | BeamReturn::Unknown => None,
    }
}

fn cell(point: Point2) -> Cell {
    let index = |metres: f32| saturating_i32(libm::floorf(metres / PLACE_M));
    (index(point.x_m), index(point.y_m))
}

/// The lattice wraps around.
fn wrap<S: Size>(index: i32) -> usize {
    const { assert!(S::N.is_power_of_two()) };
    exact_usize(truncating_u32(index)) & (S::N - 1)
}

/// Which of the windows beside each other a place is in.
fn tags<S: Size>(cell: Cell) -> [u8; 2] {
    let shift = S::N.trailing_zeros();
    [cell.0, cell.1].map(|index| truncating_u8(index.wrapping_shr(shift)))
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use floorguard_types::sensing::Scan;

    use super::*;

    /// A wall 4 m ahead; a post of three beams before it, if there is one.
    fn room(post_mm: Option<u16>) -> Scan {
        let mut scan = Scan { first_angle_rad: -0.5, step_rad: 0.01, ..Scan::EMPTY };
        for index in 0..100 {
            let range_mm = post_mm.filter(|_| (49..52).contains(&index)).unwrap_or(4_000);
            scan.beams.push(BeamReturn::Hit(range_mm)).expect("room");
        }
        scan
    }

    fn seen(places: &mut Places, scan: &Scan, times: usize) {
        for _ in 0..times {
            places.look(scan, Pose2::default());
            places.learn(scan, |_| false);
        }
    }

    #[test]
    fn who_enters_free_space_differs_from_what_stood() {
        let (with_post, without) = (room(Some(2_000)), room(None));
        let post = [Point2::new(2.0, 0.0)];
        let mut places = Box::new(Places::new());
        seen(&mut places, &with_post, 20);
        places.look(&with_post, Pose2::default());
        let furniture = places.evidence(&post).expect("it fits");
        assert!(furniture.stood > 0.9 && furniture.seen_through == 0.0, "{furniture:?}");
        let mut places = Box::new(Places::new());
        seen(&mut places, &without, 20);
        places.look(&with_post, Pose2::default());
        let entered = places.evidence(&post).expect("it fits");
        assert!(entered.stood == 0.0 && entered.seen_through > 0.9, "{entered:?}");
        assert!((entered.observations - 20.0).abs() < 1.0e-3);
    }

    /// Who stands in the room is left out, so the place stays as it was before.
    #[test]
    fn who_is_left_out_never_becomes_furniture() {
        let (with_post, without) = (room(Some(2_000)), room(None));
        let mut places = Box::new(Places::new());
        seen(&mut places, &without, 20);
        for _ in 0..400 {
            places.look(&with_post, Pose2::default());
            places.learn(&with_post, |point| point.norm() < 3.0);
        }
        let stands = places.evidence(&[Point2::new(2.0, 0.0)]).expect("it fits");
        assert!(stands.stood == 0.0, "{stands:?}");
    }

    /// A pose that jumps makes every return new: no evidence is given until the places are known again.
    #[test]
    fn unknown_motion_gives_no_evidence() {
        let scan = room(Some(2_000));
        let mut places = Box::new(Places::new());
        seen(&mut places, &scan, 20);
        places.look(&scan, Pose2::new(0.5, 0.3, 0.4));
        assert!(!places.is_settled());
        assert_eq!(places.evidence(&[Point2::new(2.0, 0.0)]), None);
    }

    /// A place and the one a window farther on share memory, not evidence.
    #[test]
    fn places_of_another_window_are_unknown() {
        let scan = room(Some(2_000));
        let mut places = Box::new(Places::new());
        seen(&mut places, &scan, 20);
        places.is_settled = true;
        places.scanner = Pose2::new(12.8, 0.0, 0.0);
        let beyond = places.evidence(&[Point2::new(2.0, 0.0)]).expect("as if it fitted");
        assert_eq!(beyond, PlaceEvidence::default());
        places.look(&scan, Pose2::new(f32::NAN, f32::INFINITY, 0.0));
        places.learn(&scan, |_| false);
        assert!(!places.is_settled());
    }
}
