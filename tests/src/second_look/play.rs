//! Plays a hall before a large lidar; the perception of a hosted robot follows, with one look and with two, the same bytes.

use std::collections::VecDeque;

use floorguard_drivers::lidar::LidarDecoder as _;
use floorguard_drivers::velodyne::SweepBuilder;
use floorguard_laboratory::plan::Plan;
use floorguard_perception::people::{SweepContext, Track, TrackStatus};
use floorguard_robot::assembly::{HostedPerception, Stages, new_perception};
use floorguard_runtime::tasks::JudgeMotion as _;
use floorguard_sim::{Payload, Stream, Truth};
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::sensing::{LidarPacket, Sweep};
use floorguard_types::time::Stamp;

use super::halls::hall;
use crate::crowds::shares_in_sight;

/// Ends of the bands of distance, metres.
pub const BANDS_M: [f32; 3] = [6.0, 12.0, 20.0];
/// A person with less of the body in sight is hidden and not counted.
const SEEN_MIN: f32 = 0.34;
/// A track this near to a person is that person's, metres.
const SAME_M: f32 = 0.5;
/// A track farther than this from everybody is false, metres.
const FALSE_M: f32 = 1.0;
/// Sweeps before anything is counted: tracks begin.
const WARM_SWEEPS: u32 = 12;
/// The world moves on by this between two samples of the robot's pose, µs.
const STEP_US: u64 = 1_000;
const POSES: usize = 200;
const CUT_CDEG: u16 = 18_000;
/// Front wheel of a robot that drives: m/s, and an angle that makes a circle of about 3 m.
const TOWED: (f32, f32) = (0.6, 0.3);

/// What was counted in one band.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Band {
    /// People in sight.
    pub visible: u32,
    /// Of them those with a confirmed track.
    pub tracked: u32,
    /// Of them those with a track that is taken for a person.
    pub named: u32,
    /// Confirmed tracks, rather people than not, with nobody there.
    pub false_tracks: u32,
    /// Of them those that nothing explains.
    pub false_people: u32,
}

/// What was counted in all sweeps.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// By distance, see [`BANDS_M`].
    pub bands: [Band; 3],
    /// Whole revolutions.
    pub sweeps: u32,
    /// People with two tracks that are taken for a person; who walks close to another one counts, too.
    pub twice: u32,
}

impl Counts {
    /// Adds another run.
    pub fn add(&mut self, other: &Self) {
        for (band, more) in self.bands.iter_mut().zip(other.bands) {
            band.visible += more.visible;
            band.tracked += more.tracked;
            band.named += more.named;
            band.false_tracks += more.false_tracks;
            band.false_people += more.false_people;
        }
        self.sweeps += other.sweeps;
        self.twice += other.twice;
    }

    fn take(&mut self, tracks: &[Track], (truth, shares, viewpoint): (&Truth, &[f32], Point2)) {
        self.sweeps += 1;
        let band = |place: Point2| BANDS_M.iter().position(|end_m| place.distance(viewpoint) < *end_m);
        let confirmed = || tracks.iter().filter(|track| track.status == TrackStatus::Confirmed);
        for (person, share) in truth.people.iter().zip(shares) {
            let Some(band) = band(person.position).filter(|_| *share >= SEEN_MIN) else { continue };
            let is_near = |track: &&Track| track.state.position.distance(person.position) < SAME_M;
            let named = confirmed().filter(is_near).filter(|track| track.is_taken_for_person()).count();
            let counts = &mut self.bands[band];
            counts.visible += 1;
            counts.tracked += u32::from(confirmed().any(|track| is_near(&track)));
            counts.named += u32::from(named > 0);
            self.twice += u32::from(named > 1);
        }
        let is_false = |track: &&Track| {
            truth.people.iter().all(|person| person.position.distance(track.state.position) >= FALSE_M)
        };
        for track in confirmed().filter(|track| track.person_probability >= 0.5).filter(is_false) {
            let Some(band) = band(track.state.position) else { continue };
            self.bands[band].false_tracks += 1;
            self.bands[band].false_people += u32::from(track.is_taken_for_person());
        }
    }
}

/// What is counted with one look and with two, in the hall of a seed, before a lidar that the keys of `[lidar]` describe. In
/// every second hall the robot drives.
///
/// # Errors
/// The keys are refused.
pub fn play(keys: &str, seed: u64, seconds: u64) -> anyhow::Result<[Counts; 2]> {
    let plan = Plan::of("a hall", hall(seed)?, seed, seconds * 1_000_000)?.with_lidar(keys)?;
    let mut simulation = plan.simulation()?;
    if seed % 2 == 1 {
        simulation.tow(TOWED.0, TOWED.1);
    }
    let mut robots = [(); 2].map(|()| new_perception(&plan.robot, Stages::All));
    robots[0].motion.look_once();
    let mut counts = [Counts::default(), Counts::default()];
    let mut decoder = plan.robot.lidar_decoder();
    let mut builder = SweepBuilder::new(CUT_CDEG);
    let (mut packet, mut building) = (LidarPacket::EMPTY, Box::new(Sweep::EMPTY));
    let mut complete: Option<Box<Sweep>> = None;
    let mut poses: VecDeque<(u64, Pose2, Twist2)> = VecDeque::new();
    let mut sweeps = 0;
    for step in 1..=seconds * 1_000_000 / STEP_US {
        simulation.advance_to(step * STEP_US, &mut |event| {
            let (Stream::LidarData, Payload::Bytes(bytes)) = (event.stream, &event.payload) else { return };
            let arrival = Stamp::from_micros(event.at_us);
            let Ok(lost) = decoder.decode_datagram(bytes, arrival, &mut packet) else { return };
            decoder.arrange_for_people(&mut packet);
            robots.iter_mut().for_each(|robot| robot.motion.note_packet(&packet, lost, false));
            builder.add(&packet, lost, &mut building, |sweep| complete = Some(Box::new(sweep.clone())));
        });
        let (pose, twist) = simulation.robot();
        poses.push_back((step * STEP_US, pose, twist));
        if poses.len() > POSES {
            poses.pop_front();
        }
        let Some(sweep) = complete.take() else { continue };
        sweeps += 1;
        let truth = simulation.truth();
        let mount = simulation.parameters().lidar;
        let viewpoint = truth.robot.transform(Point2::new(mount.x_m, mount.y_m));
        let shares = shares_in_sight(&truth, viewpoint);
        for (robot, counts) in robots.iter_mut().zip(&mut counts) {
            let tracks = follow(robot, &sweep, &poses);
            if sweeps > WARM_SWEEPS {
                counts.take(&tracks, (&truth, &shares, viewpoint));
            }
        }
    }
    Ok(counts)
}

/// The tracks after a sweep.
fn follow(robot: &mut HostedPerception, sweep: &Sweep, poses: &VecDeque<(u64, Pose2, Twist2)>) -> Vec<Track> {
    let end_us = sweep.end_stamp.as_micros();
    let nearest = poses.iter().min_by_key(|(known_us, ..)| known_us.abs_diff(end_us));
    let (_, base_in_odom, twist) = nearest.copied().unwrap_or((0, Pose2::default(), Twist2::ZERO));
    let context = SweepContext { sensor_in_base: robot.sensor_in_base, twist, base_in_odom };
    robot.motion.people(&mut robot.people, sweep, &context).tracks.to_vec()
}
