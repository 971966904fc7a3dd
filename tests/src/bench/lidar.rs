//! The lidar path, stage by stage: datagrams to tracks of people.

use std::hint::black_box;

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, SweepBuilder};
use floorguard_perception::motion::{MotionDetector, MotionParameters};
use floorguard_perception::people::{
    Detection, FloorHeight, FloorMask, PeoplePipeline, RingAngles, SweepContext, Tracker, TrackerParameters,
};
use floorguard_recording::capture::Datagram;
use floorguard_types::geometry::{Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::{LidarPacket, Sweep};
use floorguard_types::time::Stamp;

use super::{DecisionTime, decisions, median, nanoseconds};
use crate::data::{bench_input, recording};
use crate::lidar_frames::{datagrams, packets, revolutions};

/// What one stage took on one input.
#[derive(Clone, Debug, PartialEq)]
pub struct StageTime {
    /// Input.
    pub input: &'static str,
    /// Stage.
    pub stage: &'static str,
    /// Median nanoseconds per sweep.
    pub ns_per_sweep: f64,
    /// The same per return.
    pub ns_per_point: f64,
}

/// Every recording is gone through this often; the median of all rounds counts.
const ROUNDS: usize = 20;

/// All stages on one input.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Input.
    pub input: &'static str,
    /// In the order of the data.
    pub stages: Vec<StageTime>,
    /// The guard, packet by packet.
    pub decisions: DecisionTime,
}

/// Measures all stages on `einride_office_600rpm` and `synthetic_vlp16`. An absent input is left out, with a line.
#[must_use]
pub fn run() -> Vec<Measured> {
    let inputs = [
        ("einride_office_600rpm", recording("vlp16_packets/einride_office_600rpm.pcap.gz"), None),
        ("synthetic_vlp16", bench_input("lidar/synthetic_vlp16.pcap.gz"), Some(0.9)),
    ];
    let present = inputs.into_iter().filter_map(|(name, path, height_m)| Some((name, path?, height_m)));
    present.filter_map(|(name, path, height_m)| measure(name, &datagrams(&path), height_m)).collect()
}

fn measure(input: &'static str, datagrams: &[Datagram], height_m: Option<f32>) -> Option<Measured> {
    let packets = packets(datagrams);
    let sweeps = revolutions(&packets);
    let first = sweeps.first()?;
    let angles = RingAngles::vlp16();
    let height_m = height_m.or_else(|| FloorHeight::estimate_m(first, &angles)).unwrap_or(0.8);
    let context = SweepContext {
        sensor_in_base: Transform3 { translation: Point3::new(0.0, 0.0, height_m), ..Transform3::IDENTITY },
        twist: Twist2::ZERO,
        base_in_odom: Pose2::default(),
    };
    let per_sweep = datagrams.len() as f64 / sweeps.len() as f64;
    let returns = sweeps.iter().map(|sweep| returns(sweep)).sum::<usize>() as f64 / sweeps.len() as f64;
    let row = |stage, ns_per_sweep: f64| StageTime {
        input,
        stage,
        ns_per_sweep,
        ns_per_point: ns_per_sweep / returns,
    };
    let times = perception(&sweeps, &context);
    let (decode, assemble) = (decode(datagrams) * per_sweep, assemble(&packets) * per_sweep);
    let decisions = decisions(datagrams);
    let stages = vec![
        row("decode", decode),
        row("sweep", assemble),
        row("floor", times.floor),
        row("clusters", (times.clusters - times.floor).max(0.0)),
        row("motion", times.motion),
        row("people", times.people),
        row("track", times.track),
        row("guard", decisions.median_ns * per_sweep),
        row("sweep to tracks", times.whole),
        row("datagrams to tracks", decode + assemble + times.whole),
    ];
    Some(Measured { input, stages, decisions })
}

fn returns(sweep: &Sweep) -> usize {
    sweep.used_columns().iter().flat_map(|column| column.range_raw).filter(|raw| *raw != 0).count()
}

/// Per datagram.
fn decode(datagrams: &[Datagram]) -> f64 {
    let rounds = (0..ROUNDS).map(|_| {
        let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
        nanoseconds(|| {
            for datagram in datagrams {
                let arrival = Stamp::from_micros(datagram.captured_us);
                let _ = black_box(decoder.decode(black_box(&datagram.payload), arrival));
            }
        })
    });
    median(rounds.collect()) / datagrams.len() as f64
}

/// Per datagram.
fn assemble(packets: &[LidarPacket]) -> f64 {
    let mut building: Box<Sweep> = Box::new(Sweep::EMPTY);
    let rounds = (0..ROUNDS).map(|_| {
        let mut builder = SweepBuilder::new(18_000);
        nanoseconds(|| {
            for packet in packets {
                builder.add(black_box(packet), 0, &mut building, |sweep| {
                    black_box(sweep);
                });
            }
        })
    });
    median(rounds.collect()) / packets.len() as f64
}

/// Medians per sweep, nanoseconds.
struct Perception {
    floor: f64,
    /// Floor and clusters.
    clusters: f64,
    motion: f64,
    /// Candidates, their shapes and the classifier.
    people: f64,
    track: f64,
    /// Floor to tracks without motion.
    whole: f64,
}

fn perception(sweeps: &[Box<Sweep>], context: &SweepContext) -> Perception {
    let angles = RingAngles::vlp16();
    let mut times: [Vec<f64>; 6] = Default::default();
    let mut mask = Box::new(FloorMask::new());
    for _ in 0..ROUNDS {
        let mut pipeline = Box::new(PeoplePipeline::new(angles));
        let mut staged = Box::new(PeoplePipeline::new(angles));
        let mut motion = Box::new(MotionDetector::new(MotionParameters::FIXED));
        let mut tracker = Box::new(Tracker::new(TrackerParameters::default()));
        for sweep in sweeps {
            let [floor, clusters, moving, people, track, whole] = &mut times;
            floor.push(nanoseconds(|| mask.find(black_box(sweep), &angles, &context.sensor_in_base)));
            clusters.push(nanoseconds(|| staged.find_clusters(black_box(sweep), context)));
            moving.push(nanoseconds(|| {
                black_box(motion.process(&staged, black_box(sweep), context));
            }));
            people.push(nanoseconds(|| staged.find_detections(black_box(sweep), context)));
            let detections: Vec<Detection> = staged.detections().to_vec();
            track.push(nanoseconds(|| tracker.update(sweep.end_stamp, black_box(&detections), |_| true)));
            whole.push(nanoseconds(|| {
                black_box(pipeline.process(black_box(sweep), context));
            }));
        }
    }
    let [floor, clusters, motion, people, track, whole] = times.map(median);
    Perception { floor, clusters, motion, people, track, whole }
}
