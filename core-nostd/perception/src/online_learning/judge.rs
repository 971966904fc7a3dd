//! Is a correction better than what is in use? Asked of samples that it did not learn from.
//!
//! Two sets: what was held out in this place, and the anchors, labelled by the truth of a simulation. The place says
//! whether anything was gained; the anchors, that no person was forgotten for it: the experts err, and a standing
//! person is labelled as none by them. An update is refused unless it decides more held-out shapes correctly, and none
//! of either class less rightly: objects outnumber people by far, so that a hundredth of them is much of the precision.

use super::basis::Basis;
use super::samples::{LabelledShape, SampleStore};
use super::weights::Weights;
use crate::shapes::shape::ShapeVector;

/// People among the anchors that may be lost against the shipped classifier, as a share, and others.
const ANCHOR_LOSS_MAX: [f32; 2] = [0.005, 0.002];
/// Gain in correctly decided held-out shapes of the place over the model in use, the shares of both classes added.
const PLACE_GAIN_MIN: f32 = 0.02;
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

/// What new weights are compared with: how those in use and no correction stand in the place, and no correction on the
/// anchors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Baselines {
    pub used: Standing,
    pub shipped: Standing,
    pub shipped_on_anchors: Standing,
}

/// Whether new weights, with their standing in the place, may take the place of those in use.
pub(super) fn is_better(place: Standing, anchors: Standing, rivals: &Baselines) -> bool {
    let Baselines { used, shipped, shipped_on_anchors } = *rivals;
    let keeps = |before: Standing| place.recall >= before.recall && place.rejected >= before.rejected;
    let gained = place.recall - used.recall + place.rejected - used.rejected;
    place.surprise <= used.surprise - GAIN_MIN
        && gained >= PLACE_GAIN_MIN
        && keeps(used)
        && keeps(shipped)
        && is_harmless(anchors, shipped_on_anchors)
}

/// Nothing that is known for sure is forgotten.
pub(super) fn is_harmless(anchors: Standing, shipped: Standing) -> bool {
    let [people, others] = ANCHOR_LOSS_MAX;
    anchors.recall >= shipped.recall - people
        && anchors.rejected >= shipped.rejected - others
        && anchors.surprise <= shipped.surprise + ANCHOR_SURPRISE_MAX
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn update_must_improve_place_and_keep_anchors() {
        let used = Standing { recall: 0.9, rejected: 0.6, surprise: 0.5 };
        let anchors = Standing { recall: 0.95, rejected: 0.9, surprise: 0.2 };
        let rivals = Baselines { used, shipped: used, shipped_on_anchors: anchors };
        let good = Standing { rejected: 0.7, surprise: 0.4, ..used };
        assert!(is_better(good, anchors, &rivals));
        let refused = [
            used,
            // Surer of the same answers.
            Standing { surprise: 0.4, ..used },
            Standing { rejected: 0.61, ..good },
            Standing { surprise: 0.5, ..good },
            Standing { surprise: f32::NAN, ..good },
            // Much won among the objects, a person lost.
            Standing { recall: 0.895, rejected: 0.9, ..good },
            Standing { recall: 1.0, rejected: 0.595, ..good },
        ];
        for place in refused {
            assert!(!is_better(place, anchors, &rivals), "{place:?}");
        }
        // What was won since the start must not be lost again by and by.
        let before = Baselines { shipped: Standing { recall: 0.91, ..used }, ..rivals };
        assert!(!is_better(good, anchors, &before));
        for worse in [
            Standing { recall: 0.94, ..anchors },
            Standing { rejected: 0.895, ..anchors },
            Standing { surprise: 0.25, ..anchors },
        ] {
            assert!(!is_better(good, worse, &rivals), "{worse:?}");
        }
    }
}
