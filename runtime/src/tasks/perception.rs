//! From packets to people and advice.

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_core::geometry::{Transform3, Twist2};
use floorguard_core::odometry::PoseHistory;
use floorguard_core::people::{PeopleOutput, PeoplePipeline, SweepContext, Track};
use floorguard_core::sensing::Sweep;
use floorguard_drivers::velodyne::SweepBuilder;

use super::advise::advice;
use crate::shared::{PeopleReport, PersonReport, QueuedPacket, Shared, SweepReport};

/// Revolutions are cut behind the robot.
const CUT_CDEG: u16 = 18_000;

/// All memory of the stage, about 350 KiB: the board places it once.
pub struct PerceptionState {
    /// Sweep under construction.
    pub building: Sweep,
    /// The people stages.
    pub people: PeoplePipeline,
    /// Where the robot was.
    pub history: PoseHistory,
    /// Lidar on the robot.
    pub sensor_in_base: Transform3,
}

/// Perception ring. Runs for ever.
pub async fn perceive<M: RawMutex>(shared: &Shared<M>, state: &mut PerceptionState) {
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
        let PerceptionState { building, people, history, sensor_in_base } = &mut *state;
        builder.add(&queued.packet, queued.lost_before, building, |sweep| {
            let Ok(base_in_odom) = history.at(sweep.end_stamp) else {
                unposed_sweeps = unposed_sweeps.saturating_add(1);
                return;
            };
            let context = SweepContext { sensor_in_base: *sensor_in_base, twist, base_in_odom };
            let output = people.process(sweep, &context);
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
