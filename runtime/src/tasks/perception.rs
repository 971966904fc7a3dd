//! From packets and scans to one list of people, and to advice.

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_drivers::velodyne::SweepBuilder;
use floorguard_guard::with_floor;
use floorguard_localisation::odometry::{PoseHistory, PoseLookupError};
use floorguard_perception::legs::PeopleByLegs;
use floorguard_perception::motion::{MotionDetector, find_moving_people};
use floorguard_perception::people::{
    PeopleOutput, PeoplePipeline, PeopleView, SweepContext, Track, hangs, turn_over, turned_over_mounting,
};
use floorguard_types::geometry::{Point2, Pose2, Transform3, Twist2};
use floorguard_types::sensing::{LidarPacket, Scan, Sweep};
use floorguard_types::time::Stamp;

use super::advise::advice;
use crate::clock;
use crate::shared::{PeopleReport, PersonReport, QueuedPacket, Shared, SweepReport};

/// Revolutions are cut behind the robot.
const CUT_CDEG: u16 = 18_000;

/// Judges what moves by itself. A board without memory for it leaves the result unknown.
pub trait JudgeMotion {
    /// Takes in a sweep, with its verdicts on the clusters and tracks.
    fn people<'a>(
        &mut self,
        people: &'a mut PeoplePipeline,
        sweep: &Sweep,
        context: &SweepContext,
    ) -> PeopleOutput<'a>;

    /// A packet on its way into the sweep, and how many are missing before it: what looks at the rings that a sweep does not
    /// have takes them from here. `hangs` tells that the lidar hangs upside down.
    fn note_packet(&mut self, _packet: &LidarPacket, _lost_before: u16, _hangs: bool) {}

    /// Probability that a track is a person, by what the robot has learned itself; `None` where that is nothing. The list
    /// of people goes by it; the guard hears of it only where it adds a person.
    fn learned(&self, _track: &Track) -> Option<f32> {
        None
    }
}

/// Leaves open what moves.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMotion;

impl JudgeMotion for NoMotion {
    fn people<'a>(
        &mut self,
        people: &'a mut PeoplePipeline,
        sweep: &Sweep,
        context: &SweepContext,
    ) -> PeopleOutput<'a> {
        people.process(sweep, context)
    }
}

impl JudgeMotion for MotionDetector {
    fn people<'a>(
        &mut self,
        people: &'a mut PeoplePipeline,
        sweep: &Sweep,
        context: &SweepContext,
    ) -> PeopleOutput<'a> {
        find_moving_people(people, self, sweep, context)
    }
}

/// Finds people by the legs that a scanner sees.
pub trait FindPeopleByLegs {
    /// Takes in a scan, taken by a scanner at that pose of the odometry frame; positions come out in that frame.
    fn people(&mut self, scan: &Scan, sensor_in_odom: Pose2) -> &PeopleView;
}

impl FindPeopleByLegs for PeopleByLegs {
    fn people(&mut self, scan: &Scan, sensor_in_odom: Pose2) -> &PeopleView {
        self.process(scan, sensor_in_odom, None::<fn(Point2) -> bool>)
    }
}

/// All memory of the stage, about 380 KiB and what judging motion takes: the board places it once.
pub struct PerceptionState<D = NoMotion, L = PeopleByLegs> {
    /// Sweep under construction.
    pub building: Sweep,
    /// The people stages.
    pub people: PeoplePipeline,
    /// What moves.
    pub motion: D,
    /// Legs in the safety scanner's scans.
    pub legs: L,
    /// The scan that is searched for them.
    pub scan: Scan,
    /// Where the robot was.
    pub history: PoseHistory,
    /// Lidar on the robot.
    pub sensor_in_base: Transform3,
    /// Safety scanner on the robot.
    pub scanner_in_base: Pose2,
}

impl<D: JudgeMotion, L: FindPeopleByLegs> PerceptionState<D, L> {
    /// The scan that was read: its legs go into the same list of people. True if that changed it at once, because the
    /// lidar is silent; an error if nobody knows where the robot was.
    fn search_legs(&mut self) -> Result<bool, PoseLookupError> {
        let sensor_in_odom = self.history.at(self.scan.stamp)?.compose(self.scanner_in_base);
        Ok(follow_legs(&mut self.people, &mut self.legs, (&self.scan, sensor_in_odom)))
    }

    /// Whether the lidar hangs upside down: its sweeps are then to be turned over, and mounting and rings are those of a
    /// lidar that was. Call once.
    fn turn_over_lidar(&mut self) -> bool {
        let hangs = hangs(&self.sensor_in_base);
        if hangs {
            self.sensor_in_base = turned_over_mounting(&self.sensor_in_base);
            self.people.angles = self.people.angles.turned_over();
        }
        hangs
    }

    /// What the legs of the newest scan changed.
    fn legs_report(&self, unposed: [u32; 2]) -> PeopleReport {
        let sweep = SweepReport { stamp: self.scan.stamp, ..SweepReport::default() };
        of_tracks(self.people.tracks(), sweep, unposed, |track| self.motion.learned(track))
    }
}

/// Takes the legs of a scan into the list of people; the scanner stood at that place of the odometry frame. True if that
/// changed the list at once, because the lidar is silent. One scan costs its beams, and tracks × legs.
pub fn follow_legs(
    people: &mut PeoplePipeline,
    legs: &mut impl FindPeopleByLegs,
    (scan, sensor_in_odom): (&Scan, Pose2),
) -> bool {
    people.add_view(legs.people(scan, sensor_in_odom))
}

/// Perception ring. Runs for ever. Packets come before scans, so that two runs with the same bytes take the same way.
pub async fn perceive<M: RawMutex, D: JudgeMotion, L: FindPeopleByLegs>(
    shared: &Shared<M>,
    state: &mut PerceptionState<D, L>,
) {
    let mut builder = SweepBuilder::new(CUT_CDEG);
    let hangs = state.turn_over_lidar();
    let mut twist = Twist2::ZERO;
    // Of sweeps and of scans.
    let mut unposed = [0_u32; 2];
    let mut queued = QueuedPacket::EMPTY;
    loop {
        let packet = shared.packets.pop(|slot| queued.copy_from(slot));
        let scan = shared.scans.pop(|slot| state.scan.copy_from(slot));
        let next = select(packet, scan).await;
        for _ in 0..crate::shared::POSES_QUEUED {
            let Some(known) = shared.poses.try_pop() else { break };
            state.history.record(known.stamp, known.pose_in_odometry);
            twist = known.twist;
        }
        if let Either::Second(()) = next {
            match state.search_legs() {
                // No advice from legs alone: where the lidar is blind, silence must stay silence.
                Ok(true) => {
                    shared.people.publish(state.legs_report(unposed));
                }
                Ok(false) => {}
                Err(_) => unposed[1] = unposed[1].saturating_add(1),
            }
            continue;
        }
        let PerceptionState { building, people, motion, history, sensor_in_base, .. } = &mut *state;
        motion.note_packet(&queued.packet, queued.lost_before, hangs);
        builder.add(&queued.packet, queued.lost_before, building, |sweep| {
            let Ok(base_in_odom) = history.at(sweep.end_stamp) else {
                unposed[0] = unposed[0].saturating_add(1);
                return;
            };
            if hangs {
                turn_over(sweep);
            }
            let context = SweepContext { sensor_in_base: *sensor_in_base, twist, base_in_odom };
            let output = motion.people(people, sweep, &context);
            let learned = |track: &Track| motion.learned(track);
            let people = advice(sweep.end_stamp, output.tracks, base_in_odom, learned);
            shared.advice.publish(with_floor(people, shared.floor.get().as_ref(), clock::now()));
            shared.people.publish(report((sweep, &output), unposed, learned));
        });
    }
}

fn report(
    (sweep, output): (&Sweep, &PeopleOutput<'_>),
    unposed: [u32; 2],
    learned: impl Fn(&Track) -> Option<f32>,
) -> PeopleReport {
    let stamp = sweep.end_stamp;
    let sweep = SweepReport { stamp, counters: output.counters, lost_packets: sweep.lost_packets };
    of_tracks(output.tracks, sweep, unposed, learned)
}

fn of_tracks(
    tracks: &[Track],
    sweep: SweepReport,
    unposed: [u32; 2],
    learned: impl Fn(&Track) -> Option<f32>,
) -> PeopleReport {
    let [unposed_sweeps, unposed_scans] = unposed;
    // The tracker has the same capacity.
    let people = tracks.iter().map(|track| person(track, sweep.stamp, learned(track))).collect();
    PeopleReport { sweep, people, unposed_sweeps, unposed_scans }
}

fn person(track: &Track, now: Stamp, learned: Option<f32>) -> PersonReport {
    PersonReport {
        id: track.id,
        status: track.status,
        position: track.state.position,
        velocity_mps: track.state.velocity,
        position_sigma_m: libm::sqrtf(track.state.position_variance.max(0.0)),
        velocity_sigma_mps: libm::sqrtf(track.state.velocity_variance.max(0.0)),
        person_probability: learned.unwrap_or(track.person_probability),
        moving_probability: track.moving_probability,
        sensors: track.sensors(now),
        explanation: track.explanation,
    }
}
