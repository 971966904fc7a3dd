//! Mapping beside the peers: pose graphs, odometry of a spinning lidar, and a whole log of a scanner.

use std::path::Path;

use anyhow::Context as _;
use floorguard_mapping::lidar_odometry::{MotionAid, SweepReturn};
use floorguard_mapping_host::lidar3d::{Mapper3, Mapper3Config, SweepRecord};
use floorguard_mapping_host::pose_graph::{OptimiseConfig, chain_start, optimise, read_g2o};
use floorguard_types::geometry::Point3;

use super::cpu::{Took, took};
use super::peers::{OurTime, for_each_return, write_points};
use crate::data::recording;
use crate::lidar_frames::{datagrams, packets, revolutions};
use crate::slam::text;

/// Graphs whose optimum is known.
const GRAPHS: [&str; 2] = ["intel", "manhattan_olson"];
const ROUNDS: usize = 9;
/// Sweeps of the office.
const SWEEPS: usize = 100;
/// A revolution at 600 rpm, seconds, and its columns.
const REVOLUTION_S: f64 = 0.1;
const COLUMNS: f32 = 1_824.0;

/// From the edges alone to the optimum; the peers get the same files, unpacked.
///
/// # Errors
/// A file cannot be read or written, or a graph cannot be solved.
pub(super) fn graphs(folder: &Path) -> anyhow::Result<Vec<OurTime>> {
    let mut times = Vec::new();
    for name in GRAPHS {
        let Some(path) = recording(&format!("posegraphs/{name}.g2o.gz")) else { continue };
        let text = text(&path)?;
        std::fs::write(folder.join(format!("graph-{name}.g2o")), &text)?;
        let read = read_g2o(&text).map_err(|error| anyhow::anyhow!("{name}: {error}"))?;
        let config = OptimiseConfig { steps_max: 100, share_least: 1.0e-6 };
        let mut chi2 = f64::NAN;
        let round = |_| {
            let mut graph = read.clone();
            took(|| {
                graph.poses = chain_start(&graph);
                chi2 = optimise(&mut graph, &[], &config).map_or(f64::NAN, |solved| solved.chi2);
            })
        };
        let rounds: Vec<Took> = (0..ROUNDS).map(round).collect();
        times.push(OurTime::of("graph", name.to_owned(), &rounds, format!("chi-squared {chi2:.3}")));
    }
    Ok(times)
}

/// Sweeps of a standing lidar in an office; the peers get the same returns.
///
/// # Errors
/// A file cannot be written, or the mapping fails.
pub(super) fn odometry(folder: &Path) -> anyhow::Result<Option<OurTime>> {
    let Some(path) = recording("vlp16_packets/einride_office_600rpm.pcap.gz") else { return Ok(None) };
    let mut mapper = Mapper3::new(Mapper3Config::default());
    let mut rounds = Vec::new();
    let mut drift_m = 0.0;
    for (index, sweep) in revolutions(&packets(&datagrams(&path))).iter().take(SWEEPS).enumerate() {
        let (mut returns, mut points) = (Vec::new(), Vec::new());
        for_each_return(sweep, 0.0, |column, ring, point| {
            let place = Point3::new(point[0], point[1], point[2]);
            returns.push(SweepReturn::new(place, column as f32 / COLUMNS, ring as u8));
            points.push(point);
        });
        write_points(&folder.join(format!("odometry-{index:03}.f32")), &points)?;
        let end_s = REVOLUTION_S * (index + 1) as f64;
        let mut record =
            Some(SweepRecord { end_s, duration_s: REVOLUTION_S, returns, reflectivity: Vec::new() });
        let mut pushed = Ok(None);
        rounds.push(took(|| {
            if let Some(record) = record.take() {
                pushed = mapper.push(record, &MotionAid::default());
            }
        }));
        let outcome = pushed.context("the graph cannot be solved")?;
        drift_m = outcome.map_or(drift_m, |outcome| outcome.state.pose.place_m.norm());
    }
    if rounds.is_empty() {
        return Ok(None);
    }
    let note = format!("{} sweeps of a standing lidar, {:.2} cm drift", rounds.len(), 100.0 * drift_m);
    Ok(Some(OurTime::of("odometry", "einride_office_600rpm".to_owned(), &rounds, note)))
}
