//! People that a detector found in pictures become places: each picture with the sweep of its time and the pose at its time.

use floorguard_mapping::people_removal::{
    Entered, LensCamera, NoPosition, PersonBox, PositionMethod, Sighting, Sightings, person_position,
};
use floorguard_types::geometry::{Point3, Transform3};
use floorguard_types::time::Stamp;

use super::track::Track;

/// People that one picture can hold; more are left out and counted.
pub const BOXES_MAX: usize = 32;
/// A sweep whose middle is this much earlier or later than a picture belongs to it, seconds.
const SWEEP_AGE_MAX_S: f64 = 0.05;
/// A box may reach beyond the picture by so much of its size: detectors clip late.
const BEYOND_MAX: f32 = 0.1;

/// What a detector found in one picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageBoxes {
    /// Time of the picture, seconds on the clock of the poses.
    pub stamp_s: f64,
    /// Width and height of the picture, pixels, where the detector gives them.
    pub size: Option<[u32; 2]>,
    /// People.
    pub boxes: Vec<PersonBox>,
}

/// Why boxes cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ImageError {
    /// A picture is earlier than the one before it.
    #[error("picture {number}, at {stamp_s} s, is earlier than the one before: its boxes are out of order")]
    OutOfOrder {
        /// From 1.
        number: usize,
        /// Its time.
        stamp_s: f64,
    },
    /// Pictures of another size than the camera was calibrated for.
    #[error("picture {number} has {}×{} pixels, the camera was calibrated for {}×{}", is[0], is[1], calibrated[0], calibrated[1])]
    OtherSize {
        /// From 1.
        number: usize,
        /// Of the picture.
        is: [u32; 2],
        /// Of the calibration.
        calibrated: [u32; 2],
    },
    /// A box lies outside of the picture.
    #[error("a box of picture {number} reaches to {column:.0}, {row:.0}, far outside of the camera's {}×{} pixels: the boxes are \
             of a picture of another size", size[0], size[1])]
    Outside {
        /// From 1.
        number: usize,
        /// Farthest column.
        column: f32,
        /// Farthest row.
        row: f32,
        /// Of the calibration.
        size: [u32; 2],
    },
    /// A number is not finite.
    #[error("picture {number} holds a number that is not finite")]
    NotFinite {
        /// From 1.
        number: usize,
    },
}

/// A camera of known size beside the lidar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizedCamera {
    /// How it sees points of the lidar.
    pub camera: LensCamera,
    /// Width and height of its pictures, pixels.
    pub size: [u32; 2],
}

/// What became of pictures and boxes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImageCounts {
    /// Pictures that found their sweep and pose.
    pub used: u64,
    /// Boxes that became places.
    pub placed: u64,
    /// Boxes with a confidence below 0.5, or empty ones.
    pub not_sure: u64,
    /// Boxes without enough lidar points.
    pub without_points: u64,
    /// Boxes beyond 32 in one picture.
    pub beyond_32: u64,
}

/// Collects people over sweeps. Invariant: pictures are in the order of their times.
pub struct PeopleInImages {
    camera: SizedCamera,
    method: PositionMethod,
    images: Vec<ImageBoxes>,
    is_done: Vec<bool>,
    sightings: Box<Sightings>,
    /// What became of them.
    pub counts: ImageCounts,
}

impl PeopleInImages {
    /// Of pictures in the order of their times.
    ///
    /// # Errors
    /// See [`ImageError`]; nothing is used then.
    pub fn new(
        camera: SizedCamera,
        images: Vec<ImageBoxes>,
        method: PositionMethod,
    ) -> Result<Self, ImageError> {
        let mut last_s = f64::NEG_INFINITY;
        for (index, image) in images.iter().enumerate() {
            check(image, index + 1, camera.size)?;
            if image.stamp_s < last_s {
                return Err(ImageError::OutOfOrder { number: index + 1, stamp_s: image.stamp_s });
            }
            last_s = image.stamp_s;
        }
        let is_done = vec![false; images.len()];
        let sightings = Box::new(Sightings::default());
        Ok(Self { camera, method, images, is_done, sightings, counts: ImageCounts::default() })
    }

    /// Pictures, used or not.
    #[must_use]
    pub const fn pictures(&self) -> usize {
        self.images.len()
    }

    /// The people.
    #[must_use]
    pub const fn sightings(&self) -> &Sightings {
        &self.sightings
    }

    /// Enters a sweep: its returns in the map and the time of its middle, seconds. Pictures within 50 ms of it are used, each
    /// once, with the pose at their own time.
    pub fn enter(&mut self, middle_s: f64, points_in_map: &[Point3], track: &Track) {
        let first = self.images.partition_point(|image| image.stamp_s < middle_s - SWEEP_AGE_MAX_S);
        let end = self.images.partition_point(|image| image.stamp_s <= middle_s + SWEEP_AGE_MAX_S);
        for index in first..end {
            let stamp_s = self.images[index].stamp_s;
            let Some(lidar_in_map) = track.at(stamp_s).filter(|_| !self.is_done[index]) else { continue };
            self.is_done[index] = true;
            self.counts.used += 1;
            let image = std::mem::take(&mut self.images[index].boxes);
            self.counts.beyond_32 += image.len().saturating_sub(BOXES_MAX) as u64;
            let points: Vec<Point3> =
                points_in_map.iter().map(|point| to_lidar(&lidar_in_map, *point)).collect();
            for person in image.iter().take(BOXES_MAX) {
                self.person(person, &points, (&lidar_in_map, stamp_s));
            }
            self.images[index].boxes = image;
        }
    }

    fn person(
        &mut self,
        person: &PersonBox,
        points_in_lidar: &[Point3],
        (lidar_in_map, stamp_s): (&Transform3, f64),
    ) {
        let found =
            person_position(&self.camera.camera, person, points_in_lidar.iter().copied(), self.method);
        match found {
            Ok(place) => {
                self.counts.placed += 1;
                let entered = self.sightings.enter(Sighting {
                    person_in_map: lidar_in_map.transform(place),
                    seen_from_in_map: lidar_in_map.on_floor(),
                    stamp: Stamp::from_micros((stamp_s * 1.0e6).max(0.0) as u64),
                    count: 1,
                });
                debug_assert!(entered != Entered::Refused, "places and poses are finite");
            }
            Err(NoPosition::NoPoints) => self.counts.without_points += 1,
            Err(NoPosition::NotSure | NoPosition::NoBox) => self.counts.not_sure += 1,
        }
    }
}

fn check(image: &ImageBoxes, number: usize, calibrated: [u32; 2]) -> Result<(), ImageError> {
    if let Some(is) = image.size.filter(|is| *is != calibrated) {
        return Err(ImageError::OtherSize { number, is, calibrated });
    }
    let [width, height] = calibrated.map(|side| side as f32);
    for each in &image.boxes {
        let edges =
            [each.upper_left.column, each.upper_left.row, each.lower_right.column, each.lower_right.row];
        if !edges.iter().all(|edge| edge.is_finite()) {
            return Err(ImageError::NotFinite { number });
        }
        let (column, row) = (edges[2], edges[3]);
        if column > width * (1.0 + BEYOND_MAX) || row > height * (1.0 + BEYOND_MAX) {
            return Err(ImageError::Outside { number, column, row, size: calibrated });
        }
    }
    if image.stamp_s.is_finite() { Ok(()) } else { Err(ImageError::NotFinite { number }) }
}

/// A point of the map in the lidar's frame.
fn to_lidar(lidar_in_map: &Transform3, point: Point3) -> Point3 {
    let [a, b, c] = lidar_in_map.rotation;
    let origin = lidar_in_map.translation;
    let (x, y, z) = (point.x_m - origin.x_m, point.y_m - origin.y_m, point.z_m - origin.z_m);
    let along = |axis: usize| a[axis] * x + b[axis] * y + c[axis] * z;
    Point3::new(along(0), along(1), along(2))
}
