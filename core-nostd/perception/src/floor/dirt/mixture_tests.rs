//! The mixture against test values of the book and of scikit-learn.

use super::*;

/// The test values of the book, Floor and dirt: Mixtures: five passes from a given start, as scikit-learn computes
/// them.
#[test]
fn equals_the_oracle_after_five_passes() {
    let points = [
        [1.0, 0.5],
        [1.2, 0.4],
        [0.9, 0.6],
        [1.1, 0.55],
        [1.05, 0.45],
        [3.0, 1.5],
        [3.2, 1.4],
        [2.9, 1.7],
        [3.1, 1.6],
        [6.0, 4.0],
    ];
    let mut mixture = Mixture::default();
    for mean in [[1.0, 0.5], [3.0, 1.5]] {
        mixture.components.push(Component { weight: 0.5, mean, covariance: [0.25, 0.0, 0.25] }).unwrap();
    }
    let rules = FitRules { passes: 5, tolerance: 0.0, variance_floor: 1.0e-3 };
    assert_eq!(mixture.fit(&points, &rules), 5);
    let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-4, "{a}, not {b}");
    let [one, two] = [mixture.components[0], mixture.components[1]];
    near(one.weight, 0.499_850_1);
    near(two.mean[0], 3.639_263_4);
    near(two.mean[1], 2.039_51);
    for (found, expected) in one.covariance.iter().zip([0.010_997, -0.005_497, 0.005_999]) {
        near(*found, expected);
    }
    for (found, expected) in two.covariance.iter().zip([1.404_775, 1.149_254, 0.971_910]) {
        near(*found, expected);
    }
    let expected = [
        2.378_617, 1.469_753, 1.469_613, 1.609_389, 2.203_619, -1.124_679, -2.281_523, -2.279_553,
        -1.078_469, -2.971_945,
    ];
    let scorer = mixture.scorer(0.0);
    for (point, expected) in points.iter().zip(expected) {
        near(scorer.log_likelihood(*point), expected);
    }
}

#[test]
fn exponential_is_that_of_the_library() {
    for step in 0..8_700_u16 {
        let x = -f32::from(step) * 0.01;
        let (found, exact) = (exp_of_negative(x), f64::from(x).exp());
        assert!((f64::from(found) - exact).abs() <= 4e-7 * exact, "{x}: {found}, not {exact}");
    }
    assert_eq!(exp_of_negative(-1.0e9), 0.0);
    assert_eq!(exp_of_negative(f32::NEG_INFINITY), 0.0);
}

#[test]
fn equal_points_and_starved_components_are_survived() {
    let points = [[2.0, 1.0]; 40];
    let mut mixture = Mixture::along_first_axis(&points, 3, 1.0e-3).unwrap();
    mixture.fit(&points, &FitRules::default());
    assert!(mixture.scorer(0.05).log_likelihood([2.0, 1.0]).is_finite());
    assert!(Mixture::along_first_axis(&points[..2], 3, 1.0e-3).is_none());
    assert!(Mixture::along_first_axis(&points, 6, 1.0e-3).is_none());
}

/// Four clouds of 30 points by a linear congruential generator, so that the oracle can make the same.
fn clouds() -> std::vec::Vec<Point> {
    let mut state = 12_345_u32;
    let mut uniform = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let middles = [[1.0, 0.6, 0.3], [2.5, 1.2, 0.5], [2.7, 1.9, 0.4], [6.0, 3.5, 2.0]];
    let point = |index: usize| {
        let [x, y, wide] = middles[index % 4];
        let (a, b, c, d) = (uniform(), uniform(), uniform(), uniform());
        let place = (x + wide * (a + b - 1.0), y + 0.7 * wide * (c + d - 1.0) + 0.3 * wide * (a - 0.5));
        [place.0 as f32, place.1 as f32]
    };
    (0..120).map(point).collect()
}

/// `sklearn.mixture.GaussianMixture` 1.9.1, full covariance, `reg_covar` 1e-3, from equal weights, precision 2 and the
/// points 0, 1, 3, (2, 7) as means: log-likelihood of every sixth point and the mean of all.
#[test]
fn equals_scikit_learn_from_the_same_start() {
    let three = [
        -1.385436, -0.14249, 1.178886, -1.353665, 1.356074, -1.342396, 1.279769, -0.295496, 1.018737,
        -1.057889, 1.123253, -1.204464, 0.297986, -0.513281, 1.030258, -0.587657, 1.484359, -1.655297,
        -1.09311, -0.41516,
    ];
    let five = [
        -1.385436, -0.131675, 1.178886, -1.361118, 1.356074, -1.340284, 1.279769, -0.295446, 1.018737,
        -1.043548, 1.123253, -1.206086, 0.297986, -0.493233, 1.030258, -0.583623, 1.484359, -1.666203,
        -1.09311, -0.397265,
    ];
    let points = clouds();
    for (count, passes, expected, mean) in [(3, 12, three, -1.029_936), (5, 8, five, -0.999_147)] {
        let mut mixture = Mixture::default();
        for index in [0, 1, 3, 2, 7].into_iter().take(count) {
            let weight = 1.0 / count as f32;
            mixture
                .components
                .push(Component { weight, mean: points[index], covariance: [0.5, 0.0, 0.5] })
                .unwrap();
        }
        let rules = FitRules { passes, tolerance: 0.0, variance_floor: 1.0e-3 };
        assert_eq!(mixture.fit(&points, &rules), passes);
        let scorer = mixture.scorer(0.0);
        for (point, expected) in points.iter().step_by(6).zip(expected) {
            let found = scorer.log_likelihood(*point);
            assert!((found - expected).abs() < 1e-4, "{count} components: {found}, not {expected}");
        }
        let found = points.iter().map(|point| scorer.log_likelihood(*point)).sum::<f32>() / 120.0;
        assert!((found - mean).abs() < 1e-4, "{count} components: mean {found}, not {mean}");
    }
}
