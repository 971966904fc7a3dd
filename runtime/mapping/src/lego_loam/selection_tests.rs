use nalgebra::Vector3;

use super::*;
use crate::lego_loam::features::Feature;

/// A row of returns with these ranges, 0.2° apart.
fn row(ranges: &[f32], is_ground: bool) -> SegmentedCloud {
    let one = |(column, range_m): (usize, &f32)| Segmented {
        feature: Feature { point: Vector3::new(*range_m, column as f32, 0.0), row: 0, time_share: 0.0 },
        range_m: *range_m,
        column,
        is_ground,
    };
    SegmentedCloud::of(ranges.iter().enumerate().map(one).collect())
}

#[test]
fn hidden_side_of_a_step_is_marked() {
    let mut ranges = vec![4.0; 20];
    ranges.extend([6.0; 20]);
    let cloud = row(&ranges, false);
    let selection = Selection::new(&cloud.returns);
    // The far side, six returns: what is behind the near wall's end.
    let taken: Vec<usize> = (0..40).filter(|index| selection.is_taken[*index]).collect();
    assert_eq!(taken, [20, 21, 22, 23, 24, 25]);
    ranges.reverse();
    let cloud = row(&ranges, false);
    let selection = Selection::new(&cloud.returns);
    let taken: Vec<usize> = (0..40).filter(|index| selection.is_taken[*index]).collect();
    assert_eq!(taken, [14, 15, 16, 17, 18, 19]);
}

#[test]
fn single_returns_are_along_the_view() {
    let mut ranges = vec![4.0; 40];
    ranges[20] = 4.2;
    let cloud = row(&ranges, false);
    let selection = Selection::new(&cloud.returns);
    assert!(selection.is_taken[20] && !selection.is_taken[19] && !selection.is_taken[21]);
}

#[test]
fn edges_and_flats_are_picked_by_sector() {
    // A zigzag: each fold is an edge, 20 returns apart; 600 returns in six sectors.
    let range = |index: usize| 5.0 + 0.02 * (index % 40).abs_diff(20) as f32;
    let ranges: Vec<f32> = (0..600).map(range).collect();
    let features = select(&row(&ranges, false), &LegoLoamConfig::default());
    assert_eq!(features.sharp.len(), 6 * SHARP);
    assert!(features.less_sharp.len() > 20 && features.flat.is_empty());
    let at_fold = |feature: &Feature| {
        let within = feature.point.y as usize % 20;
        within <= 1 || within >= 19
    };
    assert!(features.sharp.iter().all(at_fold), "{:?}", features.sharp);
    // Picked edges are more than five columns apart.
    let mut columns: Vec<usize> =
        features.less_sharp.iter().map(|feature| feature.point.y as usize).collect();
    columns.sort_unstable();
    assert!(columns.windows(2).all(|pair| pair[1] - pair[0] > SIDE), "{columns:?}");
    let ground = select(&row(&vec![5.0; 600], true), &LegoLoamConfig::default());
    assert_eq!((ground.flat.len(), ground.less_sharp.len()), (6 * FLAT, 0));
    assert!(ground.less_flat.len() < 600);
}
