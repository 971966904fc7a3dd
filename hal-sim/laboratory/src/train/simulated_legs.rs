//! Legs in simulated scans of a safety scanner near the floor, with the truth beside them.
//!
//! The labelled recordings come from a finer scanner at another height. What stands on the floor looks different at
//! 0.15 m and 0.5°: two legs are often one segment, and tables and trolleys have legs, too.

use floorguard_drivers::s300::{Configuration, Event, Receiver};
use floorguard_perception::legs::{LEG_CUES, LegLimits, Segment, Segments, leg_cues, leg_features};
use floorguard_sim::robot::RobotParameters;
use floorguard_sim::simulation::Truth;
use floorguard_sim::{Payload, Simulation, Stream};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::Scan;
use floorguard_types::time::Stamp;

use super::boosting::Sample;
use super::simulated::SceneRun;

/// Scans taken of a scene, and one of so many: they are 40 ms apart.
const SCANS: usize = 12;
const EVERY: usize = 8;
/// A foot's disc has at most this radius; what is thicker is no leg, metres.
const FOOT_MAX_M: f32 = 0.15;
/// The middle of a segment lies this near to the edge of a foot: two feet may be one segment, metres.
const NEAR_FOOT_M: f32 = 0.13;
/// What else is this near to a person is neither: a bag, a wheel, half a leg, metres.
const DOUBTFUL_M: f32 = 0.7;
/// Microseconds of the world between two polls of the line.
const STEP_US: u64 = 5_000;

/// Segments of the scans of some scenes, as the detector would look at them.
#[must_use]
pub fn simulated_leg_samples(scenes: &[SceneRun]) -> Vec<Sample<LEG_CUES>> {
    let mut samples = Vec::new();
    let mut segments = Box::new(Segments::new());
    let limits = LegLimits::DEFAULT;
    for scene in scenes {
        play(scene, &mut |scan, scanner, truth| {
            segments.cut(scan, limits.gap_m);
            let whole = segments.iter().filter(|segment| segment.points.len() >= limits.points_min);
            samples.extend(whole.filter_map(|segment| sample(&segment, &limits, (scanner, truth))));
        });
    }
    samples
}

fn sample(
    segment: &Segment<'_>,
    limits: &LegLimits,
    (scanner, truth): (Pose2, &Truth),
) -> Option<Sample<LEG_CUES>> {
    let (first, last) = (segment.points.first()?, segment.points.last()?);
    let count = segment.points.len() as f32;
    let sum = segment.points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.x_m, y + point.y_m));
    let middle = Point2::new(sum.0 / count, sum.1 / count);
    if middle.norm() > limits.range_max_m || first.distance(*last) > limits.width_max_m {
        return None;
    }
    let features = leg_cues(&leg_features(segment)?, None);
    let place = scanner.transform(middle);
    let feet = truth.people.iter().flat_map(|person| &person.ground_discs);
    let mut feet = feet.filter(|(_, radius_m)| *radius_m < FOOT_MAX_M);
    let positive = feet.any(|(at, radius_m)| at.distance(place) < radius_m + NEAR_FOOT_M);
    let doubtful = truth.people.iter().any(|person| person.position.distance(place) < DOUBTFUL_M);
    (positive || !doubtful).then_some(Sample { features, positive })
}

/// Plays a scene; some of its scans go to `sink`, with the scanner's true place.
fn play(run: &SceneRun, sink: &mut dyn FnMut(&Scan, Pose2, &Truth)) {
    let parameters = RobotParameters::default();
    let mount = parameters.scanner;
    let Ok(mut simulation) = Simulation::with_robot(&run.scenario, run.seed, parameters) else { return };
    let mut receiver = Receiver::new(Configuration::default());
    simulation.advance_to(run.starts_us, &mut |_| {});
    let (mut seen, mut now_us) = (0, run.starts_us);
    while seen < SCANS * EVERY {
        now_us += STEP_US;
        let mut fresh: Option<Scan> = None;
        simulation.advance_to(now_us, &mut |event| {
            if let (Stream::ScannerSerial, Payload::Bytes(bytes)) = (event.stream, &event.payload) {
                receiver.push(bytes, Stamp::from_micros(event.at_us), |event| {
                    if let Event::Scan(scan) = event {
                        fresh = Some(scan.clone());
                    }
                });
            }
        });
        let Some(scan) = fresh else { continue };
        seen += 1;
        if seen % EVERY == 0 {
            let truth = simulation.truth();
            sink(&scan, truth.robot.compose(Pose2::new(mount.x_m, mount.y_m, 0.0)), &truth);
        }
    }
}
