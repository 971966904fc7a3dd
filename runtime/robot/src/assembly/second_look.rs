//! People looked for once more, in the rings of a large lidar that a sweep does not have.

use floorguard_drivers::velodyne::SweepBuilder;
use floorguard_perception::people::{ClusterLimits, Detection, PeoplePipeline, SweepContext, turn_over};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::sensing::{LidarPacket, Sweep};

/// Revolutions are cut behind the robot, as those of the first look.
const CUT_CDEG: u16 = 18_000;

/// The second front end: its own sweeps, clusters and detections, and no tracks.
pub struct SecondLook {
    people: PeoplePipeline,
    builder: SweepBuilder,
    packet: LidarPacket,
    building: Sweep,
    /// The newest whole revolution.
    whole: Sweep,
    /// It has been turned over, and the rings with it.
    hangs: bool,
}

impl SecondLook {
    /// For the robot's lidar, if that has other rings than those of a sweep.
    // Not inlined: its frame is gone before the first pipeline is made.
    #[inline(never)]
    #[must_use]
    pub fn of_robot(robot: &RobotConfiguration) -> Option<Box<Self>> {
        let mut people = PeoplePipeline::new(robot.second_ring_angles()?);
        people.cluster_limits = ClusterLimits::DEFAULT;
        Some(Box::new(Self {
            people,
            builder: SweepBuilder::new(CUT_CDEG),
            packet: LidarPacket::EMPTY,
            building: Sweep::EMPTY,
            whole: Sweep::EMPTY,
            hangs: false,
        }))
    }

    /// A packet on its way into the sweep: its upper sixteen rings go into a sweep of their own.
    pub fn note_packet(&mut self, packet: &LidarPacket, lost_before: u16, hangs: bool) {
        if usize::from(packet.rings) <= SWEEP_RINGS {
            return;
        }
        if hangs && !self.hangs {
            self.people.angles = self.people.angles.turned_over();
        }
        self.hangs |= hangs;
        self.packet.copy_from(packet);
        for column in &mut self.packet.columns {
            column.range_raw.as_mut().copy_within(SWEEP_RINGS.., 0);
            column.reflectivity.as_mut().copy_within(SWEEP_RINGS.., 0);
        }
        let Self { builder, packet, building, whole, .. } = self;
        builder.add(packet, lost_before, building, |sweep| whole.clone_from(sweep));
    }

    /// What it sees in the revolution of a sweep of the first look; nothing where it has not seen that one whole.
    pub fn detections(&mut self, sweep: &Sweep, context: &SweepContext) -> &[Detection] {
        let Self { people, whole, .. } = self;
        if whole.column_count == 0 || whole.end_stamp != sweep.end_stamp {
            return &[];
        }
        if self.hangs {
            turn_over(whole);
        }
        people.find_clusters(whole, context);
        people.find_detections(whole, context);
        // Once: a sweep that is handed out again, as an error, would be turned over twice.
        whole.column_count = 0;
        people.detections()
    }
}
