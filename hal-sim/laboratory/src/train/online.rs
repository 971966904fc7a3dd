//! A robot in a new place: what the shipped classifier says, and what it says after learning from tracks.
//!
//! Every sample is scored before it is learnt from. The truth of the simulation only counts; the learner never sees
//! it.

use floorguard_perception::online_learning::{
    ExpertRules, LabelledShape, LearnerCounters, OnlineLearner, Sight, Weights,
};
use floorguard_perception::people::person_model::person_log_odds;
use floorguard_perception::people::{PeoplePipeline, RingAngles, SweepContext};
use floorguard_sim::Scenario;
use floorguard_types::geometry::{Pose2, Twist2};
use serde::Serialize;

use super::person_samples::{is_person, person_samples};
use super::scenes::random_scenes;
use super::simulated::{LabelledSweep, SceneRun, play};
use floorguard_robot::learning::own_detection;

/// Seed of the scenes of the anchors: the shipped table was trained on others.
const ANCHOR_SEED: u64 = 90_000;
/// Steps of learning for each sweep: a judgement every five seconds.
const STEPS: u16 = 40;
/// Sweeps a second.
const SWEEPS_PER_S: usize = 10;
/// A window of the report, seconds.
const WINDOW_S: usize = 10;
/// Farther samples are not counted, metres.
const RANGE_MAX_M: f32 = 25.0;

/// A place to learn in.
#[derive(Clone, Debug)]
pub struct OnlinePlace {
    /// For the report.
    pub name: String,
    /// The place; the robot stands at its start.
    pub scenario: Scenario,
    /// Seed of the run.
    pub seed: u64,
    /// How long the robot stands there.
    pub seconds: usize,
    /// Every length is multiplied by this: people and objects of other sizes than those learnt from.
    pub scale: f32,
    /// Height of the lidar before scaling, metres.
    pub sensor_height_m: f32,
}

/// Right and wrong answers of one classifier.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Answers {
    /// People called people.
    pub found: u32,
    /// People called something else.
    pub missed: u32,
    /// Others called people.
    pub wrong: u32,
    /// Others called others.
    pub rejected: u32,
}

impl Answers {
    fn count(&mut self, called: bool, truth: bool) {
        match (called, truth) {
            (true, true) => self.found += 1,
            (false, true) => self.missed += 1,
            (true, false) => self.wrong += 1,
            (false, false) => self.rejected += 1,
        }
    }

    /// Adds others.
    pub fn add(&mut self, other: &Self) {
        self.found += other.found;
        self.missed += other.missed;
        self.wrong += other.wrong;
        self.rejected += other.rejected;
    }

    /// Share of what is called a person that is one; 1 where nothing is called so.
    #[must_use]
    pub fn precision(&self) -> f64 {
        let called = self.found + self.wrong;
        if called == 0 { 1.0 } else { f64::from(self.found) / f64::from(called) }
    }

    /// Share of the people that are called people; 1 where nobody is.
    #[must_use]
    pub fn recall(&self) -> f64 {
        let people = self.found + self.missed;
        if people == 0 { 1.0 } else { f64::from(self.found) / f64::from(people) }
    }

    /// Harmonic mean of both.
    #[must_use]
    pub fn f1(&self) -> f64 {
        let (precision, recall) = (self.precision(), self.recall());
        2.0 * precision * recall / (precision + recall).max(1e-9)
    }
}

/// A stretch of time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct OnlineWindow {
    /// Its end, seconds from the start.
    pub until_s: f64,
    /// The shipped classifier.
    pub shipped: Answers,
    /// The same with what was learnt until each sample.
    pub learned: Answers,
    /// Precision and recall of the shipped classifier, then with what was learnt.
    pub precision_recall: [[f64; 2]; 2],
    /// Tracks labelled people so far, labelled nobody, left alone.
    pub labelled: [u32; 3],
    /// Corrections taken over and thrown away so far.
    pub judged: [u32; 2],
}

/// What became of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OnlineReport {
    /// The place.
    pub place: String,
    /// Seed of the run.
    pub seed: u64,
    /// The shipped classifier over all windows.
    pub shipped: Answers,
    /// With what was learnt, over all windows.
    pub learned: Answers,
    /// Precision and recall over the second half of the time: shipped, learned.
    pub second_half: [[f64; 2]; 2],
    /// Recall and surprise on the anchors: shipped, learned.
    pub anchors: [[f32; 2]; 2],
    /// By time.
    pub windows: Vec<OnlineWindow>,
}

/// Samples with a known truth that did not make the shipped table, from `scenes` random rooms.
#[must_use]
pub fn anchors(scenes: u64) -> Vec<LabelledShape> {
    let samples = person_samples(&random_scenes(ANCHOR_SEED, scenes));
    let of = |is_person: bool| {
        let own = samples.iter().filter(move |sample| sample.positive == is_person);
        own.map(move |sample| LabelledShape { shape: sample.features, is_person })
    };
    // Alternately, so that a cut leaves as many of each.
    of(true).zip(of(false)).flat_map(|(person, other)| [person, other]).collect()
}

/// Lets a robot stand in a place and learn. Starts from `before`, if that is still good on the anchors.
#[must_use]
pub fn learn_place(
    place: &OnlinePlace,
    anchors: &[LabelledShape],
    before: Option<&Weights>,
) -> (OnlineReport, Weights) {
    let mut learner = Box::new(OnlineLearner::new(anchors, ExpertRules::DEFAULT));
    if let Some(weights) = before {
        learner.resume(weights);
    }
    let mut pipeline = Box::new(PeoplePipeline::new(RingAngles::vlp16()));
    let run = SceneRun {
        scenario: place.scenario.clone(),
        seed: place.seed,
        scale: place.scale,
        sensor_height_m: place.sensor_height_m,
        starts_us: 100_000,
    };
    let mut windows = vec![OnlineWindow::default()];
    let mut sweeps = 0;
    play(&run, (place.seconds * SWEEPS_PER_S, 1), &mut |labelled| {
        if sweeps > 0 && sweeps % (WINDOW_S * SWEEPS_PER_S) == 0 {
            windows.push(OnlineWindow::default());
        }
        sweeps += 1;
        if let Some(window) = windows.last_mut() {
            score_and_learn(&mut pipeline, &mut learner, &labelled, window);
            close(window, sweeps, learner.counters());
        }
    });
    (report(place, &learner, windows), *learner.weights())
}

/// One sweep: ask, count, learn.
fn score_and_learn(
    pipeline: &mut PeoplePipeline,
    learner: &mut OnlineLearner,
    labelled: &LabelledSweep,
    window: &mut OnlineWindow,
) {
    let context = SweepContext {
        sensor_in_base: labelled.sensor_in_base,
        twist: Twist2::ZERO,
        base_in_odom: Pose2::default(),
    };
    pipeline.process(&labelled.sweep, &context);
    for (index, detection) in pipeline.detections().iter().enumerate() {
        let truth = is_person(detection.position, labelled).filter(|_| detection.distance_m < RANGE_MAX_M);
        if let Some((truth, shape)) = truth.zip(pipeline.shape(index)) {
            window.shipped.count(person_log_odds(shape) > 0.0, truth);
            window.learned.count(learner.log_odds(shape) > 0.0, truth);
        }
    }
    let stamp = labelled.sweep.end_stamp;
    let seen = pipeline.tracker().tracks().iter().filter(|track| track.last_seen == stamp);
    let sights = seen.map(|track| {
        let position = track.state.position;
        let own = own_detection(pipeline, position);
        Sight { track: track.id, position, shape: own.and_then(|index| pipeline.shape(index)) }
    });
    learner.observe(stamp, sights);
    learner.learn(STEPS);
}

fn close(window: &mut OnlineWindow, sweeps: usize, counters: LearnerCounters) {
    window.until_s = sweeps as f64 / SWEEPS_PER_S as f64;
    window.precision_recall = [window.shipped, window.learned].map(|one| [one.precision(), one.recall()]);
    window.labelled = [counters.people, counters.non_people, counters.silent];
    window.judged = [counters.accepted, counters.rejected];
}

fn report(place: &OnlinePlace, learner: &OnlineLearner, windows: Vec<OnlineWindow>) -> OnlineReport {
    let sum = |windows: &[OnlineWindow]| {
        let mut total = [Answers::default(); 2];
        for window in windows {
            total[0].add(&window.shipped);
            total[1].add(&window.learned);
        }
        total
    };
    let [shipped, learned] = sum(&windows);
    let late = sum(&windows[windows.len() / 2..]);
    OnlineReport {
        place: place.name.clone(),
        seed: place.seed,
        shipped,
        learned,
        second_half: late.map(|one| [one.precision(), one.recall()]),
        anchors: learner.on_anchors().map(|standing| [standing.recall, standing.surprise]),
        windows,
    }
}
