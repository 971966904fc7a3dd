//! Our side of `cargo xtask bench --peers`: writes the inputs that the peers get, and times ours on the same ones.

use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;

use anyhow::Context as _;
use floorguard_laboratory::models::LibsvmModel;
use floorguard_perception::people::{
    Association, FloorHeight, FloorMask, PeoplePipeline, RingAngles, SweepContext,
};
use floorguard_types::geometry::{Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::Sweep;

use super::tracking::{crowd_pipeline, crowd_steps, filter_time, joint_step, tracker_step};
use super::{Took, took};
use crate::data::{bench_input, recording};
use crate::lidar_frames::{datagrams, packets, revolutions, sweep_of};

const ROUNDS: usize = 60;
/// Of measurements that are a median of many steps already.
const PASSES: usize = 5;
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
    /// Median of all rounds.
    pub median: Took,
    /// The fastest round: what the machine can do when nobody else is at it.
    pub fastest: Took,
    /// What else was measured.
    pub note: String,
}

/// Writes the inputs into `folder` and measures ours; only `task`, if one is named. Inputs that are absent are left out.
///
/// # Errors
/// A file cannot be written or read.
pub fn ours(folder: &Path, task: Option<&str>) -> anyhow::Result<Vec<OurTime>> {
    std::fs::create_dir_all(folder)?;
    let wanted = |name: &str| task.is_none_or(|task| task == name);
    let mut times = Vec::new();
    let synthetic = bench_input("lidar/synthetic_vlp16.pcap.gz");
    if wanted("clusters") || wanted("detector") {
        times.extend(lidar(folder, synthetic.as_deref(), wanted)?);
    }
    if let Some(path) = synthetic.as_deref().filter(|_| wanted("ground")) {
        times.push(ground(folder, path)?);
    }
    if wanted("plane") {
        times.extend(super::floor::planes()?);
    }
    if wanted("floor") {
        times.extend(super::floor::objects());
    }
    if wanted("dirt") {
        times.extend(super::floor::dirt_blocks()?);
    }
    if wanted("svm") {
        times.extend(vectors()?);
    }
    times.extend(associations(folder, wanted)?);
    if wanted("filter") {
        let filters = passes(|| Ok(Some(filter_time(100))))?.unwrap_or_default();
        times.push(OurTime::of("filter", "100 targets".to_owned(), &filters, String::new()));
    }
    if wanted("pipeline") {
        let crowd = passes(|| crowd_pipeline().map(Some))?.unwrap_or_default();
        times.push(OurTime::of(
            "pipeline",
            "30 people, one revolution".to_owned(),
            &crowd,
            "aim 1.0 ms".to_owned(),
        ));
    }
    if wanted("graph") {
        times.extend(super::slam::graphs(folder)?);
    }
    if wanted("odometry") {
        times.extend(super::slam::odometry(folder)?);
    }
    if wanted("tour") {
        times.extend(super::tours::tours(folder)?.into_iter().map(OurTime::from));
    }
    Ok(times)
}

/// Tracks and detections: nearest, and with joint probabilities.
fn associations(folder: &Path, wanted: impl Fn(&str) -> bool) -> anyhow::Result<Vec<OurTime>> {
    let mut times = Vec::new();
    if wanted("tracker") {
        for targets in [10, 50, 100] {
            let steps = passes(|| tracker_step(targets, Association::Nearest))?;
            times
                .extend(steps.map(|steps| {
                    OurTime::of("tracker", format!("{targets} targets"), &steps, String::new())
                }));
        }
    }
    if wanted("joint") {
        for targets in [10, 50] {
            let spread = passes(|| tracker_step(targets, Association::Joint))?;
            times.extend(spread.map(|steps| {
                OurTime::of("joint", format!("{targets} targets, spread"), &steps, String::new())
            }));
        }
        for targets in [10, 14, 16] {
            let crowd = passes(|| Ok(Some(joint_step(targets))))?.unwrap_or_default();
            let note = if targets == 16 { "aim 1 ms" } else { "" };
            times.push(OurTime::of(
                "joint",
                format!("{targets} targets in a crowd"),
                &crowd,
                note.to_owned(),
            ));
        }
        write_crowds(folder)?;
    }
    Ok(times)
}

/// The same several times: the machine is never quiet for long.
fn passes(mut once: impl FnMut() -> anyhow::Result<Option<Took>>) -> anyhow::Result<Option<Vec<Took>>> {
    (0..PASSES).map(|_| once()).collect()
}

impl OurTime {
    pub(super) fn of(task: &'static str, input: String, times: &[Took], note: String) -> Self {
        Self { task, input, median: Took::median(times), fastest: Took::fastest(times), note }
    }

    /// Measured once.
    pub(super) const fn once(task: &'static str, input: String, took: Took, note: String) -> Self {
        Self { task, input, median: took, fastest: took, note }
    }
}

/// What the peers of the joint probabilities get: the same steps, lines of `step,kind,id,x,y`.
fn write_crowds(folder: &Path) -> anyhow::Result<()> {
    for targets in [10, 14, 16] {
        let mut text = String::new();
        for (step, places) in crowd_steps(targets).iter().enumerate() {
            for place in places {
                let _infallible = writeln!(text, "{step},1,0,{},{}", place.x_m, place.y_m);
            }
        }
        std::fs::write(folder.join(format!("crowd_{targets:03}.csv")), text)?;
    }
    Ok(())
}

/// Clusters and the whole detector, on sweeps of the synthetic market, of an office and of a room.
fn lidar(
    folder: &Path,
    synthetic: Option<&Path>,
    wanted: impl Fn(&str) -> bool,
) -> anyhow::Result<Vec<OurTime>> {
    let office = recording("vlp16_packets/einride_office_600rpm.pcap.gz");
    let room = recording("vlp16_packets/mrpt_gps_600rpm.pcap");
    let mut times = Vec::new();
    for (name, path) in [("synthetic_vlp16", synthetic), ("einride_office_600rpm", office.as_deref())] {
        let sweeps = path.map(|path| revolutions(&packets(&datagrams(path)))).unwrap_or_default();
        for (index, sweep) in sweeps.iter().step_by(4).take(SWEEPS).enumerate().filter(|_| wanted("clusters"))
        {
            times.push(clusters(folder, &format!("{name}-{index}"), sweep)?);
        }
    }
    for (name, path) in [("synthetic_vlp16", synthetic), ("mrpt_room", room.as_deref())] {
        let sweeps = path.map(|path| revolutions(&packets(&datagrams(path)))).unwrap_or_default();
        for sweep in sweeps.get(1).into_iter().filter(|_| wanted("detector")) {
            times.push(detector(folder, name, sweep)?);
        }
    }
    Ok(times)
}

/// Floor, clusters, candidates, shapes and classifier; the peers get all returns.
fn detector(folder: &Path, name: &str, sweep: &Sweep) -> anyhow::Result<OurTime> {
    let angles = RingAngles::vlp16();
    let height_m = height_of(name, sweep, &angles);
    let context = context(height_m);
    let mut pipeline = Box::new(PeoplePipeline::new(angles));
    let round = |_| {
        took(|| {
            pipeline.find_clusters(black_box(sweep), &context);
            pipeline.find_detections(sweep, &context);
        })
    };
    let times: Vec<Took> = (0..ROUNDS).map(round).collect();
    let mut points = Vec::new();
    for_each_return(sweep, height_m, |_, _, point| points.push(point));
    write_points(&folder.join(format!("sweep-{name}.f32")), &points)?;
    let note = format!("{} returns; floor, clusters, shapes and classifier", points.len());
    Ok(OurTime::of("detector", name.to_owned(), &times, note))
}

fn height_of(name: &str, sweep: &Sweep, angles: &RingAngles) -> f32 {
    match name.starts_with("synthetic") {
        true => SYNTHETIC_HEIGHT_M,
        false => FloorHeight::estimate_m(sweep, angles).unwrap_or(0.8),
    }
}

/// Floor and clusters for ours; the peers get what is left without the floor.
fn clusters(folder: &Path, name: &str, sweep: &Sweep) -> anyhow::Result<OurTime> {
    let angles = RingAngles::vlp16();
    let height_m = height_of(name, sweep, &angles);
    let context = context(height_m);
    let mut pipeline = Box::new(PeoplePipeline::new(angles));
    let mut mask = Box::new(FloorMask::new());
    mask.find(sweep, &angles, &context.sensor_in_base);
    let times: Vec<Took> =
        (0..ROUNDS).map(|_| took(|| pipeline.find_clusters(black_box(sweep), &context))).collect();
    let mut points = Vec::new();
    for_each_return(sweep, height_m, |column, ring, point| {
        if !mask.is_floor(column, ring) {
            points.push(point);
        }
    });
    write_points(&folder.join(format!("things-{name}.f32")), &points)?;
    let note = format!("floor and clusters of {} returns", sweep_returns(sweep));
    Ok(OurTime::of("clusters", name.to_owned(), &times, note))
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
            times.push(took(|| mask.find(black_box(&sweep), &angles, &context.sensor_in_base)));
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
    Ok(OurTime::of("ground", "synthetic_vlp16".to_owned(), &times, note))
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
        took(|| {
            for row in &rows {
                black_box(svm.judge(black_box(row)));
            }
        })
    };
    let times: Vec<Took> = (0..ROUNDS).map(round).collect();
    Ok(Some(OurTime::of("svm", format!("{} vectors", rows.len()), &times, String::new())))
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
pub(super) fn for_each_return(sweep: &Sweep, height_m: f32, mut act: impl FnMut(usize, usize, [f32; 3])) {
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

/// Lasers of the wire alternate (book, Velodyne: Laser angles).
const fn laser_of_ring(ring: usize) -> usize {
    if ring < 8 { 2 * ring } else { 2 * (ring - 8) + 1 }
}

pub(super) fn write_points(path: &Path, points: &[[f32; 3]]) -> anyhow::Result<()> {
    let bytes: Vec<u8> = points.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
    Ok(std::fs::write(path, bytes)?)
}

pub(super) fn unpacked(path: &Path) -> anyhow::Result<Vec<u8>> {
    use std::io::Read as _;
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(std::fs::File::open(path)?).read_to_end(&mut bytes)?;
    Ok(bytes)
}
