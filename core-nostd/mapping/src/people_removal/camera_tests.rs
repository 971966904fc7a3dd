//! Projections beside OpenCV's `projectPoints` (`tests/peers/projection_vectors.py`, OpenCV 5.0.0), boxes to places.

use floorguard_types::geometry::{Point3, Transform3};
use floorguard_types::sensing::{PinholeCamera, Pixel};
use std::vec::Vec;

use super::{
    BrownLens, CalibrationError, LensCamera, NoPosition, PersonBox, PositionMethod, checked_mounting,
    person_position,
};

const ROTATION: [[f32; 3]; 3] = [
    [-0.020_789_937, -0.999_707_5, 0.012_353_467],
    [-0.034_116_117, -0.011_639_57, -0.999_350_1],
    [0.999_201_6, -0.021_197_877, -0.033_864_15],
];

const VECTORS: [([f32; 3], [f32; 2]); 12] = [
    ([5.02, 3.43, 1.72], [-51.1509, 22.5553]),
    ([3.2, 1.9, 0.44], [-18.7779, 121.2045]),
    ([1.27, 0.92, -0.31], [-77.436, 309.659]),
    ([4.23, -0.51, 0.37], [393.6563, 152.7471]),
    ([2.19, 0.65, 0.73], [150.5388, -9.9399]),
    ([6.54, 3.08, 0.82], [40.0018, 136.7084]),
    ([10.04, -5.13, -1.42], [604.0515, 302.3491]),
    ([6.06, -3.84, 2.87], [653.3649, -30.4833]),
    ([7.92, -5.09, 0.66], [669.6814, 175.3111]),
    ([5.44, -2.7, -1.84], [592.9907, 407.0917]),
    ([5.96, -4.1, 0.38], [691.1068, 184.6897]),
    ([6.57, -3.92, 2.46], [641.9541, 16.0154]),
];

fn pinhole() -> PinholeCamera {
    PinholeCamera::new([615.2, 617.9], [322.4, 243.7]).unwrap()
}

fn camera(radial: [f32; 3], tangential: [f32; 2]) -> LensCamera {
    let mounting = Transform3 { rotation: ROTATION, translation: Point3::new(0.06, -0.11, -0.07) };
    LensCamera::new(pinhole(), BrownLens { radial, tangential }, mounting).unwrap()
}

#[test]
fn projections_agree_with_opencv() {
    let camera = camera([-0.281, 0.0912, -0.0123], [0.0007, -0.0011]);
    for ([x, y, z], [column, row]) in VECTORS {
        let pixel = camera.project(Point3::new(x, y, z)).unwrap();
        let away = (pixel.column - column).abs().max((pixel.row - row).abs());
        assert!(away < 2.0e-3, "{x} {y} {z}: {pixel:?}");
    }
}

#[test]
fn points_beyond_the_fold_are_rejected() {
    // The slope 1 + 3·k1·r² vanishes at r = 0.86; at r = 1.1 the formula gives a pixel nearer to the middle.
    let camera = camera([-0.45, 0.0, 0.0], [0.0, 0.0]);
    assert!(camera.project(Point3::new(4.0, 2.0, 0.0)).is_some());
    assert_eq!(camera.project(Point3::new(4.0, 4.4, 0.0)), None);
    assert_eq!(camera.project(Point3::new(-4.0, 0.4, 0.0)), None);
    assert_eq!(camera.project(Point3::new(f32::NAN, 0.4, 0.0)), None);
}

#[test]
fn extrinsics_without_a_rotation_are_refused() {
    let mut rotation = ROTATION;
    rotation[1][2] = -0.98;
    let refused = checked_mounting(Transform3 { rotation, ..Transform3::IDENTITY });
    assert!(matches!(refused, Err(CalibrationError::NoRotation { .. })));
    let translation = Point3::new(f32::NAN, 0.0, 0.0);
    assert_eq!(
        checked_mounting(Transform3 { translation, ..Transform3::IDENTITY }),
        Err(CalibrationError::Translation)
    );
    let lens = BrownLens { radial: [f32::INFINITY, 0.0, 0.0], ..BrownLens::default() };
    assert_eq!(LensCamera::new(pinhole(), lens, Transform3::IDENTITY), Err(CalibrationError::Lens));
}

/// A body 3 m ahead with a gap between its legs, and a wall at 8 m.
fn scene() -> Vec<Point3> {
    let mut points = Vec::new();
    for row in -6..=6_i8 {
        for column in -8..=8_i8 {
            let (left, up) = (0.04 * f32::from(column), 0.13 * f32::from(row));
            let is_gap = row < 1 && column.abs() < 2;
            let depth_m = if column.abs() <= 5 && !is_gap { 3.0 } else { 8.0 };
            points.push(Point3::new(depth_m, left * depth_m / 3.0, up * depth_m / 3.0));
        }
    }
    points
}

#[test]
fn depth_mode_does_not_look_between_the_legs() {
    let mounting = Transform3 { rotation: ROTATION, ..Transform3::IDENTITY };
    let camera = LensCamera::new(pinhole(), BrownLens::default(), mounting).unwrap();
    let edge = |x: f32, y: f32, z: f32| camera.project(Point3::new(x, y, z)).unwrap();
    let (upper_left, lower_right) = (edge(3.0, 0.22, 0.8), edge(3.0, -0.22, -0.8));
    let person = PersonBox { confidence: 0.9, upper_left, lower_right };
    let place = |method| person_position(&camera, &person, scene().into_iter(), method).unwrap();
    // The middle of the box lies in the gap: the published rule takes the wall.
    assert!(place(PositionMethod::NearestToMiddle).x_m > 7.9);
    let ours = place(PositionMethod::DepthMode);
    assert!((ours.x_m - 3.0).abs() < 0.05 && ours.y_m.abs() < 0.1, "{ours:?}");
}

#[test]
fn boxes_without_meaning_give_no_place() {
    let camera = camera([0.0; 3], [0.0; 2]);
    let pixel = |column, row| Pixel { column, row };
    let person =
        PersonBox { confidence: 0.9, upper_left: pixel(300.0, 100.0), lower_right: pixel(350.0, 300.0) };
    let place =
        |person: &PersonBox| person_position(&camera, person, scene().into_iter(), PositionMethod::DepthMode);
    let unsure = PersonBox { confidence: f32::NAN, ..person };
    let inverted = PersonBox { lower_right: pixel(290.0, 300.0), ..person };
    let beside =
        PersonBox { upper_left: pixel(5_000.0, 100.0), lower_right: pixel(5_050.0, 300.0), ..person };
    assert_eq!(
        [place(&unsure), place(&inverted), place(&beside)],
        [Err(NoPosition::NotSure), Err(NoPosition::NoBox), Err(NoPosition::NoPoints)]
    );
}
