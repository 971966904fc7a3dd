//! Figures that evo 1.38.1 gave for the same two trajectories (its functions for association, alignment, absolute and
//! relative errors, with their default settings).

use nalgebra::{UnitQuaternion, Vector3};

use super::*;

fn truth(t: f64) -> TimedPose {
    let place_m =
        Vector3::new(3.0 * (0.31 * t).sin() + 0.4 * t, 2.0 * (0.23 * t).cos(), 0.1 * (0.5 * t).sin());
    let (roll, pitch) = (0.05 * t.sin(), 0.04 * (0.7 * t).cos());
    let yaw = 0.6 * (0.2 * t).sin() + 0.1 * t;
    TimedPose { time_s: t, place_m, rotation: UnitQuaternion::from_euler_angles(roll, pitch, yaw) }
}

fn result(t: f64) -> TimedPose {
    let place = truth(t).place_m;
    let x = place.x + 0.05 * (1.7 * t).sin();
    let y = place.y + 0.04 * (2.3 * t).cos() + 0.002 * t;
    let (sin, cos) = 0.7_f64.sin_cos();
    let place_m = Vector3::new(
        cos * x - sin * y + 5.0,
        sin * x + cos * y - 2.0,
        place.z + 0.03 * (0.9 * t).sin() + 1.0,
    );
    let roll = 0.05 * t.sin() + 0.01 * (3.0 * t).cos();
    let yaw = 0.6 * (0.2 * t).sin() + 0.1 * t + 0.7 + 0.02 * (1.1 * t).sin();
    let rotation = UnitQuaternion::from_euler_angles(roll, 0.04 * (0.7 * t).cos(), yaw);
    TimedPose { time_s: t, place_m, rotation }
}

fn pairs() -> Vec<PosePair> {
    let truth: Vec<TimedPose> = (0..300).map(|i| truth(0.1 * f64::from(i))).collect();
    let time = |i: i32| 0.05 * f64::from(i) + if i % 7 == 0 { 0.013 } else { 0.004 };
    let result: Vec<TimedPose> = (0..500).map(|i| result(time(i))).collect();
    associate(&truth, &result, 0.01)
}

fn check(errors: &[f64], count: usize, [rmse, mean, median, deviation, most]: [f64; 5]) {
    let found = ErrorStatistics::of(errors);
    assert_eq!(found.count, count);
    let both = [
        (found.rmse, rmse),
        (found.mean, mean),
        (found.median, median),
        (found.deviation, deviation),
        (found.most, most),
    ];
    for (ours, theirs) in both {
        assert!((ours - theirs).abs() < 1.0e-7, "{ours} {theirs}: {found:?}");
    }
}

#[test]
fn absolute_error_is_that_of_evo() {
    let key = [
        0.051_514_990_144_921_94,
        0.049_642_580_255_636_19,
        0.049_529_334_735_447_44,
        0.013_762_573_712_577_313,
        0.075_970_752_288_170_37,
    ];
    check(&absolute_errors(&pairs()), 214, key);
}

/// Root mean square, mean, median, deviation and largest of the translation, metres, and of the rotation, radians.
struct Key {
    step: StepLength,
    count: usize,
    translation: [f64; 5],
    rotation: [f64; 5],
}

const FRAMES: Key = Key {
    step: StepLength::Poses(1),
    count: 213,
    translation: [0.011_103_348, 0.010_206_874, 0.009_683_649, 0.004_370_818, 0.024_516_184],
    rotation: [0.003_200_058, 0.002_908_729, 0.002_771_523, 0.001_334_040, 0.006_958_101],
};
const FIVE_FRAMES: Key = Key {
    step: StepLength::Poses(5),
    count: 42,
    translation: [0.050_191_116, 0.048_332_959, 0.051_920_968, 0.013_530_454, 0.067_829_680],
    rotation: [0.014_030_645, 0.013_399_792, 0.013_774_059, 0.004_159_874, 0.020_423_756],
};
const METRES: Key = Key {
    step: StepLength::Metres(1.0),
    count: 18,
    translation: [0.075_682_044, 0.073_188_156, 0.072_994_854, 0.019_268_257, 0.101_532_027],
    rotation: [0.020_021_834, 0.018_794_756, 0.018_931_665, 0.006_901_520, 0.032_299_272],
};

#[test]
fn relative_error_is_that_of_evo() {
    for key in [FRAMES, FIVE_FRAMES, METRES] {
        let errors = relative_errors(&pairs(), key.step);
        check(&errors.translation_m, key.count, key.translation);
        check(&errors.rotation_rad, key.count, key.rotation);
    }
}

#[test]
fn too_few_pairs_give_no_error() {
    assert!(absolute_errors(&pairs()[..2]).is_empty());
    assert!(associate(&[truth(0.0)], &[result(1.0)], 0.5).is_empty());
    assert_eq!(ErrorStatistics::of(&[]).count, 0);
}
