//! From packets to people and advice.

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_core::geometry::{Transform3, Twist2};
use floorguard_core::motion::{MotionDetector, find_moving_people};
use floorguard_core::odometry::PoseHistory;
use floorguard_core::people::{PeopleOutput, PeoplePipeline, SweepContext, Track};
use floorguard_core::sensing::Sweep;
use floorguard_drivers::velodyne::SweepBuilder;

use super::advise::advice;
use crate::shared::{PeopleReport, PersonReport, QueuedPacket, Shared, SweepReport};

/// Revolutions are cut behind the robot.
const CUT_CDEG: u16 = 18_000;

/// Judges what moves by itself. A board without room for it leaves the question open.
pub trait JudgeMotion {
    /// Takes in a sweep, with its verdicts on the clusters and tracks.
    fn people<'a>(
        &mut self,
        people: &'a mut PeoplePipeline,
        sweep: &Sweep,
        context: &SweepContext,
    ) -> PeopleOutput<'a>;
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

/// All memory of the stage, about 350 KiB and what judging motion takes: the board places it once.
pub struct PerceptionState<D = NoMotion> {
    /// Sweep under construction.
    pub building: Sweep,
    /// The people stages.
    pub people: PeoplePipeline,
    /// What moves.
    pub motion: D,
    /// Where the robot was.
    pub history: PoseHistory,
    /// Lidar on the robot.
    pub sensor_in_base: Transform3,
}

/// Perception ring. Runs for ever.
pub async fn perceive<M: RawMutex, D: JudgeMotion>(shared: &Shared<M>, state: &mut PerceptionState<D>) {
    let mut builder = SweepBuilder::new(CUT_CDEG);
    let mut twist = Twist2::ZERO;
    let mut unposed_sweeps = 0_u32;
    let mut queued = QueuedPacket::EMPTY;
    loop {
        shared.packets.pop(|slot| queued.copy_from(slot)).await;
        for _ in 0..crate::shared::POSES_QUEUED {
            let Some(known) = shared.poses.try_pop() else { break };
            state.history.record(known.stamp, known.pose_in_odometry);
            twist = known.twist;
        }
        let PerceptionState { building, people, motion, history, sensor_in_base } = &mut *state;
        builder.add(&queued.packet, queued.lost_before, building, |sweep| {
            let Ok(base_in_odom) = history.at(sweep.end_stamp) else {
                unposed_sweeps = unposed_sweeps.saturating_add(1);
                return;
            };
            let context = SweepContext { sensor_in_base: *sensor_in_base, twist, base_in_odom };
            let output = motion.people(people, sweep, &context);
            shared.advice.publish(advice(sweep.end_stamp, output.tracks, base_in_odom));
            shared.people.publish(report(sweep, &output, unposed_sweeps));
        });
    }
}

fn report(sweep: &Sweep, output: &PeopleOutput<'_>, unposed_sweeps: u32) -> PeopleReport {
    let sweep =
        SweepReport { stamp: sweep.end_stamp, counters: output.counters, lost_packets: sweep.lost_packets };
    // The tracker has the same capacity.
    let people = output.tracks.iter().map(person).collect();
    PeopleReport { sweep, people, unposed_sweeps }
}

fn person(track: &Track) -> PersonReport {
    PersonReport {
        id: track.id,
        status: track.status,
        position: track.state.position,
        velocity_mps: track.state.velocity,
        position_sigma_m: libm::sqrtf(track.state.position_variance.max(0.0)),
        velocity_sigma_mps: libm::sqrtf(track.state.velocity_variance.max(0.0)),
        person_probability: track.person_probability,
        moving_probability: track.moving_probability,
    }
}
