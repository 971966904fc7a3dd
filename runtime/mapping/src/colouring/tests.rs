//! A room with a pillar, whose pictures are made by following the ray of each pixel: nothing of what is tested makes them.

use floorguard_mapping::people_removal::{BrownLens, LensCamera};
use floorguard_types::geometry::{Point3, Transform3};
use floorguard_types::sensing::PinholeCamera;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::{CameraView, Colouring};
use crate::clean::SizedCamera;
use crate::lidar3d::CloudPoint;
use crate::metrics::{TimedPose, pose_at};

const SIZE: [u32; 2] = [320, 240];
const FOCAL_PX: f64 = 180.0;
const CENTRE_PX: [f64; 2] = [161.5, 118.0];
const RADIAL: [f64; 2] = [-0.22, 0.05];
const TANGENTIAL: [f64; 2] = [0.002, -0.001];
/// The room, metres from its middle: low and high corner; and the pillar in it.
const ROOM: [[f64; 3]; 2] = [[-4.0, -3.0, -1.0], [4.0, 3.0, 2.0]];
const PILLAR: [[f64; 3]; 2] = [[1.0, -0.3, -1.0], [1.6, 0.3, 2.0]];

/// Rows: right, down and forward of a camera that looks along x, pitched down by 0.1 rad and turned by 0.05.
fn camera_from_lidar() -> (Rotation3<f64>, Vector3<f64>) {
    let axes = Rotation3::from_matrix_unchecked(Matrix3::new(0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0));
    let turned = axes * Rotation3::from_euler_angles(0.01, -0.1, 0.05);
    (turned, turned * -Vector3::new(0.12, -0.05, 0.2))
}

fn camera() -> SizedCamera {
    let (rotation, translation) = camera_from_lidar();
    let row = |row: usize| std::array::from_fn(|column| rotation[(row, column)] as f32);
    let [x_m, y_m, z_m] = translation.map(|value| value as f32).into();
    let mounting = Transform3 { rotation: [row(0), row(1), row(2)], translation: Point3::new(x_m, y_m, z_m) };
    let pinhole = PinholeCamera::new([FOCAL_PX as f32; 2], CENTRE_PX.map(|value| value as f32)).unwrap();
    let lens = BrownLens {
        radial: [RADIAL[0] as f32, RADIAL[1] as f32, 0.0],
        tangential: TANGENTIAL.map(|value| value as f32),
    };
    SizedCamera { camera: LensCamera::new(pinhole, lens, mounting).unwrap(), size: SIZE }
}

/// Which surface a place lies on and what colour that has: fields of half a metre.
fn colour(surface: usize, place: Vector3<f64>) -> [u8; 3] {
    let fields: i64 = place.iter().map(|value| (value * 2.0 + 0.5).floor() as i64).sum();
    let bright = if fields % 2 == 0 { 0 } else { 60 };
    let parts = [[180, 0, 0], [0, 180, 0], [0, 0, 180], [180, 180, 0], [180, 0, 180], [0, 180, 180]];
    let [red, green, blue] = *parts.get(surface).unwrap_or(&[90, 90, 90]);
    [red + bright, green + bright, blue + bright]
}

/// The nearest surface along a ray: 0 to 5 of the room, 6 the pillar.
fn struck(from: Vector3<f64>, along: Vector3<f64>) -> (usize, Vector3<f64>) {
    let crossings =
        |bounds: [[f64; 3]; 2], axis: usize, side: usize| (bounds[side][axis] - from[axis]) / along[axis];
    let faces = (0..3).flat_map(|axis| [[axis, 0], [axis, 1]]);
    let room = faces.clone().map(|[axis, side]| (crossings(ROOM, axis, side), 2 * axis + side));
    let (away, wall) =
        room.filter(|(away, _)| *away > 1.0e-9).min_by(|a, b| a.0.total_cmp(&b.0)).expect("inside of a room");
    let [mut enters, mut leaves] = [f64::NEG_INFINITY, f64::INFINITY];
    for axis in 0..3 {
        let [a, b] = [0, 1].map(|side| crossings(PILLAR, axis, side));
        (enters, leaves) = (enters.max(a.min(b)), leaves.min(a.max(b)));
    }
    if enters > 0.0 && enters < leaves && enters < away {
        return (6, from + along * enters);
    }
    (wall, from + along * away)
}

/// The direction that a pixel shows, in the camera: the lens undone by trying (OpenCV's model).
fn direction(column: f64, row: f64) -> Vector3<f64> {
    let bent = [(column - CENTRE_PX[0]) / FOCAL_PX, (row - CENTRE_PX[1]) / FOCAL_PX];
    let [mut x, mut y] = bent;
    for _ in 0..60 {
        let squared = x * x + y * y;
        let radial = 1.0 + RADIAL[0] * squared + RADIAL[1] * squared * squared;
        let [p1, p2] = TANGENTIAL;
        let off_x = 2.0 * p1 * x * y + p2 * (squared + 2.0 * x * x);
        let off_y = p1 * (squared + 2.0 * y * y) + 2.0 * p2 * x * y;
        (x, y) = ((bent[0] - off_x) / radial, (bent[1] - off_y) / radial);
    }
    Vector3::new(x, y, 1.0)
}

fn picture(pose: &TimedPose) -> Vec<u8> {
    let (rotation, translation) = camera_from_lidar();
    let from = pose.place_m + pose.rotation * (rotation.inverse() * -translation);
    let mut rgb = Vec::new();
    for row in 0..SIZE[1] {
        for column in 0..SIZE[0] {
            let seen = direction(f64::from(column), f64::from(row));
            let (surface, place) = struck(from, pose.rotation * (rotation.inverse() * seen));
            rgb.extend(colour(surface, place));
        }
    }
    rgb
}

fn pose(x_m: f64, y_m: f64, heading_rad: f64) -> TimedPose {
    let rotation = UnitQuaternion::from_euler_angles(0.0, 0.0, heading_rad);
    TimedPose { time_s: 0.0, place_m: Vector3::new(x_m, y_m, 0.0), rotation }
}

/// Points on every surface every 5 cm, with the surface of each; the floor and the ceiling under and over the pillar left out.
fn cloud() -> Vec<(usize, CloudPoint)> {
    let mut points = Vec::new();
    let mut face = |bounds: [[f64; 3]; 2], axis: usize, side: usize, surface: usize| {
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
        let steps = |along: usize| ((bounds[1][along] - bounds[0][along]) / 0.05).round() as usize;
        for (i, j) in (0..steps(a)).flat_map(|i| (0..steps(b)).map(move |j| (i, j))) {
            let mut place = Vector3::zeros();
            place[axis] = bounds[side][axis];
            place[a] = bounds[0][a] + 0.05 * (i as f64 + 0.5);
            place[b] = bounds[0][b] + 0.05 * (j as f64 + 0.5);
            let within = |along: usize| (PILLAR[0][along]..=PILLAR[1][along]).contains(&place[along]);
            if surface == 6 || !(within(0) && within(1)) {
                let place_m = place.map(|value: f64| value as f32);
                points.push((surface, CloudPoint { place_m, reflectivity: 0.0, time_s: 0.0, count: 5 }));
            }
        }
    };
    for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
        face(ROOM, axis, side, 2 * axis + side);
    }
    for (axis, side) in (0..2).flat_map(|axis| [(axis, 0), (axis, 1)]) {
        face(PILLAR, axis, side, 6);
    }
    points
}

/// Farther than 0.12 m from another surface and from a border of two colours: a pixel shows 2 cm, and more where a surface is seen flatly.
fn is_clear(surface: usize, place: &Vector3<f32>) -> bool {
    let bounds = if surface == 6 { PILLAR } else { ROOM };
    (0..3).all(|axis| {
        let value = f64::from(place[axis]);
        let to_bounds = [0, 1].map(|side| (value - bounds[side][axis]).abs());
        let of_field = (value * 2.0 + 0.5).fract().abs();
        let is_its_own = to_bounds.iter().any(|away| *away < 1.0e-4);
        is_its_own || (to_bounds.iter().all(|away| *away > 0.12) && of_field.min(1.0 - of_field) > 0.12)
    })
}

/// Points away from borders: how many have a colour, and how many of those a wrong one.
fn judged(poses: &[TimedPose]) -> [usize; 2] {
    let (cloud, camera) = (cloud(), camera());
    let points: Vec<CloudPoint> = cloud.iter().map(|(_, point)| *point).collect();
    let mut colouring = Colouring::new(&points, 0.05);
    for pose in poses {
        let rgb = picture(pose);
        assert!(colouring.add(&CameraView { camera: &camera, lidar_in_map: pose, rgb: &rgb }) > 1_000);
    }
    let mut counts = [0, 0];
    for ((surface, point), found) in cloud.iter().zip(colouring.colours()) {
        let Some(found) = found.filter(|_| is_clear(*surface, &point.place_m)) else { continue };
        counts[0] += 1;
        counts[1] += usize::from(found != colour(*surface, point.place_m.map(f64::from)));
    }
    counts
}

#[test]
fn points_have_the_colours_of_their_surfaces() {
    let [coloured, wrong] = judged(&[
        pose(-3.0, 0.3, 0.0),
        pose(-1.0, 2.0, -0.9),
        pose(3.0, 2.0, -2.4),
        pose(3.0, -2.0, 2.2),
        pose(0.0, -2.0, 3.0),
    ]);
    assert!(coloured > 8_000 && wrong * 100 < coloured, "{wrong} of {coloured}");
}

/// From one place the pillar hides a part of the wall behind it: that part has no colour instead of the pillar's.
#[test]
fn hidden_surfaces_have_no_colour_from_there() {
    let [coloured, wrong] = judged(&[pose(-3.0, 0.0, 0.0)]);
    assert!(coloured > 1_000 && wrong * 100 < coloured, "{wrong} of {coloured}");
}

#[test]
fn one_picture_with_a_person_is_outvoted() {
    let points =
        [CloudPoint { place_m: Vector3::new(4.0, 0.9, 0.1), reflectivity: 0.0, time_s: 0.0, count: 5 }];
    let camera = camera();
    let mut colouring = Colouring::new(&points, 0.05);
    let blocked = vec![255; 3 * 320 * 240];
    for y_m in [0.0, 0.2, 0.4] {
        let pose = pose(-1.0, y_m, 0.1);
        let rgb = if y_m == 0.2 { blocked.clone() } else { picture(&pose) };
        colouring.add(&CameraView { camera: &camera, lidar_in_map: &pose, rgb: &rgb });
    }
    assert_eq!(colouring.colours(), [Some(colour(1, Vector3::new(4.0, 0.9, 0.1)))]);
    let pose = pose(-1.0, 0.0, 0.1);
    let other_size = CameraView { camera: &camera, lidar_in_map: &pose, rgb: &blocked[3..] };
    assert_eq!(colouring.add(&other_size), 0, "a picture of another size shows nothing");
}

#[test]
fn poses_between_sweeps_turn_the_shorter_way() {
    let at = |time_s: f64, x_m: f64, heading_rad: f64| TimedPose { time_s, ..pose(x_m, 0.0, heading_rad) };
    let drive = [at(1.0, 0.0, 3.0), at(1.2, 0.4, -3.0), at(3.0, 9.0, 0.0)];
    let heading = |time_s: f64| pose_at(&drive, time_s, 0.5).map(|pose| pose.flat());
    let between = heading(1.05).unwrap();
    assert!(
        (between.x_m - 0.1).abs() < 1.0e-9 && (between.heading_rad - 3.0708).abs() < 1.0e-4,
        "{between:?}"
    );
    assert_eq!(heading(1.0).map(|pose| pose.x_m), Some(0.0));
    assert_eq!([0.99, 1.21, 3.01].map(heading), [None, None, None], "before, in a gap, after");
}
