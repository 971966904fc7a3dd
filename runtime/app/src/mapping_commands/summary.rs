//! What came of mapping a drive, and whether it can be trusted.

use floorguard_mapping::Occupancy;
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::grid_map::GridMap;
use floorguard_mapping_host::mapper::Mapper;
use floorguard_mapping_host::time_offset::{OFFSET_MAX_S, TimeOffset};
use serde::Serialize;

use super::input::SieveCounters;

/// A kept scan that fits the last metres worse than this, 0 to 1, was hardly matched.
const SCORE_POOR: f32 = 0.3;
/// More of them than this share, and the map is in doubt.
const POOR_SHARE_MAX: f64 = 0.05;
/// More frozen or late scans than this share, and something is wrong with the scanner or its clock.
const LEFT_OUT_SHARE_MAX: f64 = 0.05;
/// Odometry that agrees with the map of a drive of this length, metres...
const SUSPICIOUS_PATH_M: f64 = 50.0;
/// ... within this distance everywhere was corrected by a mapping program, metres.
const SUSPICIOUS_M: f64 = 0.15;

/// The summary; field names say the units.
#[derive(Clone, Debug, Serialize)]
pub struct MapSummary {
    /// `good` or `doubtful`.
    pub verdict: &'static str,
    /// Why it is doubtful.
    pub doubts: Vec<String>,
    /// What else the user should know.
    pub notes: Vec<String>,
    /// What was used and left out.
    #[serde(flatten)]
    pub input: SieveCounters,
    /// From the first scan to the last.
    pub duration_s: f64,
    /// Scans that were matched and kept: vertices of the graph.
    pub kept_scans: usize,
    /// Kept scans that hardly fitted.
    pub poor_scans: usize,
    /// Mean value of the matches, 0 to 1.
    pub score_mean: f64,
    /// Length of the path.
    pub path_m: f64,
    /// Places that were recognised and believed.
    pub loops: usize,
    /// Recognised places that contradict the others.
    pub loops_rejected: usize,
    /// Largest distance between odometry and map once both begin alike.
    pub odometry_drift_m: Option<f64>,
    /// By how much the scans are younger than their stamps say, by the turns of the drive; none where it turns too little or its
    /// odometry has no stamps of its own.
    pub scans_younger_ms: Option<f64>,
    /// Its standard deviation.
    pub scans_younger_deviation_ms: Option<f64>,
    /// The times of the poses are corrected by it.
    pub times_corrected: bool,
    /// Edge of a cell.
    pub cell_m: f64,
    /// Width and height of the map.
    pub size_m: [f64; 2],
    /// Floor seen free.
    pub free_m2: f64,
    /// Time needed.
    pub took_s: f64,
    /// The same a scan.
    pub ms_per_scan: f64,
}

/// Summarises. `map` is the finished one; `took_s` the time needed.
pub fn summarise(mapper: &Mapper, map: &GridMap, input: SieveCounters, took_s: f64) -> MapSummary {
    let nodes = &mapper.tracker.nodes;
    let matched = nodes.iter().skip(1);
    let poor_scans = matched.clone().filter(|node| node.score < SCORE_POOR).count();
    let score_mean =
        matched.clone().map(|node| f64::from(node.score)).sum::<f64>() / matched.len().max(1) as f64;
    let path_m = mapper.poses.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let believed = mapper.loop_weights.iter().filter(|weight| **weight > 0.5).count();
    let time = |node: Option<&floorguard_mapping_host::front_end::Node>| node.map_or(0.0, |node| node.time_s);
    let size = |cells: usize| cells as f64 * map.cell_m;
    let mut summary = MapSummary {
        verdict: "good",
        doubts: Vec::new(),
        notes: Vec::new(),
        input,
        duration_s: time(nodes.last()) - time(nodes.first()),
        kept_scans: nodes.len(),
        poor_scans,
        score_mean,
        path_m,
        loops: believed,
        loops_rejected: mapper.loops.len() - believed,
        odometry_drift_m: odometry_drift_m(mapper),
        scans_younger_ms: None,
        scans_younger_deviation_ms: None,
        times_corrected: false,
        cell_m: map.cell_m,
        size_m: [size(map.columns), size(map.rows)],
        free_m2: map.area_m2(Occupancy::Free),
        took_s,
        ms_per_scan: 1.0e3 * took_s / input.scans.max(1) as f64,
    };
    summary.judge();
    summary
}

/// Odometry is laid onto the map at the first scan.
fn odometry_drift_m(mapper: &Mapper) -> Option<f64> {
    let nodes = &mapper.tracker.nodes;
    let start: Se2 = mapper.poses.first()?.compose(nodes.first()?.odometry?.inverse());
    let away = nodes.iter().zip(&mapper.poses);
    let away = away.filter_map(|(node, pose)| Some(start.compose(node.odometry?).distance(*pose)));
    Some(away.fold(0.0, f64::max))
}

impl MapSummary {
    /// What the drive says about the stamps of its scans.
    pub fn enter_offset(&mut self, offset: Option<TimeOffset>) {
        let Some(offset) = offset else { return };
        let (younger_ms, deviation_ms) = (1.0e3 * offset.younger_s, 1.0e3 * offset.deviation_s);
        self.scans_younger_ms = Some(younger_ms);
        self.scans_younger_deviation_ms = Some(deviation_ms);
        self.times_corrected = offset.is_believed();
        if self.times_corrected {
            let what = self.offset_in_words();
            self.notes.push(format!("scans are {what} than stamped; the times of the poses are corrected"));
        } else if offset.is_absurd() {
            self.notes.push(format!(
                "the turns of scans and odometry lie more than {:.0} ms apart: their clocks differ, and nothing is corrected",
                1.0e3 * OFFSET_MAX_S
            ));
        }
    }

    /// "12.1 ± 0.1 ms younger".
    pub fn offset_in_words(&self) -> String {
        let younger_ms = self.scans_younger_ms.unwrap_or(0.0);
        let word = if younger_ms < 0.0 { "older" } else { "younger" };
        let deviation_ms = self.scans_younger_deviation_ms.unwrap_or(0.0).max(0.1);
        format!("{:.1} ± {deviation_ms:.1} ms {word}", younger_ms.abs())
    }

    fn judge(&mut self) {
        let share = |part: u64, all: u64| part as f64 / all.max(1) as f64;
        let input = self.input;
        let read = input.scans + input.frozen + input.not_later + input.empty;
        let mut doubt = |is_so: bool, what: String| {
            if is_so {
                self.doubts.push(what);
            }
        };
        doubt(
            self.poor_scans as f64 > POOR_SHARE_MAX * self.kept_scans as f64,
            format!("{} of {} kept scans hardly fit what was seen before", self.poor_scans, self.kept_scans),
        );
        doubt(
            share(input.frozen, read) > LEFT_OUT_SHARE_MAX,
            format!("{} scans are frozen: equal to the one before while the robot moved", input.frozen),
        );
        doubt(
            share(input.not_later, read) > LEFT_OUT_SHARE_MAX,
            format!("{} scans are too late or come twice", input.not_later),
        );
        doubt(
            share(input.empty, read) > 0.5,
            format!("{} of {read} scans have no return: the scanner was blind", input.empty),
        );
        if !self.doubts.is_empty() {
            self.verdict = "doubtful";
        }
        if input.uneven_times > 0 {
            let what = "bear a time a little before that of the scan before: the clock of the log is uneven";
            self.notes.push(format!("{} scans {what}", input.uneven_times));
        }
        if input.odometry_jumps > 0 {
            self.notes
                .push(format!("odometry was set anew {} times; it was continued", input.odometry_jumps));
        }
        if input.without_odometry > 0 {
            self.notes.push(format!("{} scans were matched without odometry", input.without_odometry));
        }
        if self.path_m >= SUSPICIOUS_PATH_M
            && self.odometry_drift_m.is_some_and(|drift_m| drift_m < SUSPICIOUS_M)
        {
            self.notes.push(format!(
                "the odometry agrees with the map within {:.2} m over {:.0} m: it was probably corrected by a mapping program \
                 already, and this is no test of ours",
                self.odometry_drift_m.unwrap_or(0.0),
                self.path_m
            ));
        }
    }
}
