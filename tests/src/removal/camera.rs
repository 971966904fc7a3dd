//! A camera beside the simulated lidar and a detector that is not perfect: boxes of the people that it sees.

use floorguard_mapping::people_removal::{BrownLens, LensCamera, PersonBox};
use floorguard_mapping_host::clean::{ImageBoxes, SizedCamera};
use floorguard_types::geometry::{Point3, Transform3};
use floorguard_types::sensing::{PinholeCamera, Pixel};

use super::building::Building;
use super::chance::Chance;
use super::render::{Drive, Ray, SENSOR_M};
use super::walkers::Walker;

/// Width and height, pixels.
const SIZE: [u32; 2] = [640, 480];
const FOCAL_PX: f32 = 320.0;
const CENTRE_PX: [f32; 2] = [320.0, 240.0];
/// Above the lidar, metres.
const ABOVE_M: f32 = 0.1;
/// Farther people are not found, metres.
const FARTHEST_M: f32 = 9.0;
/// Half the width of a body, metres.
const BODY_M: f32 = 0.25;
/// Share of people that a picture misses.
const MISSED: f32 = 0.1;
/// Standard deviation of the edges, pixels.
const EDGE_PX: f32 = 2.0;

/// The camera as its calibration has it: 45° to each side, ahead.
///
/// # Panics
/// Never: the values are those of a camera.
#[must_use]
pub fn camera() -> SizedCamera {
    let camera_from_lidar = Transform3 {
        rotation: [[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]],
        translation: Point3::new(0.0, ABOVE_M, 0.0),
    };
    let pinhole = PinholeCamera::new([FOCAL_PX; 2], CENTRE_PX).expect("focal lengths of a camera");
    let camera = LensCamera::new(pinhole, BrownLens::default(), camera_from_lidar).expect("a rotation");
    SizedCamera { camera, size: SIZE }
}

/// What the detector says of a picture taken at a time of a drive.
#[must_use]
pub fn picture(
    (building, people): (&Building, &[Walker]),
    drive: &Drive,
    time_s: f32,
    chance: &mut Chance,
) -> ImageBoxes {
    let [x, y, heading] = drive.at(time_s);
    let camera = [x, y, SENSOR_M + ABOVE_M];
    let mut boxes = Vec::new();
    for person in people {
        let Some(place) = person.at(time_s) else { continue };
        let is_missed = chance.share() < MISSED;
        let mut error = || EDGE_PX * chance.normal();
        let errors = [error(), error(), error(), error()];
        let seen = edges(camera, heading, place, person.height_m)
            .filter(|_| !is_missed && is_open(building, camera, place, 0.6 * person.height_m));
        if let Some(edges) = seen {
            let [left, top, right, bottom] = [0, 1, 2, 3].map(|edge| edges[edge] + errors[edge]);
            boxes.push(PersonBox {
                confidence: 0.9,
                upper_left: Pixel { column: left.max(0.0), row: top.max(0.0) },
                lower_right: Pixel { column: right.min(SIZE[0] as f32), row: bottom.min(SIZE[1] as f32) },
            });
        }
    }
    ImageBoxes { stamp_s: f64::from(time_s), size: Some(SIZE), boxes }
}

/// Left, upper, right, lower edge of a body; `None` out of sight.
fn edges(camera: [f32; 3], heading: f32, [x, y]: [f32; 2], height_m: f32) -> Option<[f32; 4]> {
    let (sin, cos) = heading.sin_cos();
    let (east, north) = (x - camera[0], y - camera[1]);
    let (ahead, left) = (cos * east + sin * north, cos * north - sin * east);
    if !(0.6..FARTHEST_M).contains(&ahead) {
        return None;
    }
    let column = |left: f32| CENTRE_PX[0] - FOCAL_PX * left / ahead;
    let row = |height_m: f32| CENTRE_PX[1] + FOCAL_PX * (camera[2] - height_m) / ahead;
    let middle = column(left);
    let is_seen = (20.0..SIZE[0] as f32 - 20.0).contains(&middle);
    is_seen.then(|| [column(left + BODY_M), row(height_m), column(left - BODY_M), row(0.0)])
}

/// Nothing of the building stands between.
fn is_open(building: &Building, camera: [f32; 3], [x, y]: [f32; 2], height_m: f32) -> bool {
    let to = [x - camera[0], y - camera[1], height_m - camera[2]];
    let length_m = to.iter().map(|part| part * part).sum::<f32>().sqrt();
    let ray = Ray { from: camera, direction: to.map(|part| part / length_m) };
    let nearest =
        building.cuboids.iter().filter_map(|cuboid| ray.meets(cuboid)).fold(f32::INFINITY, f32::min);
    nearest > length_m
}
