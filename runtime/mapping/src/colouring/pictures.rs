//! Colours of surfaces, out of pictures of a camera beside the lidar.
//!
//! A point has the colour of the picture where the camera sees it. What stands before it hides it: each picture has a coarse raster of
//! the nearest points. A person who walked through one picture, and a wrong exposure, are outvoted by the others.

use floorguard_types::geometry::Point3;
use nalgebra::{Isometry3, Vector3};

use crate::clean::SizedCamera;
use crate::lidar3d::CloudPoint;
use crate::metrics::TimedPose;

/// Pictures of which the middle counts for a point, the nearest ones: an odd number, so that the middle is one of them.
const SAMPLES: usize = 5;
/// Points farther from the lidar have no colour from there, metres: calibration and pose are off by a pixel or two, which is 5 cm there.
const REACH_M: f32 = 20.0;
/// Pixels along an element of the raster of nearest points.
const ELEMENT: f32 = 4.0;
/// A point is hidden by others that are nearer than it by more than these: edges of cubes, and a share of its distance. A floor that is
/// seen flatly gets so much farther within the height of a cube.
const HIDDEN: (f32, f32) = (2.0, 0.05);
/// Elements to each side that a cube covers at most.
const COVERED_MAX: i32 = 40;

/// A picture and from where it was taken.
#[derive(Clone, Copy, Debug)]
pub struct CameraView<'a> {
    /// The camera beside the lidar.
    pub camera: &'a SizedCamera,
    /// The lidar in the map when the picture was taken.
    pub lidar_in_map: &'a TimedPose,
    /// Red, green and blue of each pixel, row by row; as many as the camera's size says.
    pub rgb: &'a [u8],
}

#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    away_m: f32,
    rgb: [u8; 3],
}

/// A point in a picture.
#[derive(Clone, Copy, Debug)]
struct Seen {
    point: usize,
    column: f32,
    row: f32,
    away_m: f32,
    /// What its cube covers, pixels to each side.
    half_px: f32,
}

/// Gathers colours of points; some 40 bytes for each.
#[derive(Clone, Debug)]
pub struct Colouring<'a> {
    points: &'a [CloudPoint],
    edge_m: f32,
    samples: Vec<[Sample; SAMPLES]>,
    counts: Vec<u8>,
    seen: Vec<Seen>,
    nearest_m: Vec<f32>,
}

impl<'a> Colouring<'a> {
    /// Of the points of a cloud with cubes of this edge, metres.
    #[must_use]
    pub fn new(points: &'a [CloudPoint], edge_m: f32) -> Self {
        Self {
            points,
            edge_m,
            samples: vec![[Sample::default(); SAMPLES]; points.len()],
            counts: vec![0; points.len()],
            seen: Vec::new(),
            nearest_m: Vec::new(),
        }
    }

    /// One more picture; how many points it shows. A picture of another size than the camera's shows none.
    pub fn add(&mut self, view: &CameraView<'_>) -> usize {
        let [width, height] = view.camera.size.map(|side| side as usize);
        if view.rgb.len() != 3 * width * height || view.rgb.is_empty() {
            return 0;
        }
        self.look(view);
        let columns = width.div_ceil(ELEMENT as usize);
        self.cover([columns, height.div_ceil(ELEMENT as usize)]);
        let mut shown = 0;
        for seen in &self.seen {
            let element = (seen.row / ELEMENT) as usize * columns + (seen.column / ELEMENT) as usize;
            let nearest_m = self.nearest_m.get(element).copied().unwrap_or(0.0);
            if seen.away_m > nearest_m + HIDDEN.0 * self.edge_m + HIDDEN.1 * seen.away_m {
                continue;
            }
            // The middle of a pixel has its whole numbers.
            let column = ((seen.column + 0.5) as usize).min(width - 1);
            let first = 3 * (((seen.row + 0.5) as usize).min(height - 1) * width + column);
            let rgb = [view.rgb[first], view.rgb[first + 1], view.rgb[first + 2]];
            enter(
                (&mut self.samples[seen.point], &mut self.counts[seen.point]),
                Sample { away_m: seen.away_m, rgb },
            );
            shown += 1;
        }
        shown
    }

    /// Where the camera has the points before it.
    fn look(&mut self, view: &CameraView<'_>) {
        let pose = view.lidar_in_map;
        let map_from_lidar = Isometry3::from_parts(pose.place_m.into(), pose.rotation);
        let lidar_from_map = map_from_lidar.inverse().cast::<f32>();
        let [width, height] = view.camera.size.map(|side| side as f32);
        self.seen.clear();
        for (index, point) in self.points.iter().enumerate() {
            let place = lidar_from_map * nalgebra::Point3::from(point.place_m);
            let away_m = place.coords.norm();
            if away_m > REACH_M {
                continue;
            }
            let pixel =
                |place: Vector3<f32>| view.camera.camera.project(Point3::new(place.x, place.y, place.z));
            let across = place.coords.cross(&Vector3::z()).try_normalize(1.0e-6).unwrap_or_else(Vector3::x);
            let pixels = pixel(place.coords).zip(pixel(place.coords + across * self.edge_m));
            let Some((middle, beside)) = pixels else { continue };
            let (column, row) = (middle.column, middle.row);
            if column < -0.5 || row < -0.5 || column >= width - 0.5 || row >= height - 0.5 {
                continue;
            }
            let half_px = libm::hypotf(beside.column - column, beside.row - row);
            self.seen.push(Seen {
                point: index,
                column: column.max(0.0),
                row: row.max(0.0),
                away_m,
                half_px,
            });
        }
    }

    /// The raster of nearest points: each covers what its cube does and as much around, because a spinning lidar leaves gaps.
    fn cover(&mut self, [columns, rows]: [usize; 2]) {
        self.nearest_m.clear();
        self.nearest_m.resize(columns * rows, f32::INFINITY);
        let (last_column, last_row) = (columns as i32 - 1, rows as i32 - 1);
        for seen in &self.seen {
            let element = |pixel: f32| libm::floorf(pixel / ELEMENT) as i32;
            let half = element(seen.half_px).min(COVERED_MAX);
            let (column, row) = (element(seen.column), element(seen.row));
            for row in (row - half).max(0)..=(row + half).min(last_row) {
                for column in (column - half).max(0)..=(column + half).min(last_column) {
                    let nearest_m = &mut self.nearest_m[row as usize * columns + column as usize];
                    *nearest_m = nearest_m.min(seen.away_m);
                }
            }
        }
    }

    /// The colour of each point: the middle of each channel over the nearest pictures that show it; `None` where none does.
    #[must_use]
    pub fn colours(&self) -> Vec<Option<[u8; 3]>> {
        let middle = |samples: &[Sample]| {
            (!samples.is_empty()).then(|| {
                std::array::from_fn(|channel| {
                    let mut values: Vec<u8> = samples.iter().map(|sample| sample.rgb[channel]).collect();
                    values.sort_unstable();
                    values[values.len() / 2]
                })
            })
        };
        self.samples
            .iter()
            .zip(&self.counts)
            .map(|(all, count)| middle(&all[..usize::from(*count)]))
            .collect()
    }
}

/// One more sample; of too many the farthest goes.
fn enter((samples, count): (&mut [Sample; SAMPLES], &mut u8), new: Sample) {
    if let Some(free) = samples.get_mut(usize::from(*count)) {
        *free = new;
        *count += 1;
        return;
    }
    let farthest = samples.iter_mut().max_by(|a, b| a.away_m.total_cmp(&b.away_m));
    if let Some(farthest) = farthest.filter(|farthest| farthest.away_m > new.away_m) {
        *farthest = new;
    }
}
