//! Our side of `cargo xtask bench --peers`: writes the inputs that the peers get, and times ours on the same ones.

use std::hint::black_box;
use std::path::Path;

use anyhow::Context as _;
use floorguard_core::geometry::{Point3, Pose2, Transform3, Twist2};
use floorguard_core::people::{
    Association, FloorHeight, FloorMask, PeoplePipeline, RingAngles, SweepContext,
};
use floorguard_core::sensing::Sweep;
use floorguard_hosted::models::LibsvmModel;

use super::tracking::{crowd_pipeline_ns, filter_ns, joint_step_ns, tracker_step_ns};
use super::{median, nanoseconds};
use crate::data::{bench_input, recording};
use crate::lidar_frames::{datagrams, packets, revolutions, sweep_of};

const ROUNDS: usize = 30;
/// Sweeps of each recording that are clustered.
const SWEEPS: usize = 3;
/// The frames of the synthetic recording that have labels.
const LABELLED: [usize; 5] = [0, 5, 10, 15, 19];
const PACKETS_PER_FRAME: usize = 75;
const SYNTHETIC_HEIGHT_M: f32 = 0.9;
/// Vectors of the support-vector machine (81 clusters, as in the inputs' own table).
const VECTORS: usize = 81;
const FEATURES: usize = 71;

/// What ours took.
#[derive(Clone, Debug, PartialEq)]
pub struct OurTime {
    /// What was to be done; the peers use the same word.
    pub task: &'static str,
    /// On what.
    pub input: String,
    /// Nanoseconds.
    pub ns: f64,
    /// What else was measured.
    pub note: String,
}

/// Writes the inputs into `folder` and measures ours. Inputs that are absent are left out.
///
/// # Errors
/// A file cannot be written or read.
pub fn ours(folder: &Path) -> anyhow::Result<Vec<OurTime>> {
    std::fs::create_dir_all(folder)?;
    let mut times = Vec::new();
    let synthetic = bench_input("lidar/synthetic_vlp16.pcap.gz");
    let office = recording("vlp16_packets/einride_office_600rpm.pcap.gz");
    for (name, path) in [("synthetic_vlp16", &synthetic), ("einride_office_600rpm", &office)] {
        let Some(path) = path else { continue };
        let sweeps = revolutions(&packets(&datagrams(path)));
        for (index, sweep) in sweeps.iter().step_by(4).take(SWEEPS).enumerate() {
            times.push(clusters(folder, &format!("{name}-{index}"), sweep)?);
        }
    }
    if let Some(path) = &synthetic {
        times.push(ground(folder, path)?);
    }
    times.extend(super::floor::planes()?);
    times.extend(super::floor::dirt_blocks()?);
    times.extend(vectors()?);
    for targets in [10, 50, 100] {
        let step_ns = tracker_step_ns(targets, Association::Nearest)?;
        times.extend(step_ns.map(|ns| OurTime::new("tracker", format!("{targets} targets"), ns)));
    }
    let spread_ns = tracker_step_ns(10, Association::Joint)?;
    times.extend(spread_ns.map(|ns| OurTime::new("joint", "10 targets, spread".to_owned(), ns)));
    times.push(OurTime::new("joint", "16 targets in a crowd".to_owned(), joint_step_ns(16)));
    times.push(OurTime::new("filter", "100 targets".to_owned(), filter_ns(100)));
    times.push(OurTime::new("pipeline", "30 people, one revolution".to_owned(), crowd_pipeline_ns()?));
    times.extend(super::tours::tours(folder)?.into_iter().map(OurTime::from));
    Ok(times)
}

impl OurTime {
    const fn new(task: &'static str, input: String, ns: f64) -> Self {
        Self { task, input, ns, note: String::new() }
    }

    pub(super) const fn told(task: &'static str, input: String, ns: f64, note: String) -> Self {
        Self { task, input, ns, note }
    }
}

/// Floor and clusters for ours; the peers get what is left without the floor.
fn clusters(folder: &Path, name: &str, sweep: &Sweep) -> anyhow::Result<OurTime> {
    let angles = RingAngles::vlp16();
    let height_m = match name.starts_with("synthetic") {
        true => SYNTHETIC_HEIGHT_M,
        false => FloorHeight::estimate_m(sweep, &angles).unwrap_or(0.8),
    };
    let context = context(height_m);
    let mut pipeline = Box::new(PeoplePipeline::new(angles));
    let mut mask = Box::new(FloorMask::new());
    mask.find(sweep, &angles, &context.sensor_in_base);
    let time = median(
        (0..ROUNDS).map(|_| nanoseconds(|| pipeline.find_things(black_box(sweep), &context))).collect(),
    );
    let mut points = Vec::new();
    for_each_return(sweep, height_m, |column, ring, point| {
        if !mask.is_floor(column, ring) {
            points.push(point);
        }
    });
    write_points(&folder.join(format!("things-{name}.f32")), &points)?;
    let note = format!("floor and clusters of {} returns", sweep_returns(sweep));
    Ok(OurTime { note, ..OurTime::new("clusters", name.to_owned(), time) })
}

/// Ours and the peers' input from the labelled frames.
fn ground(folder: &Path, capture: &Path) -> anyhow::Result<OurTime> {
    let packets = packets(&datagrams(capture));
    let (angles, context) = (RingAngles::vlp16(), context(SYNTHETIC_HEIGHT_M));
    let mut mask = Box::new(FloorMask::new());
    let (mut times, [mut right, mut wrong, mut missed]) = (Vec::new(), [0_u32; 3]);
    for frame in LABELLED {
        let name = format!("lidar/frame_{frame:02}.label.gz");
        let labels = unpacked(&bench_input(&name).with_context(|| format!("{name} is absent"))?)?;
        let frame_packets = packets.iter().skip(frame * PACKETS_PER_FRAME).take(PACKETS_PER_FRAME);
        let sweep = sweep_of(&frame_packets.cloned().collect::<Vec<_>>());
        for _ in 0..ROUNDS {
            times.push(nanoseconds(|| mask.find(black_box(&sweep), &angles, &context.sensor_in_base)));
        }
        let (mut points, mut kept) = (Vec::new(), Vec::new());
        for_each_return(&sweep, SYNTHETIC_HEIGHT_M, |column, ring, point| {
            let label = labels.get(column * 16 + laser_of_ring(ring)).copied().unwrap_or(u8::MAX);
            let (found, is_floor) = (mask.is_floor(column, ring), label == 0);
            right += u32::from(found && is_floor);
            wrong += u32::from(found && !is_floor);
            missed += u32::from(!found && is_floor);
            points.push(point);
            kept.push(label);
        });
        write_points(&folder.join(format!("labelled-frame_{frame:02}.f32")), &points)?;
        std::fs::write(folder.join(format!("labelled-frame_{frame:02}.u8")), kept)?;
    }
    let share = |other: u32| f64::from(right) / f64::from((right + other).max(1));
    let note = format!("precision {:.3}, recall {:.3}", share(wrong), share(missed));
    Ok(OurTime { note, ..OurTime::new("ground", "synthetic_vlp16".to_owned(), median(times)) })
}

/// Decision and probability of the published model.
fn vectors() -> anyhow::Result<Option<OurTime>> {
    let (Some(model), Some(key)) =
        (recording("models/flobot_pedestrian.model"), recording("models/flobot_svm_key.csv.gz"))
    else {
        return Ok(None);
    };
    let file = LibsvmModel::<FEATURES>::open(&model)?;
    let mut rows = Vec::new();
    for line in String::from_utf8(unpacked(&key)?)?.lines().skip(1).take(VECTORS) {
        let mut row = [0.0; FEATURES];
        for (slot, cell) in row.iter_mut().zip(line.split(',').skip(3)) {
            *slot = cell.trim().parse::<f64>()?;
        }
        rows.push(row);
    }
    let svm = file.model();
    let round = |_| {
        nanoseconds(|| {
            for row in &rows {
                black_box(svm.judge(black_box(row)));
            }
        })
    };
    let time = median((0..ROUNDS).map(round).collect());
    Ok(Some(OurTime::new("svm", format!("{} vectors", rows.len()), time)))
}

pub(super) fn context(height_m: f32) -> SweepContext {
    SweepContext {
        sensor_in_base: Transform3 { translation: Point3::new(0.0, 0.0, height_m), ..Transform3::IDENTITY },
        twist: Twist2::ZERO,
        base_in_odom: Pose2::default(),
    }
}

fn sweep_returns(sweep: &Sweep) -> usize {
    let mut count = 0;
    for_each_return(sweep, 0.0, |_, _, _| count += 1);
    count
}

/// Column, ring and place above the floor of every return, by the sensor's own geometry.
fn for_each_return(sweep: &Sweep, height_m: f32, mut act: impl FnMut(usize, usize, [f32; 3])) {
    for (index, column) in sweep.used_columns().iter().enumerate().filter(|(_, column)| column.measured) {
        let azimuth = (f32::from(column.azimuth_cdeg) * 0.01).to_radians();
        for (ring, raw) in column.range_raw.iter().enumerate().filter(|(_, raw)| **raw != 0) {
            let range_m = f32::from(*raw) * f32::from(sweep.range_unit_mm) * 1.0e-3;
            let elevation = (2.0 * ring as f32 - 15.0).to_radians();
            let level_m = range_m * elevation.cos();
            let place =
                [level_m * azimuth.cos(), -level_m * azimuth.sin(), height_m + range_m * elevation.sin()];
            act(index, ring, place);
        }
    }
}

/// Lasers of the wire alternate (wire-formats 1.3).
const fn laser_of_ring(ring: usize) -> usize {
    if ring < 8 { 2 * ring } else { 2 * (ring - 8) + 1 }
}

fn write_points(path: &Path, points: &[[f32; 3]]) -> anyhow::Result<()> {
    let bytes: Vec<u8> = points.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
    Ok(std::fs::write(path, bytes)?)
}

pub(super) fn unpacked(path: &Path) -> anyhow::Result<Vec<u8>> {
    use std::io::Read as _;
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(std::fs::File::open(path)?).read_to_end(&mut bytes)?;
    Ok(bytes)
}
