//! Boxes of people in the panoramic picture erase what the window holds of them, and mask what would be inserted.
//!
//! A surface within a box becomes a person's place: it is no surface any more, it shows on the debug layer, and the map of
//! the floor keeps it blocked until it expires (Dalmedico et al. 2019). Until the next picture new points within
//! the box mark places as well and are not inserted as surfaces.

use floorguard_types::geometry::{Point2, Point3, Pose2, wrap_angle};
use floorguard_types::time::{Age, Stamp};
use heapless::Vec;

use super::capacities::{PERSON_BOXES_MAX, WINDOW_BEAMS_MAX};
use super::cell::{CellContent, PERSON_EXPIRY_US, PERSON_TICKS, WindowCell, tick_of};
use super::compensation::{Rigid, is_finite};
use super::error::BoxError;
use super::face::Face;
use super::fusion::ScanPoint;
use super::geometry::FACE_CELLS_MAX;
use super::window::SlidingWindow;

/// Boxes are widened by this to both sides, radians (3°): column and picture are not of the same time.
const INFLATION_RAD: f32 = 0.052_36;
/// A box masks for so long: until then the next picture has come, or the person has left the widened box.
pub const BOX_VALID_US: u64 = 500_000;
/// Clocks of camera and lidar may differ by this.
const FUTURE_MAX_US: u64 = 20_000;
/// Narrower boxes show no person, wider ones are no box, radians.
const WIDTH_RAD: core::ops::RangeInclusive<f32> = 1.0e-4..=core::f32::consts::PI;
/// Expired places are searched at most so often.
const EXPIRY_EVERY_US: u64 = 500_000;
/// Steeper boxes end here, radians: the tangent stays finite.
const STEEP_RAD: f32 = 1.57;
/// A body with an arm stretched out, metres.
const BODY_DEPTH_M: f32 = 0.6;

/// A person in the picture: directions from the camera in the base frame, radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PersonBox {
    /// Right end.
    pub azimuth_min_rad: f32,
    /// Left end; smaller than the right end where the box lies across ±180°.
    pub azimuth_max_rad: f32,
    /// Lower end, up positive.
    pub elevation_min_rad: f32,
    /// Upper end.
    pub elevation_max_rad: f32,
}

/// The people of one picture.
#[derive(Clone, Copy, Debug)]
pub struct PersonBoxes<'a> {
    /// When the picture was taken.
    pub stamp: Stamp,
    /// Where the base stood then.
    pub base_in_odometry: Pose2,
    /// At most 16; none is an answer too.
    pub boxes: &'a [PersonBox],
}

/// A box in odometry.
#[derive(Clone, Copy, Debug, PartialEq)]
struct KeptBox {
    middle_rad: f32,
    half_width_rad: f32,
    /// Directions of its ends, and of its middle.
    right: Point2,
    left: Point2,
    middle: Point2,
    /// Tangents of its elevations.
    lower: f32,
    upper: f32,
}

/// How directions of the window turn into those of odometry, and from which height boxes are seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxFrame {
    sin: f32,
    cos: f32,
    camera_height_m: f32,
}

/// The boxes of the newest picture, and when places of people have to be looked at.
#[derive(Clone, Debug)]
pub(super) struct People {
    boxes: Vec<KeptBox, PERSON_BOXES_MAX>,
    stamp: Option<Stamp>,
    next_expiry: Option<Stamp>,
}

impl People {
    pub(super) const fn new() -> Self {
        Self { boxes: Vec::new(), stamp: None, next_expiry: None }
    }

    /// Places of people were written.
    pub(super) fn note_marks(&mut self, now: Stamp) {
        if self.next_expiry.is_none() {
            self.next_expiry = Some(now.plus_micros(PERSON_EXPIRY_US));
        }
    }

    /// Whether the boxes hold at a time: not too old, and not of the future by more than the clocks may differ.
    fn is_valid(&self, now: Stamp) -> bool {
        let valid = |stamp: Stamp| match stamp.age(now) {
            Age::Past(us) => us <= BOX_VALID_US,
            Age::Future(us) => us <= BOX_VALID_US,
        };
        !self.boxes.is_empty() && self.stamp.is_some_and(valid)
    }

    /// A point of the window's frame lies within a box. Two cross products and two comparisons of squares a box.
    pub(super) fn masks(&self, frame: Option<BoxFrame>, point: Point3) -> bool {
        let Some(frame) = frame else { return false };
        let (x, y) =
            (frame.cos * point.x_m - frame.sin * point.y_m, frame.sin * point.x_m + frame.cos * point.y_m);
        let up_m = point.z_m - frame.camera_height_m;
        self.boxes.iter().any(|kept| kept.contains(Point3::new(x, y, up_m)))
    }

    /// A direction in odometry lies in the middle half of a box.
    fn is_middle(&self, azimuth_rad: f32) -> bool {
        self.boxes.iter().any(|kept| {
            let from_middle_rad = libm::fabsf(wrap_angle(azimuth_rad - kept.middle_rad));
            from_middle_rad <= 0.5 * (kept.half_width_rad - INFLATION_RAD)
        })
    }

    fn check(&self, boxes: &PersonBoxes<'_>, now: Stamp) -> Result<(), BoxError> {
        if !is_finite(boxes.base_in_odometry) {
            return Err(BoxError::NotFinite);
        }
        if boxes.boxes.len() > PERSON_BOXES_MAX {
            return Err(BoxError::TooMany { boxes: boxes.boxes.len() });
        }
        if let Some(newest) = self.stamp
            && boxes.stamp <= newest
        {
            return Err(BoxError::OutOfOrder { behind_us: boxes.stamp.past_us(newest) });
        }
        match boxes.stamp.age(now) {
            Age::Past(age_us) if age_us > BOX_VALID_US => return Err(BoxError::Stale { age_us }),
            Age::Future(ahead_us) if ahead_us > FUTURE_MAX_US => return Err(BoxError::Future { ahead_us }),
            Age::Past(_) | Age::Future(_) => {}
        }
        let is_wrong = |one: &PersonBox| KeptBox::of(one, 0.0).is_none();
        match boxes.boxes.iter().take(PERSON_BOXES_MAX).position(is_wrong) {
            Some(index) => Err(BoxError::Bounds { index }),
            None => Ok(()),
        }
    }
}

impl KeptBox {
    fn of(one: &PersonBox, heading_rad: f32) -> Option<Self> {
        let width_rad = wrap_angle(one.azimuth_max_rad - one.azimuth_min_rad);
        let is_legal = one.azimuth_min_rad.is_finite()
            && one.azimuth_max_rad.is_finite()
            && WIDTH_RAD.contains(&width_rad)
            && one.elevation_min_rad < one.elevation_max_rad;
        if !is_legal {
            return None;
        }
        let middle_rad = wrap_angle(one.azimuth_min_rad + 0.5 * width_rad + heading_rad);
        let half_width_rad = 0.5 * width_rad + INFLATION_RAD;
        let direction = |azimuth_rad: f32| {
            let (sin, cos) = libm::sincosf(azimuth_rad);
            Point2::new(cos, sin)
        };
        let slope = |elevation_rad: f32| libm::tanf(elevation_rad.clamp(-STEEP_RAD, STEEP_RAD));
        Some(Self {
            middle_rad,
            half_width_rad,
            right: direction(middle_rad - half_width_rad),
            left: direction(middle_rad + half_width_rad),
            middle: direction(middle_rad),
            lower: slope(one.elevation_min_rad),
            upper: slope(one.elevation_max_rad),
        })
    }

    /// A point from the camera, axes of odometry. Boxes are narrower than half of the circle but for the widening: the ends
    /// decide on the side of the middle, whose side the point is on.
    fn contains(&self, point: Point3) -> bool {
        let (x, y) = (point.x_m, point.y_m);
        let ahead = self.middle.x_m * x + self.middle.y_m * y;
        let is_left_of_right = self.right.x_m * y - self.right.y_m * x >= 0.0;
        let is_right_of_left = x * self.left.y_m - y * self.left.x_m >= 0.0;
        let is_wide = self.half_width_rad > core::f32::consts::FRAC_PI_2;
        let is_between = if is_wide {
            is_left_of_right || is_right_of_left || ahead >= 0.0
        } else {
            is_left_of_right && is_right_of_left && ahead >= 0.0
        };
        let distance_squared = x * x + y * y;
        is_between
            && is_above(point.z_m, self.lower, distance_squared)
            && is_above(-point.z_m, -self.upper, distance_squared)
    }
}

/// `up ≥ slope · distance`, of the distance's square.
fn is_above(up_m: f32, slope: f32, distance_squared: f32) -> bool {
    let (up, limit) = (up_m * up_m, slope * slope * distance_squared);
    if slope >= 0.0 { up_m >= 0.0 && up >= limit } else { up_m >= 0.0 || up <= limit }
}

impl<S: AsRef<[WindowCell]> + AsMut<[WindowCell]>> SlidingWindow<S> {
    /// Takes the people of a picture: erases surfaces within their boxes, and masks new points until the boxes are half a
    /// second old or the next picture comes. Returns how many cells were erased. Cost: one pass over all cells, 20
    /// operations for each surface and box; none without boxes.
    ///
    /// # Errors
    /// [`BoxError`]: nothing was erased, and the boxes before stay valid.
    pub fn take_people(&mut self, boxes: &PersonBoxes<'_>, now: Stamp) -> Result<u32, BoxError> {
        self.people.check(boxes, now)?;
        self.people.stamp = Some(boxes.stamp);
        self.people.boxes.clear();
        for one in boxes.boxes.iter().take(PERSON_BOXES_MAX) {
            if let Some(kept) = KeptBox::of(one, boxes.base_in_odometry.heading_rad) {
                // Not more than were counted: never full.
                let _full = self.people.boxes.push(kept);
            }
        }
        self.expire(now);
        Ok(self.erase(now))
    }

    fn erase(&mut self, now: Stamp) -> u32 {
        let Some(frame) = self.box_frame(now) else { return 0 };
        let mut erased = 0_u32;
        for face in Face::ALL {
            for index in 0..self.geometry.face_cells().min(FACE_CELLS_MAX) {
                let Some(cell) = self.cells(face).get(index) else { break };
                if cell.content != CellContent::Surface {
                    continue;
                }
                let point = face.point(self.geometry.place(index, cell));
                if self.people.masks(Some(frame), point)
                    && let Some(cell) = self.cells_mut(face).get_mut(index)
                {
                    (cell.content, cell.tick) = (CellContent::Person, tick_of(now));
                    erased = erased.saturating_add(1);
                }
            }
        }
        if erased > 0 {
            self.people.note_marks(now);
        }
        self.counters.cells_erased = self.counters.cells_erased.saturating_add(erased);
        erased
    }

    /// Marks the points of the scan that lie within a box.
    pub(super) fn mask(&mut self, now: Stamp) {
        let Some(frame) = self.box_frame(now) else { return };
        for place in 0..self.points.len().min(WINDOW_BEAMS_MAX) {
            let is_person =
                self.points.get(place).is_some_and(|scanned| self.people.masks(Some(frame), scanned.point));
            if let Some(scanned) = self.points.get_mut(place) {
                scanned.is_person = is_person;
            }
        }
    }

    /// How to compare points of the window with the boxes; `None` without a valid box.
    pub(super) fn box_frame(&self, now: Stamp) -> Option<BoxFrame> {
        let (sin, cos) = libm::sincosf(self.frame_in_odometry().heading_rad);
        let camera_height_m = self.options.camera_height_m;
        self.people.is_valid(now).then_some(BoxFrame { sin, cos, camera_height_m })
    }

    /// Returns of the newest scan that belong to people, in odometry: for [`super::MovementArrows`]. Only the middle half of a
    /// box counts, and only what is not far behind the nearest return there: beside a person the box shows the wall.
    pub fn person_returns(&self) -> impl Iterator<Item = Point2> + '_ {
        let odometry_from_window = Rigid::of(self.frame_in_odometry());
        let in_middle = move |scanned: &&ScanPoint| {
            let azimuth_rad = libm::atan2f(scanned.point.y_m, scanned.point.x_m);
            scanned.is_person && self.people.is_middle(azimuth_rad + self.frame_in_odometry().heading_rad)
        };
        let range_m = |scanned: &ScanPoint| Point2::new(scanned.point.x_m, scanned.point.y_m).norm();
        let people = self.points.iter().filter(in_middle);
        let nearest_m = people.clone().map(range_m).fold(f32::INFINITY, f32::min);
        people
            .filter(move |scanned| range_m(scanned) <= nearest_m + BODY_DEPTH_M)
            .map(move |scanned| Point2::new(scanned.point.x_m, scanned.point.y_m))
            .map(move |point| odometry_from_window.transform_flat(point))
    }

    /// Lets places of people expire that were seen as that two seconds ago or earlier. Scans and boxes call it; call it where
    /// neither comes. Cost: one pass over all cells, at most twice a second.
    pub fn expire(&mut self, now: Stamp) {
        if self.people.next_expiry.is_none_or(|due| now < due) {
            return;
        }
        let (mut expired, mut left) = (0_u32, 0_u32);
        for face in Face::ALL {
            for cell in self.cells_mut(face).iter_mut().filter(|cell| cell.content == CellContent::Person) {
                if cell.age_ticks(now) >= PERSON_TICKS {
                    *cell = WindowCell::EMPTY;
                    expired = expired.saturating_add(1);
                } else {
                    left = left.saturating_add(1);
                }
            }
        }
        self.people.next_expiry = (left > 0).then(|| now.plus_micros(EXPIRY_EVERY_US));
        self.counters.people_expired = self.counters.people_expired.saturating_add(expired);
    }
}
