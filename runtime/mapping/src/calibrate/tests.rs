//! Mountings by `solvePnP` and `solvePnPRefineLM` of OpenCV 5.0.0 on the same noisy pairs.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::{CameraIntrinsics, MountingError, PickedPair, draw_residuals, read_pairs, solve_mounting};

const CAMERA: CameraIntrinsics = CameraIntrinsics {
    focal_px: [610.0, 605.0],
    centre_px: [642.5, 361.2],
    radial: [-0.21, 0.06, -0.004],
    tangential: [0.0008, -0.0005],
};

const SPACE: &str = "x,y,z,column,row
2.804,-0.872,-0.271,779.85,342.48
2.002,0.073,-0.053,573.63,271.17
3.083,0.263,-0.505,532.22,381.42
3.84,0.98,0.614,430.58,185.74
2.01,-0.392,0.516,726.2,104.87
2.965,-0.225,0.711,644.42,132.87
6.954,-0.758,-0.866,646.24,382.98
5.935,-1.891,-0.695,772.68,377.72
2.606,0.404,-0.388,491.16,362.95
3.129,0.158,0.237,558.69,231.61
5.834,0.032,-0.737,576.41,378.33
6.584,0.732,1.047,515.66,203.44
3.769,0.349,-0.838,524.61,423.85
5.929,-2.227,0.427,808.43,267.82
";
const PLANE: &str = "2.89,-0.214,-0.296,635.14,342.05
3.115,0.231,-0.296,541.14,338.51
3.385,0.765,-0.296,443.1,336.25
2.96,-0.249,0.397,646.71,197.52
3.185,0.196,0.397,553.65,202.24
3.455,0.73,0.397,456.47,208.03
3,-0.269,0.793,652.62,119.01
3.225,0.176,0.793,560.69,128.98
3.495,0.71,0.793,464.44,140.22
";

fn space() -> Vec<PickedPair> {
    read_pairs(SPACE).unwrap()
}

#[test]
fn mounting_from_points_in_space_agrees_with_opencv() {
    let solved = solve_mounting(&CAMERA, &space()).unwrap();
    let rotation = Matrix3::new(
        -0.1096328918286793,
        -0.993407401231748,
        0.03350170454269352,
        -0.06216395428311533,
        -0.02678624324420853,
        -0.9977064397711127,
        0.9920263463321768,
        -0.11146404061780169,
        -0.05881747896658973,
    );
    let shift = Vector3::new(0.08331352744211973, -0.2065360214583895, -0.11897442005935709);
    let found = solved.camera_from_lidar;
    assert!((found.rotation.to_rotation_matrix().matrix() - rotation).norm() < 1.0e-6);
    assert!((found.translation.vector - shift).norm() < 1.0e-6);
    assert!((solved.rms_px - 0.742_673_303_517_545_6).abs() < 1.0e-6);
    let first = Vector2::new(-0.19223100576914476, 0.026492636388923074);
    assert!((solved.residuals_px[0] - first).norm() < 1.0e-4);
    assert!(solved.turn_sigma_deg < 0.3 && solved.shift_sigma_m < 0.02, "{solved:?}");
}

#[test]
fn mounting_from_a_plane_agrees_with_opencv() {
    let solved = solve_mounting(&CAMERA, &read_pairs(PLANE).unwrap()).unwrap();
    let shift = Vector3::new(0.10908552490119876, -0.20589984691076182, -0.11459590468999042);
    assert!((solved.camera_from_lidar.translation.vector - shift).norm() < 1.0e-5);
    assert!((solved.rms_px - 0.805_019_642_048_926_2).abs() < 1.0e-6);
}

#[test]
fn degenerate_pairs_are_refused() {
    let pairs = space();
    assert_eq!(solve_mounting(&CAMERA, &pairs[..3]), Err(MountingError::TooFew { is: 3, needed: 4 }));
    assert_eq!(solve_mounting(&CAMERA, &pairs[..5]), Err(MountingError::TooFew { is: 5, needed: 6 }));
    let on_line = |share: f64| PickedPair {
        point_in_lidar: Vector3::new(2.0 + share, share, 0.1 * share),
        pixel: Vector2::new(600.0 - 50.0 * share, 300.0),
    };
    let line: Vec<PickedPair> = (0..8).map(|index| on_line(f64::from(index))).collect();
    assert_eq!(solve_mounting(&CAMERA, &line), Err(MountingError::OnALine));
    let same = vec![pairs[0]; 8];
    assert_eq!(solve_mounting(&CAMERA, &same), Err(MountingError::OnALine));
    // A spot of ten centimetres, seven metres away.
    let far = |pair: &PickedPair| {
        let spot = Vector3::new(7.0, 0.0, 0.0) + pair.point_in_lidar * 0.02;
        PickedPair { point_in_lidar: spot, pixel: pair.pixel * 0.02 + Vector2::new(620.0, 330.0) }
    };
    let spot: Vec<PickedPair> = pairs.iter().map(far).collect();
    let refused = solve_mounting(&CAMERA, &spot);
    assert!(matches!(refused, Err(MountingError::Loose { .. } | MountingError::Behind)), "{refused:?}");
}

#[test]
fn wrong_pick_is_named() {
    let mut pairs = space();
    pairs[8].pixel.x += 120.0;
    let refused = solve_mounting(&CAMERA, &pairs).unwrap_err();
    assert!(matches!(refused, MountingError::NoFit { worst: 9, .. }), "{refused}");
}

#[test]
fn picture_shows_every_pair() {
    let pairs = space();
    let solved = solve_mounting(&CAMERA, &pairs).unwrap();
    let svg = draw_residuals(&super::ResidualPicture {
        size: [1_280, 720],
        pairs: &pairs,
        residuals_px: &solved.residuals_px,
        photograph: None,
    });
    assert_eq!(svg.matches("<circle").count(), pairs.len());
}
