//! Plays a crowd once and lets several trackers follow it on the same sweeps.

use std::collections::{BTreeMap, VecDeque};

use floorguard_drivers::s300::{Configuration, Event, Receiver};
use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, SweepBuilder};
use floorguard_laboratory::metrics::{MotAccumulator, MotSummary};
use floorguard_perception::legs::PeopleByLegs;
use floorguard_perception::people::{
    PeoplePipeline, RingAngles, SweepContext, Track, TrackStatus, TrackerParameters,
};
use floorguard_runtime::tasks::PERSON_PROBABILITY_MIN;
use floorguard_sim::{Payload, Simulation, Stream, Truth};
use floorguard_types::geometry::{Point2, Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::{Scan, Sweep};
use floorguard_types::time::Stamp;

use super::causes::{Causes, ObservedPerson};
use super::scenes::CrowdScene;
use super::sight::shares_in_sight;

/// Who is farther away is not asked for, metres.
const RANGE_M: f32 = 12.0;
/// A person less of whom is in sight is hidden: neither missed, nor wrong to know of.
const SEEN_MIN: f32 = 0.34;
/// A track farther than this from a person is somebody else, metres (book, Tracking: Metrics).
const GATE_M: f64 = 0.5;
/// A track this near to a hidden person is not wrong, metres.
const HIDDEN_M: f32 = 1.0;
/// The world moves on by this between two samples of the robot's pose, µs.
const STEP_US: u64 = 1_000;
/// Poses kept: 0.2 s, because a sweep is handed out when its last packet has come.
const POSES: usize = 200;
/// Front wheel of a robot that drives: m/s, and an angle that makes a circle of about 3 m.
const TOWED: (f32, f32) = (0.6, 0.3);

/// How one tracker did.
#[derive(Clone, Debug, Default)]
pub struct Following {
    /// CLEAR MOT and IDF1.
    pub summary: MotSummary,
    /// Minutes that people were in sight, all added.
    pub person_minutes: f64,
    /// From the first sweep that could show a person to the first that names the person, seconds, each person once.
    pub acquired_s: Vec<f64>,
    /// Groups that were too large for joint probabilities.
    pub large_groups: u32,
    /// Why identities changed.
    pub causes: Causes,
}

struct Follower {
    pipeline: Box<PeoplePipeline>,
    uses_legs: bool,
    mot: MotAccumulator,
    first_seen_us: BTreeMap<u64, Option<u64>>,
    result: Following,
}

/// Plays `seconds` of a crowd; one result a tracker, of which each sees the legs of the scanner, too, or does not.
///
/// # Errors
/// None in practice: the scenes are built in.
pub fn follow(
    scene: &CrowdScene,
    (seed, seconds): (u64, u64),
    trackers: &[(TrackerParameters, bool)],
) -> anyhow::Result<Vec<Following>> {
    let mut simulation = Simulation::new(&scene.scenario(seed)?, seed)?;
    if scene.drives {
        simulation.tow(TOWED.0, TOWED.1);
    }
    let mut followers = Followers::new(trackers);
    play_all(&mut simulation, seconds, &mut |seen, truth| followers.observe(&seen, truth));
    Ok(followers.finish())
}

/// Several trackers that see the same.
pub struct Followers {
    followers: Vec<Follower>,
    legs: Box<PeopleByLegs>,
}

impl Followers {
    /// Nobody seen yet; each of the trackers takes the legs of the scanner, too, or does not.
    #[must_use]
    pub fn new(trackers: &[(TrackerParameters, bool)]) -> Self {
        Self { followers: trackers.iter().map(Follower::new).collect(), legs: Box::new(PeopleByLegs::new()) }
    }

    /// Lets all of them look, and compares what they say with the truth.
    pub fn observe(&mut self, seen: &Seen<'_>, truth: &Truth) {
        match seen {
            Seen::Sweep(sweep, context) => {
                let mount = context.sensor_in_base.translation;
                let viewpoint = truth.robot.transform(Point2::new(mount.x_m, mount.y_m));
                let shares = shares_in_sight(truth, viewpoint);
                for follower in &mut self.followers {
                    follower.take(sweep, context, (truth, &shares, viewpoint));
                }
            }
            Seen::Scan(scan, scanner_in_odom) => {
                let view = self.legs.process(scan, *scanner_in_odom, None::<fn(Point2) -> bool>);
                for follower in self.followers.iter_mut().filter(|follower| follower.uses_legs) {
                    follower.pipeline.add_view(view);
                }
            }
        }
    }

    /// What became of each.
    #[must_use]
    pub fn finish(self) -> Vec<Following> {
        self.followers.into_iter().map(Follower::finish).collect()
    }
}

/// What becomes of a sweep, where it was taken, and the truth at its end.
pub type Sink<'a> = &'a mut dyn FnMut(&Sweep, &SweepContext, &Truth);

/// The input of a robot.
pub enum Seen<'a> {
    /// A whole sweep, and where it was taken.
    Sweep(&'a Sweep, &'a SweepContext),
    /// A scan, and where the scanner was in the fixed frame.
    Scan(&'a Scan, Pose2),
}

/// Plays a world; every whole sweep goes to `sink`.
pub fn play(simulation: &mut Simulation, seconds: u64, sink: Sink<'_>) {
    play_all(simulation, seconds, &mut |seen, truth| {
        if let Seen::Sweep(sweep, context) = seen {
            sink(sweep, context, truth);
        }
    });
}

/// Plays a world; every scan and every whole sweep goes to `sink`, in the order in which a robot gets them.
pub fn play_all(simulation: &mut Simulation, seconds: u64, sink: &mut dyn FnMut(Seen<'_>, &Truth)) {
    let mut receiver = Receiver::new(Configuration::default());
    let mut scans: Vec<Scan> = Vec::new();
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let mut builder = SweepBuilder::new(18_000);
    let (mut building, mut complete) = (Box::new(Sweep::EMPTY), Box::new(Sweep::EMPTY));
    let mut poses: VecDeque<(u64, Pose2, Twist2)> = VecDeque::new();
    let mut sweeps = 0_u32;
    for step in 1..=seconds * 1_000_000 / STEP_US {
        let now_us = step * STEP_US;
        let mut fresh = false;
        simulation.advance_to(now_us, &mut |event| {
            let Payload::Bytes(bytes) = &event.payload else { return };
            let arrival = Stamp::from_micros(event.at_us);
            if event.stream == Stream::ScannerSerial {
                receiver.push(bytes, arrival, |event| {
                    if let Event::Scan(scan) = event {
                        scans.push(scan.clone());
                    }
                });
            }
            if event.stream != Stream::LidarData {
                return;
            }
            if let Ok((packet, lost)) = decoder.decode(bytes, arrival) {
                builder.add(&packet, lost, &mut building, |sweep| {
                    (*complete).clone_from(sweep);
                    fresh = true;
                });
            }
        });
        let (pose, twist) = simulation.robot();
        poses.push_back((now_us, pose, twist));
        if poses.len() > POSES {
            poses.pop_front();
        }
        for scan in scans.drain(..) {
            let (_, pose, _) = at(&poses, scan.stamp.as_micros());
            let mount = simulation.parameters().scanner;
            let scanner_in_odom = pose.compose(Pose2::new(mount.x_m, mount.y_m, 0.0));
            sink(Seen::Scan(&scan, scanner_in_odom), &simulation.truth());
        }
        sweeps += u32::from(fresh);
        // The first sweep began in the middle of a revolution.
        if fresh && sweeps > 1 {
            let (_, pose, twist) = at(&poses, complete.end_stamp.as_micros());
            let mount = simulation.parameters().lidar;
            let translation = Point3::new(mount.x_m, mount.y_m, mount.z_m);
            let sensor_in_base = Transform3 { translation, ..Transform3::IDENTITY };
            let context = SweepContext { sensor_in_base, twist, base_in_odom: pose };
            sink(Seen::Sweep(&complete, &context), &simulation.truth());
        }
    }
}

/// The pose nearest to a moment.
fn at(poses: &VecDeque<(u64, Pose2, Twist2)>, at_us: u64) -> (u64, Pose2, Twist2) {
    let nearest = poses.iter().min_by_key(|(known_us, ..)| known_us.abs_diff(at_us));
    nearest.copied().unwrap_or((at_us, Pose2::default(), Twist2::ZERO))
}

impl Follower {
    fn new((parameters, uses_legs): &(TrackerParameters, bool)) -> Self {
        Self {
            uses_legs: *uses_legs,
            pipeline: Box::new(PeoplePipeline::with_tracker(RingAngles::vlp16(), *parameters)),
            mot: MotAccumulator::new(),
            first_seen_us: BTreeMap::new(),
            result: Following::default(),
        }
    }

    fn take(
        &mut self,
        sweep: &Sweep,
        context: &SweepContext,
        (truth, shares, viewpoint): (&Truth, &[f32], Point2),
    ) {
        let output = self.pipeline.process(sweep, context);
        let counts = |track: &&Track| {
            track.status == TrackStatus::Confirmed && track.person_probability >= PERSON_PROBABILITY_MIN
        };
        let mut tracks: Vec<(u64, Point2)> = output
            .tracks
            .iter()
            .filter(counts)
            .map(|track| (u64::from(track.id), track.state.position))
            .collect();
        let people = truth.people.iter().zip(shares);
        let is_seen = |share: f32, place: Point2| share >= SEEN_MIN && place.distance(viewpoint) < RANGE_M;
        let seen: Vec<(u64, Point2)> = people
            .clone()
            .filter(|(person, share)| is_seen(**share, person.position))
            .map(|(person, _)| (u64::from(person.id), person.position))
            .collect();
        let near_hidden = |place: Point2| {
            people.clone().any(|(person, share)| {
                !is_seen(*share, person.position) && person.position.distance(place) < HIDDEN_M
            })
        };
        let near_seen =
            |place: Point2| seen.iter().any(|(_, person)| f64::from(person.distance(place)) <= GATE_M);
        tracks.retain(|(_, place)| {
            near_seen(*place) || place.distance(viewpoint) < RANGE_M && !near_hidden(*place)
        });
        let ids = |list: &[(u64, Point2)]| -> Vec<u64> { list.iter().map(|(id, _)| *id).collect() };
        self.mot.frame_by_distance(&ids(&seen), &ids(&tracks), |object, track| {
            let distance_m = f64::from(seen[object].1.distance(tracks[track].1));
            (distance_m <= GATE_M).then_some(distance_m)
        });
        let all: Vec<(u64, Point2)> =
            output.tracks.iter().map(|track| (u64::from(track.id), track.state.position)).collect();
        let everybody: Vec<ObservedPerson> = people
            .clone()
            .map(|(person, share)| (u64::from(person.id), person.position, is_seen(*share, person.position)))
            .collect();
        self.result.causes.frame(&everybody, &all, self.mot.partners());
        self.note_acquired(&seen, &tracks, truth.stamp.as_micros());
        self.result.person_minutes += seen.len() as f64 * 0.1 / 60.0;
    }

    /// `Some` while somebody in sight waits to be named, `None` afterwards. Who is hidden again first waits anew.
    fn note_acquired(&mut self, seen: &[(u64, Point2)], tracks: &[(u64, Point2)], now_us: u64) {
        self.first_seen_us.retain(|id, since| since.is_none() || seen.iter().any(|(other, _)| other == id));
        for (id, place) in seen {
            let since = self.first_seen_us.entry(*id).or_insert(Some(now_us));
            let named = tracks.iter().any(|(_, track)| f64::from(track.distance(*place)) <= GATE_M);
            if let (Some(since_us), true) = (*since, named) {
                self.result.acquired_s.push((now_us - since_us) as f64 * 1.0e-6);
                *since = None;
            }
        }
    }

    fn finish(mut self) -> Following {
        self.result.summary = self.mot.summary();
        self.result.large_groups = self.pipeline.tracker().large_groups();
        self.result
    }
}
