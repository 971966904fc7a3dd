//! Slopes against differences, and whether it learns at all.

use floorguard_detector::{Model as _, RgbPicture};
use floorguard_types::random::Pcg32;

use super::loss::loss;
use super::*;

fn ramp(seed: u64) -> Vec<f32> {
    let mut random = Pcg32::new(seed, 1);
    (0..3 * 160 * 128).map(|_| random.uniform_between(0.0, 255.0)).collect()
}

/// The slope of the loss in a weight of each layer is what a small change of that weight makes of the loss.
#[test]
fn slopes_equal_differences_of_the_loss() {
    let mut network = Network::new(5);
    let planes = ramp(2);
    let person = |edges| LabelledPerson { edges, is_doubtful: false };
    let people = [
        person([10.0, 20.0, 24.0, 50.0]),
        person([60.0, 20.0, 90.0, 90.0]),
        person([100.0, 5.0, 150.0, 118.0]),
    ];
    let passed = network.pass(&planes);
    let (_, slopes) = loss(&passed.grids, &people);
    network.learn(&passed, &slopes);
    let cost = |network: &Network| f64::from(loss(&network.pass(&planes).grids, &people).0);
    for layer in 0..network.trunk.len() {
        let count = network.trunk[layer].weights.len();
        // The weight with the steepest slope stands farthest above the rounding of the sums.
        let steep = |index: &usize| network.trunk[layer].weight_gradient(*index).abs();
        let index = (0..count).max_by(|a, b| steep(a).total_cmp(&steep(b))).unwrap();
        let expected = f64::from(network.trunk[layer].weight_gradient(index));
        let moved = |by: f32| {
            let mut other = network.clone();
            other.trunk[layer].weights[index] += by;
            cost(&other)
        };
        let step = 2.0e-3;
        let found = (moved(step) - moved(-step)) / (2.0 * f64::from(step));
        assert!(
            (found - expected).abs() <= 0.05 * expected.abs() + 0.05,
            "layer {layer}: {found}, {expected}"
        );
    }
}

/// Pictures with and without a bright body: the loss falls by half in the best round, which is kept, and the same seed gives the same network.
#[test]
fn training_lowers_the_loss_and_repeats() {
    let picture = |at: Option<u32>| {
        let inside =
            |x: u32, y: u32| at.is_some_and(|left| (left..left + 24).contains(&x) && (30..90).contains(&y));
        let octets = (0..120).flat_map(|y| {
            (0..160)
                .flat_map(move |x| if inside(x, y) { [220, 210, 30] } else { [90, 100 + (x % 7) as u8, 95] })
        });
        let edges = at.map(|left| [left as f32, 30.0, left as f32 + 24.0, 90.0]);
        LabelledPicture {
            picture: RgbPicture::new([160, 120], octets.collect()).unwrap(),
            people: edges.iter().map(|edges| LabelledPerson { edges: *edges, is_doubtful: false }).collect(),
        }
    };
    let pictures: Vec<_> =
        [Some(8), None, Some(50), Some(100), None, Some(126), Some(30), Some(76)].map(picture).into();
    let mut costs = Vec::new();
    let network =
        train_detector(&pictures, DetectorTraining { rounds: 14, seed: 3 }, |_, cost| costs.push(cost));
    let least = costs.iter().copied().fold(f32::INFINITY, f32::min);
    assert!(least < 0.5 * costs[0], "{costs:?}");
    let again = train_detector(&pictures, DetectorTraining { rounds: 14, seed: 3 }, |_, _| {});
    let answer = |network: &Network| network.clone().run(ramp(3)).unwrap().values;
    assert_eq!(answer(&network), answer(&again), "the same seed, the same bits");
}
