//! Filters of a person and joint probabilities against filterpy 2.0.0 and Stone Soup 1.9.1.
//!
//! How the values were made (Python, double precision). Start: x = [1, 0.5, 2, −0.25] in the order x, vx, y, vy,
//! P = diag(0.04, 1, 0.04, 1); noise of constant velocity with density 0.4 m²/s³; steps of [`STEPS`].
//! `filterpy.kalman.KalmanFilter` with R = 0.01·I. `ExtendedKalmanFilter` and `UnscentedKalmanFilter` with
//! `JulierSigmaPoints(4, kappa=-1)` see the same places as bearing and range from a sensor at (0.2, −0.1, 0.3 rad),
//! rounded to four digits, with R = diag(0.02², 0.1²); sigma points are drawn anew from the prediction.
//! `stonesoup.dataassociator.probability.JPDA` over `PDAHypothesiser(clutter_spatial_density=0.2, prob_detect=0.8,
//! prob_gate=1 − 1e-12)`: three tracks with variance 0.16, four detections with variance 0.09, no time between.

use floorguard_perception::people::filters::{
    ExtendedKalman, Gaussian, Observation, Particles, PersonFilter, Unscented,
};
use floorguard_perception::people::{ConstantVelocity, JointGroup};
use floorguard_types::geometry::{Point2, Pose2};

const DENSITY: f32 = 0.4;
const START: (Point2, Point2) = (Point2 { x_m: 1.0, y_m: 2.0 }, Point2 { x_m: 0.5, y_m: -0.25 });
/// Seconds, then x and y, then bearing and range.
const STEPS: [(f32, [f32; 2], [f32; 2]); 6] = [
    (0.1, [1.10, 1.90], [0.8479, 2.1932]),
    (0.1, [1.13, 1.91], [0.8374, 2.2147]),
    (0.25, [1.30, 1.80], [0.746, 2.1954]),
    (0.1, [1.34, 1.77], [0.7233, 2.1901]),
    (0.1, [1.45, 1.79], [0.6865, 2.266]),
    (0.1, [1.47, 1.75], [0.6692, 2.244]),
];
/// Mean, then the upper triangle of the covariance by rows.
const KALMAN: ([f32; 4], [f32; 10]) = (
    [1.481_688_4, 0.614_818_2, 1.743_769_9, -0.244_526_5],
    [
        0.004_903_084,
        0.014_863_36,
        0.0,
        0.0,
        0.114_814_75,
        0.0,
        0.0,
        0.004_903_084,
        0.014_863_36,
        0.114_814_75,
    ],
);
const EXTENDED: ([f32; 4], [f32; 10]) = (
    [1.479_526_4, 0.588_379_4, 1.745_819_9, -0.230_052_2],
    [
        0.002_383_685,
        0.008_746_67,
        0.001_701_196,
        0.004_132_848,
        0.083_809_57,
        0.004_457_271,
        0.020_146_79,
        0.003_730_416,
        0.011_791_456,
        0.101_258_86,
    ],
);
const UNSCENTED: ([f32; 4], [f32; 10]) = (
    [1.479_106_8, 0.597_515, 1.745_440_2, -0.223_314_2],
    [
        0.002_384_532,
        0.008_735_894,
        0.001_704_674,
        0.004_149_14,
        0.084_272_24,
        0.004_448_347,
        0.019_934_475,
        0.003_737_816,
        0.011_814_91,
        0.101_542_74,
    ],
);
/// By track: of each detection, and of none.
const JPDA: [[f32; 5]; 3] = [
    [0.675_428_6, 0.164_897_4, 0.070_203_1, 0.005_423_2, 0.084_047_7],
    [0.075_605_7, 0.434_638_3, 0.085_661_1, 0.332_584_7, 0.071_510_2],
    [0.075_560_6, 0.131_593, 0.683_472_3, 0.001_814_8, 0.107_559_4],
];

fn cartesian(place: [f32; 2]) -> Observation {
    Observation::Cartesian { position: Point2::new(place[0], place[1]), sigma_m: 0.1 }
}

fn polar(seen: [f32; 2]) -> Observation {
    let sensor = Pose2::new(0.2, -0.1, 0.3);
    Observation::Polar { sensor, bearing_rad: seen[0], range_m: seen[1], sigma: [0.02, 0.1] }
}

fn start() -> Gaussian {
    Gaussian::new(START.0, START.1, 0.2, 1.0)
}

fn run(filter: &mut dyn PersonFilter, polar_seen: bool) -> Gaussian {
    for (seconds, place, seen) in STEPS {
        filter.predict(seconds, DENSITY);
        let observation = if polar_seen { polar(seen) } else { cartesian(place) };
        assert!(filter.surprise(&observation).expect("a Gaussian").distance2 < 9.0);
        filter.update(&observation).expect("a Gaussian");
    }
    filter.gaussian()
}

fn assert_equal(name: &str, found: &Gaussian, (mean, covariance): &([f32; 4], [f32; 10])) {
    for (index, wanted) in mean.iter().enumerate() {
        assert!(
            (found.mean[index] - wanted).abs() < 2.0e-5,
            "{name}: mean {index}: {} {wanted}",
            found.mean[index]
        );
    }
    let upper = (0..4).flat_map(|row| (row..4).map(move |column| (row, column)));
    for ((row, column), wanted) in upper.zip(covariance) {
        let value = found.covariance[(row, column)];
        assert!((value - wanted).abs() < 1.0e-5, "{name}: covariance {row} {column}: {value} {wanted}");
    }
}

#[test]
fn kalman_filters_equal_filterpy() {
    let mut fast = ConstantVelocity::new(START.0, START.1, 0.2, 1.0);
    assert_equal("the tracker's own", &run(&mut fast, false), &KALMAN);
    assert_equal("extended, places", &run(&mut ExtendedKalman { state: start() }, false), &KALMAN);
    assert_equal("unscented, places", &run(&mut Unscented { state: start() }, false), &KALMAN);
    assert_equal("extended, bearings", &run(&mut ExtendedKalman { state: start() }, true), &EXTENDED);
    assert_equal("unscented, bearings", &run(&mut Unscented { state: start() }, true), &UNSCENTED);
}

/// The filter of particles is random: it must come near to what the others say.
#[test]
fn particles_agree_with_the_kalman_filters() {
    for (polar_seen, wanted) in [(false, KALMAN.0), (true, UNSCENTED.0)] {
        let mut filter = Box::new(Particles::<1_000>::new(&start(), 3));
        let found = run(&mut *filter, polar_seen);
        for (value, wanted) in [0, 2].map(|index| (found.mean[index], wanted[index])) {
            assert!((value - wanted).abs() < 0.04, "place: {value} {wanted}");
        }
        for (value, wanted) in [1, 3].map(|index| (found.mean[index], wanted[index])) {
            assert!((value - wanted).abs() < 0.25, "velocity: {value} {wanted}");
        }
        assert_eq!(filter.unexplained, 0);
    }
}

/// The test values of the book, Tracking: Filters, of the extended filter in bearing and range.
#[test]
fn the_polar_vector_of_the_specification_holds() {
    let state = Gaussian::new(Point2::new(2.0, 1.0), Point2::default(), 0.2, 1.0);
    let mut filter = ExtendedKalman { state };
    let seen =
        Observation::Polar { sensor: Pose2::default(), bearing_rad: 0.50, range_m: 2.30, sigma: [0.02, 0.1] };
    let surprise = filter.surprise(&seen).expect("a Gaussian");
    assert!((surprise.distance2.sqrt() - 0.488_945).abs() < 1.0e-4, "{surprise:?}");
    filter.update(&seen).expect("a Gaussian");
    let mean = filter.gaussian().mean;
    assert!((mean.x - 2.011_125).abs() < 1.0e-5 && (mean.z - 1.092_116).abs() < 1.0e-5, "{mean:?}");
}

#[test]
fn invalid_belief_is_refused_and_kept() {
    for sigma_m in [f32::NAN, f32::INFINITY] {
        let seen = Observation::Cartesian { position: Point2::new(f32::NAN, 0.0), sigma_m };
        let mut filter = ExtendedKalman { state: start() };
        assert!(filter.update(&seen).is_err());
        assert_eq!(filter.state, start());
        let mut filter = Unscented { state: start() };
        assert!(filter.update(&seen).is_err());
        assert_eq!(filter.state, start());
    }
}

#[test]
fn joint_probabilities_equal_stone_soup() {
    let tracks = [[0.0, 0.0], [1.0, 0.0], [0.4, 0.9_f32]];
    let detections = [[0.2, 0.0], [0.7, 0.1], [0.6, 0.6], [1.5, -0.5_f32]];
    let variance = 0.16 + 0.09_f32;
    let mut group = JointGroup { detections: 4, tracks: 3, ..JointGroup::EMPTY };
    for (row, detection) in detections.iter().enumerate() {
        for (column, track) in tracks.iter().enumerate() {
            let distance2 = (detection[0] - track[0]).powi(2) + (detection[1] - track[1]).powi(2);
            group.likelihood[row][column] =
                (-0.5 * distance2 / variance).exp() / (2.0 * std::f32::consts::PI * variance);
        }
    }
    let marginals = group.marginals();
    for (track, wanted) in JPDA.iter().enumerate() {
        for (found, wanted) in marginals.detection[track].iter().zip(&wanted[..4]) {
            assert!((found - wanted).abs() < 1.0e-5, "track {track}: {found} {wanted}");
        }
        assert!((marginals.missed[track] - wanted[4]).abs() < 1.0e-5, "track {track}: missed");
    }
}
