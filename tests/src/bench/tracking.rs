//! How long following takes: one step with many targets, joint probabilities in a crowd, thirty people whole.

use std::hint::black_box;

use anyhow::Context as _;
use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, SweepBuilder};
use floorguard_perception::people::{
    Appearance, Association, ConstantVelocity, Detection, PeoplePipeline, RingAngles, Surroundings, Tracker,
    TrackerParameters,
};
use floorguard_sim::{Payload, Simulation, Stream};
use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

use super::peers::{context, unpacked};
use super::{Took, took};
use crate::crowds::CROWDS;
use crate::data::bench_input;

const STEP_US: u64 = 100_000;
const SIGMA_M: f32 = 0.1;
/// Simulated time of the crowd, µs.
const CROWD_US: u64 = 5_000_000;

fn detection(position: Point2) -> Detection {
    Detection {
        position,
        distance_m: position.norm(),
        sigma_m: SIGMA_M,
        likeness: 0.9,
        points: 50,
        moving: None,
        surroundings: Surroundings::OPEN,
        appearance: Appearance::UNKNOWN,
    }
}

/// Median of the second half, when everybody is followed.
fn second_half(times: &[Took]) -> Took {
    Took::median(times.get(times.len() / 2..).unwrap_or_default())
}

/// One step of the tracker on a file of the benchmark inputs; `None` if that is absent.
///
/// # Errors
/// The file is no such file.
pub fn tracker_step(targets: u32, association: Association) -> anyhow::Result<Option<Took>> {
    let Some(path) = bench_input(&format!("track/track_{targets:03}.csv.gz")) else { return Ok(None) };
    let mut steps: Vec<Vec<Detection>> = Vec::new();
    for line in String::from_utf8(unpacked(&path)?)?.lines().filter(|line| !line.starts_with('#')) {
        let cells: Vec<&str> = line.split(',').collect();
        let [step, kind, _, x, y] = cells.as_slice() else { continue };
        let step: usize = step.parse().context("a number of a step")?;
        steps.resize(steps.len().max(step + 1), Vec::new());
        if let (Some(detections), "1") = (steps.get_mut(step), *kind) {
            detections.push(detection(Point2::new(x.parse()?, y.parse()?)));
        }
    }
    let mut tracker = Box::new(Tracker::new(TrackerParameters { association, ..TrackerParameters::DEFAULT }));
    let step_time = |(step, detections): (usize, &Vec<Detection>)| {
        let stamp = Stamp::from_micros((step as u64 + 1) * STEP_US);
        took(|| tracker.update(stamp, black_box(detections), |_| true))
    };
    let times: Vec<Took> = steps.iter().enumerate().map(step_time).collect();
    Ok(Some(second_half(&times)))
}

/// Two hundred steps of targets that stand 0.8 m apart and stagger.
#[must_use]
pub fn crowd_steps(targets: u32) -> Vec<Vec<Point2>> {
    let mut random = Pcg32::new(16, 1);
    let mut place = |index: u32| {
        let mut near = |cell: u32| 0.8 * cell as f32 + 0.15 * random.normal();
        let (x_m, y_m) = (near(index % 4), near(index / 4));
        Point2::new(x_m, y_m)
    };
    (0..200).map(|_| (0..targets).map(&mut place).collect()).collect()
}

/// One step with joint probabilities; the targets stand 0.8 m apart and stagger, so that their gates overlap.
#[must_use]
pub fn joint_step(targets: u32) -> Took {
    let parameters = TrackerParameters { association: Association::Joint, ..TrackerParameters::DEFAULT };
    let mut tracker = Box::new(Tracker::new(parameters));
    let mut times = Vec::new();
    for (step, places) in crowd_steps(targets).into_iter().enumerate() {
        let detections: Vec<Detection> = places.into_iter().map(detection).collect();
        let stamp = Stamp::from_micros((step as u64 + 1) * STEP_US);
        times.push(took(|| tracker.update(stamp, black_box(&detections), |_| true)));
    }
    second_half(&times)
}

/// Prediction and correction of so many filters.
#[must_use]
pub fn filter_time(targets: usize) -> Took {
    let begin = ConstantVelocity::new(Point2::default(), Point2::default(), 0.2, 1.0);
    let mut filters = vec![begin; targets];
    let round = |_| {
        took(|| {
            for filter in &mut filters {
                filter.advance(0.1, 0.4);
                filter.correct(black_box(Point2::new(0.1, 0.2)), SIGMA_M);
            }
        })
    };
    Took::median(&(0..100).map(round).collect::<Vec<_>>())
}

/// Floor to tracks of one revolution among thirty people.
///
/// # Errors
/// None in practice: the crowd is built in.
pub fn crowd_pipeline() -> anyhow::Result<Took> {
    let crowd = CROWDS.iter().find(|crowd| crowd.people == 30).context("a crowd of 30")?;
    let mut simulation = Simulation::new(&crowd.scenario(30)?, 30)?;
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let (mut builder, mut building) = (SweepBuilder::new(18_000), Box::new(Sweep::EMPTY));
    let mut sweeps: Vec<Box<Sweep>> = Vec::new();
    simulation.advance_to(CROWD_US, &mut |event| {
        let (Stream::LidarData, Payload::Bytes(bytes)) = (event.stream, &event.payload) else { return };
        if let Ok((packet, lost)) = decoder.decode(bytes, Stamp::from_micros(event.at_us)) {
            builder.add(&packet, lost, &mut building, |sweep| sweeps.push(Box::new(sweep.clone())));
        }
    });
    let context = context(simulation.parameters().lidar.z_m);
    let mut pipeline = Box::new(PeoplePipeline::new(RingAngles::vlp16()));
    let mut sweep_time = |sweep: &Sweep| {
        took(|| {
            black_box(pipeline.process(black_box(sweep), &context));
        })
    };
    let times: Vec<Took> = sweeps.iter().map(|sweep| sweep_time(sweep)).collect();
    Ok(second_half(&times))
}
