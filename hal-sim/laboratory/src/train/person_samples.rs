//! Shapes of candidates with the truth about them.

use floorguard_perception::people::shape::SHAPE_FEATURES;
use floorguard_perception::people::{PeoplePipeline, RingAngles, SweepContext};
use floorguard_sim::people::PersonKind;
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::random::Pcg32;
use rayon::prelude::*;

use super::boosting::Sample;
use super::simulated::{LabelledSweep, SceneRun, play};

/// Samples of people's shapes.
pub type Samples = Vec<Sample<SHAPE_FEATURES>>;

/// Farther than this from everybody it is nobody, metres; between the two the truth cannot say.
const NO_PERSON_M: f32 = 0.9;
/// Candidates farther than this are not learnt from, metres: a handful of returns is left there.
const RANGE_MAX_M: f32 = 25.0;
/// Sweeps a scene, and sweeps from one to the next.
const SWEEPS: (usize, usize) = (4, 4);

/// How much broader an object may be than the simulator's: its people have no arms, coats or bags.
const PEOPLE_STRETCH: (f32, f32) = (0.95, 1.4);
const OBJECT_STRETCH: (f32, f32) = (0.7, 1.4);

/// Stretches every sample along the floor by a random factor. Lengths on the floor grow with it, so do slopes of floor
/// over height; heights and shares stay.
#[must_use]
pub fn stretched(samples: &Samples, seed: u64) -> Samples {
    let mut random = Pcg32::new(seed, 32);
    let stretch = |sample: &Sample<SHAPE_FEATURES>| {
        let (low, high) = if sample.positive { PEOPLE_STRETCH } else { OBJECT_STRETCH };
        let factor = random.uniform_between(low, high);
        let mut features = sample.features;
        for (value, along_floor) in features.iter_mut().zip(ALONG_FLOOR) {
            // Unseen slices are marked by a negative width, which must stay as it is; a slope may have either sign.
            if along_floor == Floor::Length && *value >= 0.0 || along_floor == Floor::Signed {
                *value *= factor;
            }
        }
        Sample { features, positive: sample.positive }
    };
    samples.iter().map(stretch).collect()
}

/// How a number of the shape follows a stretch along the floor.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Floor {
    /// Not at all.
    Fixed,
    /// A length or unsigned slope; negative where nothing was seen.
    Length,
    /// A length or slope of either sign.
    Signed,
}

/// In the order of [`SHAPE_NAMES`](floorguard_perception::people::shape::SHAPE_NAMES).
const ALONG_FLOOR: [Floor; SHAPE_FEATURES] = {
    use Floor::{Fixed, Length, Signed};
    let widths = [Length; 6];
    let [a, b, c, d, e, f] = widths;
    [
        a, b, c, d, e, f, Fixed, Fixed, Fixed, Fixed, Fixed, Length, Length, Fixed, Fixed, Length, Signed,
        Signed, Fixed, Length, Length, Fixed, Length, Fixed,
    ]
};

/// Plays all scenes, on all cores; the order of the samples does not depend on the number of cores.
#[must_use]
pub fn person_samples(scenes: &[SceneRun]) -> Samples {
    let each: Vec<Samples> = scenes
        .par_iter()
        .map(|scene| {
            let mut pipeline = Box::new(PeoplePipeline::new(RingAngles::vlp16()));
            let mut samples = Samples::new();
            play(scene, SWEEPS, &mut |labelled| label(&mut pipeline, &labelled, &mut samples));
            samples
        })
        .collect();
    each.into_iter().flatten().collect()
}

fn label(pipeline: &mut PeoplePipeline, labelled: &LabelledSweep, samples: &mut Samples) {
    let context = SweepContext {
        sensor_in_base: labelled.sensor_in_base,
        twist: Twist2::ZERO,
        base_in_odom: Pose2::default(),
    };
    pipeline.find_clusters(&labelled.sweep, &context);
    pipeline.find_detections(&labelled.sweep, &context);
    for (index, detection) in pipeline.detections().iter().enumerate() {
        let truth = is_person(detection.position, labelled);
        if detection.distance_m < RANGE_MAX_M
            && let (Some(is_person), Some(shape)) = (truth, pipeline.shape(index))
        {
            samples.push(Sample { features: *shape, positive: is_person });
        }
    }
}

/// Somebody stands where the candidate does; `None` where the truth cannot say.
#[must_use]
pub fn is_person(position: Point2, labelled: &LabelledSweep) -> Option<bool> {
    let near = labelled.people.iter().map(|(_, kind, place)| (place.distance(position), *kind));
    let (distance_m, kind) = near.min_by(|a, b| a.0.total_cmp(&b.0))?;
    // The middle of the returns lies before the middle of the body, and that of a trolley's pusher before both.
    let reach_m = match kind {
        PersonKind::Trolley | PersonKind::Luggage => 0.65,
        PersonKind::Wheelchair => 0.5,
        _ => 0.35,
    };
    if distance_m <= reach_m { Some(true) } else { (distance_m > NO_PERSON_M).then_some(false) }
}
