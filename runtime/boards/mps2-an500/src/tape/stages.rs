//! What each stage costs: the tape's bytes given to one stage after the other, without tasks around them.

use floorguard_drivers::s300::{Configuration, Event, Receiver};
use floorguard_drivers::velodyne::{Decoder, ModelChoice, SweepBuilder};
use floorguard_guard::Supervisor;
use floorguard_perception::people::{FloorMask, SweepContext};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::tape::{TapeLine, TapeReader};
use floorguard_runtime::tasks::PerceptionState;
use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::sensing::{LidarPacket, Sweep};
use floorguard_types::time::Stamp;

use super::stopwatch::Stopwatch;

/// Bytes of a serial line arrive in portions like these.
const PORTION_BYTES: usize = 128;

/// Costs by stage.
#[derive(Default)]
pub struct Stages {
    /// A datagram to a packet.
    pub decode: Stopwatch,
    /// A packet to the guard's decision.
    pub guard_packet: Stopwatch,
    /// A packet into the guard's memory of the surroundings.
    pub memory_packet: Stopwatch,
    /// A packet into the sweep.
    pub build: Stopwatch,
    /// The floor of a sweep, by itself.
    pub floor: Stopwatch,
    /// Floor and clusters of a sweep, in one pass.
    pub clusters: Stopwatch,
    /// Candidates, shapes, classifier and upper bodies of a sweep.
    pub features: Stopwatch,
    /// The tracker.
    pub track: Stopwatch,
    /// The last portion of a telegram to the guard's decision.
    pub guard_scan: Stopwatch,
    /// A scan into the guard's memory of the surroundings.
    pub memory_scan: Stopwatch,
}

/// Plays the tape through the stages. Leaves what it finds in `state`.
pub fn measure(tape: TapeReader<'static>, robot: &RobotConfiguration, state: &mut PerceptionState) -> Stages {
    let mut stages = Stages::default();
    let Ok(mut guard) = Supervisor::new(robot.guard(), Stamp::ZERO) else { return stages };
    let mut decoder = Decoder::new(robot.lidar_model().map_or(ModelChoice::Auto, ModelChoice::Fixed));
    let mut receiver = Receiver::new(Configuration::default());
    let mut builder = SweepBuilder::new(18_000);
    let mut packet = LidarPacket::EMPTY;
    let mut sweeps = 0_u32;
    for record in tape {
        let now = Stamp::from_micros(record.deliver_us);
        match record.line {
            TapeLine::Lidar => {
                stages.decode.begin();
                let lost =
                    decoder.decode_into(record.data, Stamp::from_micros(record.arrival_us), &mut packet);
                stages.decode.end();
                let Ok(lost) = lost else { continue };
                stages.guard_packet.begin();
                guard.on_lidar_packet(&packet, now);
                stages.guard_packet.end();
                stages.memory_packet.begin();
                guard.remember_packet(&packet);
                stages.memory_packet.end();
                let mut build = stages.build;
                build.begin();
                let seen = sweeps;
                builder.add(&packet, lost, &mut state.building, |sweep| {
                    sweeps += 1;
                    measure_perception(&mut stages, (&mut state.people, robot), sweep);
                });
                // The sweep's own stages do not count as building it.
                if sweeps == seen {
                    build.end();
                    stages.build = build;
                }
            }
            TapeLine::Scanner => {
                for portion in record.data.chunks(PORTION_BYTES) {
                    let mut watch = stages.guard_scan;
                    watch.begin();
                    receiver.push(portion, now, |event| {
                        if let Event::Scan(scan) = event {
                            guard.on_scan(scan, now);
                            watch.end();
                            stages.guard_scan = watch;
                            stages.memory_scan.begin();
                            guard.remember_scan(scan);
                            stages.memory_scan.end();
                        }
                    });
                }
            }
            _ => {}
        }
    }
    stages
}

fn measure_perception(
    stages: &mut Stages,
    (people, robot): (&mut floorguard_perception::people::PeoplePipeline, &RobotConfiguration),
    sweep: &Sweep,
) {
    let context = SweepContext {
        sensor_in_base: robot.lidar.mounting.transform(),
        twist: Twist2 { linear_mps: 0.5, angular_radps: 0.1 },
        base_in_odom: Pose2::default(),
    };
    let mut mask = FloorMask::new();
    stages.floor.begin();
    mask.find(sweep, &people.angles, &context.sensor_in_base);
    stages.floor.end();
    core::hint::black_box(&mask);
    stages.clusters.begin();
    people.find_clusters(sweep, &context);
    stages.clusters.end();
    stages.features.begin();
    people.find_detections(sweep, &context);
    stages.features.end();
    stages.track.begin();
    people.track(sweep, &context);
    stages.track.end();
}
