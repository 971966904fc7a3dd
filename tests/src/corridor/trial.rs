//! Records a run once, and judges it with any method and parameters.

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, SweepBuilder};
use floorguard_perception::motion::{MotionDetector, MotionParameters};
use floorguard_perception::people::{PeoplePipeline, RingAngles, SweepContext};
use floorguard_types::geometry::{Point2, Point3, Pose2, Transform3};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

use super::{Moment, Published, Score, World};

/// Half a walker, metres.
const BODY_M: f32 = 0.3;
/// Noise of a pose (book, Motion: Published steps): metres and radians.
const POSITION_NOISE_M: f32 = 0.005;
const HEADING_NOISE_RAD: f32 = 0.1 * std::f32::consts::PI / 180.0;

/// Sweeps of a run with their odometry and the ground truth.
pub struct Run {
    /// The lidar on the robot.
    pub sensor_in_base: Transform3,
    /// Sweep, context, and the truth in its middle.
    pub sweeps: Vec<(Box<Sweep>, SweepContext, Moment)>,
}

/// Which detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The robot's own, judged within this distance of the lidar, metres.
    Own {
        /// Metres.
        reach_m: f32,
    },
    /// The published steps on what lies within this distance along x and y.
    Published {
        /// Metres.
        crop_m: f32,
        /// Smallest cluster.
        points_min: usize,
    },
}

impl Method {
    /// A walker here, in the frame of the lidar, is one to be found: wholly within what is judged.
    fn covers(self, walker: Point2) -> bool {
        match self {
            Self::Own { reach_m } => walker.norm() <= reach_m,
            Self::Published { crop_m, .. } => walker.x_m.abs().max(walker.y_m.abs()) <= crop_m - BODY_M,
        }
    }
}

/// Plays a seed for some sweeps.
///
/// # Panics
/// Where the simulated lidar emits what the decoder refuses: both are ours.
#[must_use]
pub fn record(seed: u64, sweeps: usize) -> Run {
    let mut world = World::new(seed);
    let mut random = Pcg32::new(seed, 78);
    let (x_m, z_m) = world.lidar_mount();
    let sensor_in_base = Transform3 { translation: Point3::new(x_m, 0.0, z_m), ..Transform3::IDENTITY };
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let mut builder = SweepBuilder::new(18_000);
    let mut building = Box::new(Sweep::EMPTY);
    let mut run = Run { sensor_in_base, sweeps: Vec::new() };
    let mut half_ago = std::collections::VecDeque::new();
    let mut partial = true;
    while run.sweeps.len() < sweeps {
        let (payload, moment) = world.next_packet();
        half_ago.push_back(moment);
        // 38 packets are half a revolution.
        let middle = if half_ago.len() > 38 { half_ago.pop_front() } else { None }.unwrap_or(moment);
        let arrival = Stamp::from_micros((moment.time_s * 1.0e6) as u64);
        let (packet, lost) = decoder.decode(&payload, arrival).expect("our own packets are right");
        builder.add(&packet, lost, &mut building, |sweep| {
            let mut noise = |deviation: f32| random.normal() * deviation;
            let base_in_odom = Pose2::new(
                moment.robot.x_m + noise(POSITION_NOISE_M),
                moment.robot.y_m + noise(POSITION_NOISE_M),
                moment.robot.heading_rad + noise(HEADING_NOISE_RAD),
            );
            let context = SweepContext { sensor_in_base, twist: moment.twist, base_in_odom };
            let truth = Moment { robot: moment.robot, ..middle };
            if !std::mem::take(&mut partial) {
                run.sweeps.push((Box::new(sweep.clone()), context, truth));
            }
        });
    }
    run
}

/// Judges a run.
#[must_use]
pub fn judge(run: &Run, method: Method, parameters: MotionParameters) -> Score {
    let mut score = Score::default();
    let mut truth = Vec::new();
    let mut people = Box::new(PeoplePipeline::new(RingAngles::vlp16()));
    let mut motion = Box::new(MotionDetector::new(parameters));
    let mut published = match method {
        Method::Published { crop_m, points_min } => Some(Published::new(parameters, crop_m, points_min)),
        Method::Own { .. } => None,
    };
    for (sweep, context, moment) in &run.sweeps {
        truth.push(*moment);
        let lidar = run.sensor_in_base.translation;
        let lidar_in_odom = moment.robot.compose(Pose2::new(lidar.x_m, lidar.y_m, 0.0));
        let walker = lidar_in_odom.inverse().transform(moment.walker);
        people.find_clusters(sweep, context);
        let moving: Vec<Point2> = match &mut published {
            Some(published) => published.process(&people, sweep, context),
            None => {
                let moving = motion.process(&people, sweep, context).moving.iter();
                moving.map(|object| Point2::new(object.centroid.x_m, object.centroid.y_m)).collect()
            }
        };
        score.enter(&moving, &truth, method.covers(walker));
    }
    score
}
