//! Objects on the floor: connected pixels that are higher than it, row by row, in fixed memory.
//!
//! Three rows are open at once. A pixel counts where most of its neighbourhood is high too; neighbours belong
//! together unless their depths jump; parts that meet are united. What is too small to be anything is dropped, and
//! what does not fit is dropped farthest first and counted. Source: book, Floor and dirt: Objects.

use super::classes::{Judge, PixelClass};
use super::model::{FloorEstimate, FloorParameters};
use super::plane::dot;
use floorguard_types::number::nearest_f32;
use floorguard_types::profile::{Entry, List, ListOf, Native, Profile, Size, Table, TableOf};
use floorguard_types::sensing::DepthImage;
use floorguard_types::united_parts::{Absorb, UnitedParts};

/// Something on the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloorObject {
    /// Smallest place along the axes of the plane (right, forward), metres from the camera's foot point.
    pub low_m: [f32; 2],
    /// Largest place, the same.
    pub high_m: [f32; 2],
    /// Greatest height above the floor, metres.
    pub height_m: f32,
    /// Pixels.
    pub pixels: u32,
    /// Corner of the rectangle in the image: column, row.
    pub first_px: [u16; 2],
    /// Opposite corner, included.
    pub last_px: [u16; 2],
    /// Belief within 0..=1 that this is an object, from its height and its size.
    pub confidence: f32,
}

/// What one image shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FloorObjectsOf<P: Profile> {
    /// Nearest first.
    pub objects: ListOf<FloorObject, P::FloorObjects>,
    /// Objects and parts beyond the capacity: the list is incomplete.
    pub dropped: u32,
    /// Pixels of each class: floor, object, hole.
    pub counts: [u32; 3],
}

/// Objects in the memory of the target.
pub type FloorObjects = FloorObjectsOf<Native>;

/// The image has more columns than the capacity of the profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ImageTooWide {
    /// Columns of the image.
    pub width: usize,
    /// The most that fit.
    pub columns_max: usize,
}

impl core::fmt::Display for ImageTooWide {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { width, columns_max } = self;
        write!(formatter, "the image has {width} columns, but the capacity is {columns_max}")
    }
}

impl core::error::Error for ImageTooWide {}

/// Least pixels of an object in an image of 640 × 480 (book, Floor and dirt: Objects); as many square degrees in a
/// smaller one.
const PIXELS_MIN_VGA: u32 = 30;
/// Pixels of that image.
const VGA: u32 = 307_200;
/// Even in a small image an object has this many pixels.
const PIXELS_MIN: u32 = 4;
/// Least extent of an object along one axis, metres (book, Floor and dirt: Objects).
const EXTENT_MIN_M: f32 = 0.01;
/// Least height of an object, metres: lower ones are floor that is not quite even.
const HEIGHT_MIN_M: f32 = 0.015;
/// Neighbours of one object differ in depth by less than this and three standard deviations, metres.
const DEPTH_STEP_M: f32 = 0.03;
/// Pixels of a neighbourhood of nine that must be high (book, Floor and dirt: Objects).
const MAJORITY: u8 = 5;

/// One pixel of the row above: its part, if any, and its depth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Above {
    part: Option<u16>,
    depth_m: f32,
}

impl Entry for Above {
    const BLANK: Self = Self { part: None, depth_m: 0.0 };
}

type Row<T, P> = TableOf<T, <P as Profile>::FloorColumns>;

/// Working memory of the search; one for each camera. Nothing of it lasts from image to image.
#[derive(Clone, Debug)]
pub struct ObjectFinderOf<P: Profile> {
    classes: [Row<PixelClass, P>; 3],
    above: Row<Above, P>,
    parts: UnitedParts<FloorObject, P::FloorParts>,
}

/// A finder in the memory of the target.
pub type ObjectFinder = ObjectFinderOf<Native>;

impl<P: Profile> Default for ObjectFinderOf<P> {
    fn default() -> Self {
        Self { classes: Entry::BLANK, above: Entry::BLANK, parts: UnitedParts::default() }
    }
}

impl<P: Profile> ObjectFinderOf<P> {
    /// Finds the objects of an image whose floor is known. `classes`, one a pixel, is filled for those who look at
    /// the same pixels; a shorter slice is filled as far as it goes.
    ///
    /// # Errors
    /// The image is wider than this profile's rows.
    pub fn find(
        &mut self,
        image: &DepthImage<'_>,
        (parameters, floor): (&FloorParameters, &FloorEstimate),
        classes: &mut [PixelClass],
    ) -> Result<FloorObjectsOf<P>, ImageTooWide> {
        let width = image.width();
        let columns_max = P::FloorColumns::N;
        if width > columns_max {
            return Err(ImageTooWide { width, columns_max });
        }
        let judge = Judge::<P>::new(parameters, &floor.plane, &floor.curvature);
        let scene = Scene { parameters, judge: &judge, axes: floor.plane.axes() };
        self.parts.clear();
        self.above = Entry::BLANK;
        self.classes = Entry::BLANK;
        let mut found = FloorObjectsOf::default();
        let mut outputs = classes.chunks_mut(width.max(1));
        let mut before: &[u16] = &[];
        // One row more than the image has, so that the last one gets its lower neighbours: none.
        for (row, depths) in image.rows().map(Some).chain(core::iter::once(None)).enumerate() {
            self.classes.rotate_left(1);
            let [_, _, newest] = &mut self.classes;
            match depths {
                Some(depths) => judge.row(row, depths, newest.as_mut()),
                None => *newest = Entry::BLANK,
            }
            if let Some(middle) = row.checked_sub(1) {
                let output = outputs.next().unwrap_or(&mut []);
                self.row(middle, before, (&scene, output), &mut found);
            }
            before = depths.unwrap_or(&[]);
        }
        self.collect(image, &mut found);
        Ok(found)
    }

    /// The middle row, once both neighbours are judged.
    fn row(
        &mut self,
        row: usize,
        depths: &[u16],
        (scene, output): (&Scene<'_, P>, &mut [PixelClass]),
        found: &mut FloorObjectsOf<P>,
    ) {
        let [upper, middle, lower] = self.classes;
        let judged = middle.as_ref().get(..depths.len()).unwrap_or(middle.as_ref());
        let [floor, objects, holes] = counts(judged);
        for (sum, count) in found.counts.iter_mut().zip([floor, objects, holes]) {
            *sum = sum.saturating_add(count);
        }
        for (class, judged) in output.iter_mut().zip(judged) {
            *class = *judged;
        }
        if objects == 0 {
            self.above = Entry::BLANK;
            return;
        }
        let mut votes = Row::<u8, P>::BLANK;
        for (vote, ((a, b), c)) in votes.iter_mut().zip(upper.iter().zip(middle.iter()).zip(lower.iter())) {
            let is_high = |class: &PixelClass| u8::from(*class == PixelClass::Object);
            *vote = is_high(a).wrapping_add(is_high(b)).wrapping_add(is_high(c));
        }
        let mut current = Row::<Above, P>::BLANK;
        let is_object = |class: &PixelClass| *class == PixelClass::Object;
        let first = judged.iter().position(is_object).unwrap_or(0);
        let last = judged.iter().rposition(is_object).unwrap_or(0);
        let columns = depths.iter().zip(judged).enumerate().take(last.saturating_add(1)).skip(first);
        let mut left = Above::default();
        // Nothing is high on the left of the first object, but what is above and below it may be.
        let mut left_votes = first.checked_sub(1).and_then(|column| votes.get(column)).copied().unwrap_or(0);
        for (column, (depth, class)) in columns {
            let at = |index: usize| votes.get(index).copied().unwrap_or(0);
            let own = at(column);
            let right =
                if column.saturating_add(1) < depths.len() { at(column.saturating_add(1)) } else { 0 };
            let sum = left_votes.wrapping_add(own).wrapping_add(right);
            left_votes = own;
            if *class != PixelClass::Object {
                left = Above::default();
                continue;
            }
            if sum < MAJORITY {
                if let Some(class) = output.get_mut(column) {
                    *class = PixelClass::Unknown;
                }
                left = Above::default();
                continue;
            }
            let pixel = Pixel { column, row, depth_m: f32::from(*depth) * 0.001 };
            left = Above { part: self.join(&pixel, left, scene, found), depth_m: pixel.depth_m };
            if let Some(slot) = current.get_mut(column) {
                *slot = left;
            }
        }
        self.above = current;
    }

    /// Adds a pixel to the parts of its neighbours, united, or to a new one.
    fn join(
        &mut self,
        pixel: &Pixel,
        left: Above,
        scene: &Scene<'_, P>,
        found: &mut FloorObjectsOf<P>,
    ) -> Option<u16> {
        let noise_m2 = scene.parameters.noise.variance_m2(pixel.depth_m);
        let first = pixel.column.saturating_sub(1);
        let neighbours: [Above; 3] = core::array::from_fn(|offset| {
            self.above.get(first.saturating_add(offset)).copied().unwrap_or_default()
        });
        // At the first column there is nobody on the upper left: two neighbours above instead of three.
        let count = if pixel.column == 0 { 2 } else { 3 };
        let near = core::iter::once(left).chain(neighbours.into_iter().take(count)).filter_map(|neighbour| {
            let jump_m = (neighbour.depth_m - pixel.depth_m).abs();
            neighbour.part.filter(|_| is_one_surface(jump_m, noise_m2))
        });
        let part = self.parts.join(near, &scene.object(pixel));
        if part.is_err() {
            found.dropped = found.dropped.saturating_add(1);
        }
        part.ok()
    }

    /// Keeps what is large enough to be something, the nearest ones first.
    fn collect(&self, image: &DepthImage<'_>, found: &mut FloorObjectsOf<P>) {
        let pixels = u32::try_from(image.depth_mm().len()).unwrap_or(u32::MAX);
        let pixels_min = (pixels.saturating_mul(PIXELS_MIN_VGA) / VGA).max(PIXELS_MIN);
        for object in self.parts.finished() {
            let mut object = *object;
            let ([lx, ly], [hx, hy]) = (object.low_m, object.high_m);
            let extends = (hx - lx).max(hy - ly) >= EXTENT_MIN_M;
            if object.pixels < pixels_min || object.height_m < HEIGHT_MIN_M || !extends {
                continue;
            }
            let size = nearest_f32(object.pixels) / nearest_f32(4 * pixels_min);
            object.confidence = (object.height_m / (2.0 * HEIGHT_MIN_M)).min(1.0) * size.min(1.0);
            insert(found, object);
        }
    }
}

/// True where the depths of neighbours differ by less than a step and three standard deviations. Squares are compared,
/// so that no pixel needs a root.
#[inline]
fn is_one_surface(jump_m: f32, noise_m2: f32) -> bool {
    let beyond_m = jump_m - DEPTH_STEP_M;
    beyond_m < 0.0 || beyond_m * beyond_m < 9.0 * noise_m2
}

/// Pixels of a row that are floor, object, hole.
fn counts(row: &[PixelClass]) -> [u32; 3] {
    // Sixteen bits are enough for a row and let compilers count eight pixels at once.
    let mut counts = [0_u16; 3];
    for class in row {
        let [floor, objects, holes] = &mut counts;
        *floor = floor.wrapping_add(u16::from(*class == PixelClass::Floor));
        *objects = objects.wrapping_add(u16::from(*class == PixelClass::Object));
        *holes = holes.wrapping_add(u16::from(*class == PixelClass::Hole));
    }
    counts.map(u32::from)
}

/// Sorted by the distance of the nearest point; the farthest falls out when the list is full.
fn insert<P: Profile>(found: &mut FloorObjectsOf<P>, object: FloorObject) {
    let near = |object: &FloorObject| {
        let [_, forward] = object.low_m;
        forward
    };
    if found.objects.is_full() {
        found.dropped = found.dropped.saturating_add(1);
        if found.objects.last().is_some_and(|last| near(last) <= near(&object)) {
            return;
        }
        found.objects.pop();
    }
    let place = found.objects.iter().position(|other| near(other) > near(&object));
    let place = place.unwrap_or(found.objects.len());
    if found.objects.insert(place, object).is_err() {
        found.dropped = found.dropped.saturating_add(1);
    }
}

/// One pixel of an object.
struct Pixel {
    column: usize,
    row: usize,
    depth_m: f32,
}

/// What places a pixel on the floor.
struct Scene<'a, P: Profile> {
    parameters: &'a FloorParameters,
    judge: &'a Judge<P>,
    axes: [[f32; 3]; 2],
}

impl<P: Profile> Scene<'_, P> {
    fn object(&self, pixel: &Pixel) -> FloorObject {
        let ray = self.parameters.camera.ray(nearest_f32(pixel.column), nearest_f32(pixel.row));
        let point = ray.map(|value| value * pixel.depth_m);
        // The camera's foot point is straight below it, and the axes lie in the plane: there both are zero.
        let place = self.axes.map(|axis| dot(axis, point));
        let at = [pixel.column, pixel.row].map(|value| u16::try_from(value).unwrap_or(u16::MAX));
        FloorObject {
            low_m: place,
            high_m: place,
            height_m: self.judge.above_floor_m(point),
            pixels: 1,
            first_px: at,
            last_px: at,
            confidence: 0.0,
        }
    }
}

impl Absorb for FloorObject {
    fn absorb(&mut self, other: &Self) {
        for (low, value) in self.low_m.iter_mut().zip(other.low_m) {
            *low = low.min(value);
        }
        for (high, value) in self.high_m.iter_mut().zip(other.high_m) {
            *high = high.max(value);
        }
        for (first, value) in self.first_px.iter_mut().zip(other.first_px) {
            *first = (*first).min(value);
        }
        for (last, value) in self.last_px.iter_mut().zip(other.last_px) {
            *last = (*last).max(value);
        }
        self.height_m = self.height_m.max(other.height_m);
        self.pixels = self.pixels.saturating_add(other.pixels);
    }
}
