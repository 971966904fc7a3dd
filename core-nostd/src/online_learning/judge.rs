//! Is a correction better than what is in use? Asked of samples that it did not learn from.
//!
//! Two sets: what was held out in this place, and the anchors, labelled by the truth of a simulation. The place says
//! whether anything was gained; the anchors, that no person was forgotten for it: the experts err, and whoever stands is
//! labelled nobody by them.

use super::basis::Basis;
use super::samples::{LabelledShape, SampleStore};
use super::weights::Weights;
use crate::people::shape::ShapeVector;

/// Anchors of each class that may be lost against the shipped classifier, as a share.
const ANCHOR_LOSS_MAX: f32 = 0.005;
/// Held-out looks of each class that may be lost in the place against what is in use, as a share.
const PLACE_LOSS_MAX: f32 = 0.01;
/// Mean surprise on the anchors may grow by this against the shipped classifier.
const ANCHOR_SURPRISE_MAX: f32 = 0.02;
/// Mean surprise in the place must fall by this.
const GAIN_MIN: f32 = 0.002;
/// Held-out samples of each class without which nobody can say.
const HELD_OUT_MIN: usize = 24;

/// How a model stands on samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Standing {
    /// Share of the people that are called people.
    pub recall: f32,
    /// Share of the others that are called others.
    pub rejected: f32,
    /// Mean of −ln of the probability given to the truth; both classes weigh the same.
    pub surprise: f32,
}

/// Measures a model on the shapes of nobody and those of people.
fn standing<'a>(
    log_odds: impl Fn(&ShapeVector) -> f32,
    others: impl Iterator<Item = &'a ShapeVector>,
    people: impl Iterator<Item = &'a ShapeVector>,
) -> Standing {
    let (recall, missed) = towards(people.map(&log_odds));
    let (rejected, fooled) = towards(others.map(|shape| -log_odds(shape)));
    Standing { recall, rejected, surprise: 0.5 * (missed + fooled) }
}

/// Of log-odds towards the truth: the share that is right, and the mean surprise.
fn towards(values: impl Iterator<Item = f32>) -> (f32, f32) {
    let (mut right, mut surprise, mut count) = (0.0_f32, 0.0_f32, 0.0_f32);
    for toward in values {
        right += f32::from(u8::from(toward > 0.0));
        surprise += libm::log1pf(libm::expf(-toward.clamp(-30.0, 30.0)));
        count += 1.0;
    }
    (right / count.max(1.0), surprise / count.max(1.0))
}

/// On the samples held out in the place; `None` while there are too few.
pub(super) fn in_place(weights: &Weights, basis: &Basis, store: &SampleStore) -> Option<Standing> {
    let enough = store.held_out_counts().iter().all(|count| *count >= HELD_OUT_MIN);
    let log_odds = |shape: &ShapeVector| weights.log_odds(basis, shape);
    enough.then(|| standing(log_odds, store.held_out(false).iter(), store.held_out(true).iter()))
}

/// On the anchors.
pub(super) fn on_anchors(weights: &Weights, basis: &Basis, anchors: &[LabelledShape]) -> Standing {
    let of = |class: bool| {
        anchors.iter().filter(move |anchor| anchor.is_person == class).map(|anchor| &anchor.shape)
    };
    standing(|shape| weights.log_odds(basis, shape), of(false), of(true))
}

/// Whether new weights may take the place of those in use. `shipped` is the standing of no correction on the anchors.
pub(super) fn is_better(new: (Standing, Standing), used: Standing, shipped: Standing) -> bool {
    let (place, anchors) = new;
    let keeps = |now: Standing, before: Standing, most: f32| {
        now.recall >= before.recall - most && now.rejected >= before.rejected - most
    };
    place.surprise <= used.surprise - GAIN_MIN
        && keeps(place, used, PLACE_LOSS_MAX)
        && keeps(anchors, shipped, ANCHOR_LOSS_MAX)
        && anchors.surprise <= shipped.surprise + ANCHOR_SURPRISE_MAX
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn better_in_the_place_and_not_worse_on_the_anchors() {
        let used = Standing { recall: 0.9, rejected: 0.6, surprise: 0.5 };
        let shipped = Standing { recall: 0.95, rejected: 0.9, surprise: 0.2 };
        let good = Standing { surprise: 0.4, ..used };
        assert!(is_better((good, shipped), used, shipped));
        assert!(!is_better((used, shipped), used, shipped));
        assert!(!is_better((Standing { recall: 0.85, ..good }, shipped), used, shipped));
        assert!(!is_better((Standing { rejected: 0.55, ..good }, shipped), used, shipped));
        assert!(!is_better((good, Standing { recall: 0.94, ..shipped }), used, shipped));
        assert!(!is_better((good, Standing { rejected: 0.89, ..shipped }), used, shipped));
        assert!(!is_better((good, Standing { surprise: 0.25, ..shipped }), used, shipped));
        assert!(!is_better((Standing { surprise: f32::NAN, ..good }, shipped), used, shipped));
    }
}
