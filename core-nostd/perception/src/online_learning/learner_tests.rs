//! The learner on shapes whose truth is known: it learns what is new, and refuses what would make it worse.

use std::boxed::Box;
use std::vec::Vec;

use super::*;
use crate::shapes::person_model::person_log_odds;
use crate::shapes::shape::{SHAPE_FEATURES, ShapeVector};
use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;
use floorguard_types::time::Stamp;

fn near(middle: &ShapeVector, spread: f32, random: &mut Pcg32) -> ShapeVector {
    let mut shape = *middle;
    for value in &mut shape {
        *value += random.uniform_between(-spread, spread);
    }
    shape
}

/// Shapes from the whole range of the shipped table that it calls people, or others, without much doubt.
fn surely(is_person: bool, count: usize, random: &mut Pcg32) -> Vec<ShapeVector> {
    let mut found = Vec::new();
    for _ in 0..400_000 {
        let shape = near(&[0.6; SHAPE_FEATURES], 0.6, random);
        let log_odds = person_log_odds(&shape);
        if (log_odds > 0.5) == is_person && log_odds.abs() > 0.5 {
            found.push(shape);
            if found.len() == count {
                break;
            }
        }
    }
    assert_eq!(found.len(), count);
    found
}

fn anchors(random: &mut Pcg32) -> Vec<LabelledShape> {
    let (people, others) = (surely(true, 200, random), surely(false, 200, random));
    let label = |shapes: Vec<ShapeVector>, is_person| {
        shapes.into_iter().map(move |shape| LabelledShape { shape, is_person })
    };
    label(people, true).chain(label(others, false)).collect()
}

/// Plays tracks of 12 s, a walker and a stander at a time, and lets the learner learn in between.
fn play(learner: &mut OnlineLearner, walkers: &[ShapeVector], standers: &[ShapeVector], random: &mut Pcg32) {
    for round in 0..60_u32 {
        let began_us = u64::from(round) * 16_000_000;
        for step in 0..120_u32 {
            let stamp = Stamp::from_micros(began_us + u64::from(step) * 100_000);
            let pick = |shapes: &[ShapeVector], random: &mut Pcg32| {
                shapes[random.below(shapes.len() as u32) as usize]
            };
            let (walker, stander) = (pick(walkers, random), pick(standers, random));
            let walked = Point2::new(0.1 * step as f32, 3.0);
            let sights = [
                Sight { track: 2 * round, position: walked, shape: Some(&walker) },
                Sight { track: 2 * round + 1, position: Point2::new(5.0, 0.0), shape: Some(&stander) },
            ];
            learner.observe(stamp, sights.into_iter());
            learner.learn(40);
        }
    }
}

/// An object that the shipped table takes for a person, unlike the people of the anchors and of the place.
#[test]
fn standing_object_is_learnt_without_forgetting_people() {
    let mut random = Pcg32::new(7, 7);
    let anchors = anchors(&mut random);
    let people = surely(true, 300, &mut random);
    let doubtful = (0..400_000).map(|_| near(&[0.9; SHAPE_FEATURES], 0.9, &mut random)).find(|shape| {
        let log_odds = person_log_odds(shape);
        (0.3..1.0).contains(&log_odds)
    });
    let doubtful_shape = doubtful.expect("a doubtful shape");
    let similar: Vec<ShapeVector> = (0..100).map(|_| near(&doubtful_shape, 0.01, &mut random)).collect();
    let mut learner = Box::new(OnlineLearner::new(&anchors, ExpertRules::DEFAULT));
    assert_eq!(learner.log_odds(&doubtful_shape), person_log_odds(&doubtful_shape));
    play(&mut learner, &people, &similar, &mut random);
    let counters = learner.counters();
    assert!(counters.people >= 50 && counters.non_people >= 50, "{counters:?}");
    assert!(counters.accepted >= 1, "{counters:?}");
    assert!(learner.log_odds(&doubtful_shape) < 0.0, "{}", learner.log_odds(&doubtful_shape));
    let [shipped, used] = learner.agreement().expect("it was judged");
    assert!(used.rejected > shipped.rejected + 0.1 && used.recall >= shipped.recall, "{shipped:?} {used:?}");
    let [shipped, now] = learner.on_anchors();
    assert!(now.recall >= shipped.recall - 0.005 && now.rejected >= shipped.rejected - 0.005);
    // What was learnt can be kept and taken up again.
    let weights = *learner.weights();
    let mut again = Box::new(OnlineLearner::new(&anchors, ExpertRules::DEFAULT));
    assert!(again.resume(&weights));
    assert_eq!(again.log_odds(&doubtful_shape), learner.log_odds(&doubtful_shape));
    // Weights that would forget people are not taken up.
    assert!(!again.resume(&Weights { offset: -3.0, ..Weights::ZERO }));
    assert!(!again.resume(&Weights { offset: f32::NAN, ..Weights::ZERO }));
}

/// People who stand are labelled nobody by the expert: what follows from that is thrown away.
#[test]
fn labels_that_are_wrong_are_refused() {
    let mut random = Pcg32::new(8, 8);
    let anchors = anchors(&mut random);
    let people: Vec<ShapeVector> = surely(true, 300, &mut random);
    let mut learner =
        Box::new(OnlineLearner::new(&anchors, ExpertRules { certain: 30.0, ..ExpertRules::DEFAULT }));
    play(&mut learner, &people, &people, &mut random);
    let counters = learner.counters();
    assert!(counters.non_people >= 50 && counters.rejected >= 10, "{counters:?}");
    let [shipped, now] = learner.on_anchors();
    assert!(now.recall >= shipped.recall - 0.005, "{shipped:?} {now:?}");
}

/// Without labels of both kinds nothing is learnt, however long.
#[test]
fn walkers_alone_teach_nothing() {
    let mut random = Pcg32::new(9, 9);
    let anchors = anchors(&mut random);
    let people = surely(true, 100, &mut random);
    let mut learner = Box::new(OnlineLearner::new(&anchors, ExpertRules::DEFAULT));
    for step in 0..100_u32 {
        let position = Point2::new(0.1 * step as f32, 0.0);
        let sight = Sight { track: 1, position, shape: people.get(step as usize) };
        learner.observe(Stamp::from_micros(u64::from(step) * 100_000), core::iter::once(sight));
        learner.learn(1_000);
    }
    assert_eq!(*learner.weights(), Weights::ZERO);
    assert_eq!(learner.counters().accepted, 0);
}
