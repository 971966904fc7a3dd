//! The map under construction: each scan is matched with the last metres, places that are recognised correct the whole, and the
//! pose is that of the newest scan and the wheels since.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use anyhow::Context as _;
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::grid_map::{GridMap, GridMapConfig, build_grid_map};
use floorguard_mapping_host::input::ScanRecord;
use floorguard_mapping_host::mapper::{MapConfig, Mapper};
use floorguard_mapping_host::output::{OutputFile, map_files};
use floorguard_navigation::costmap::Beam;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::Scan;

/// A scan is taken in once the robot has gone so far since the last one, or turned: metres and radians.
const STEP_M: f32 = 0.1;
const STEP_RAD: f32 = 0.1;
/// A return that says nothing.
const NO_RANGE_M: f32 = f32::NAN;

/// A map that grows while the robot drives.
pub struct Survey {
    mapper: Mapper,
    /// Where the odometry frame began, map frame.
    start_in_map: Pose2,
    scanner_in_base: Pose2,
    /// Where the odometry frame lies in the map frame.
    odometry_in_map: Pose2,
    last_in_odometry: Option<Pose2>,
    /// The beams of each kept scan, in the scanner's frame.
    beams: Vec<Box<[Beam]>>,
    revision: u32,
    failed: bool,
}

/// A survey for all who draw on it: the drive, and the writer of the map.
pub type SharedSurvey = Arc<Mutex<Survey>>;

/// A finished map.
#[derive(Clone, Debug)]
pub struct SurveyedMap {
    /// The map, in the map frame.
    pub map: GridMap,
    /// A `map_server` pair, the trajectory, the pose graph and a picture.
    pub files: Vec<OutputFile>,
    /// Scans that were kept.
    pub kept_scans: usize,
    /// Places that were recognised.
    pub loops: usize,
}

/// A scan with what the mapper may match.
pub(super) struct SurveyScan<'a> {
    pub(super) scan: &'a Scan,
    /// Where the robot was by its wheels.
    pub(super) base_in_odometry: Pose2,
    /// The beams in the scanner's frame.
    pub(super) beams: Vec<Beam>,
}

impl Survey {
    /// Nothing yet; the robot stands here on the map that is to be.
    #[must_use]
    pub fn new(start_in_map: Pose2) -> Self {
        Self {
            mapper: Mapper::new(MapConfig::default()),
            start_in_map,
            scanner_in_base: Pose2::default(),
            odometry_in_map: start_in_map,
            last_in_odometry: None,
            beams: Vec::new(),
            revision: 0,
            failed: false,
        }
    }

    /// A robot begins with it, its scanner here.
    pub(super) const fn mount(&mut self, scanner_in_base: Pose2) {
        self.scanner_in_base = scanner_in_base;
    }

    /// Where the odometry frame lies in the map frame.
    pub(super) const fn odometry_in_map(&self) -> Pose2 {
        self.odometry_in_map
    }

    /// Takes in a scan, if the robot has moved since the last one.
    pub(super) fn take(&mut self, taken: SurveyScan<'_>) {
        let base = taken.base_in_odometry;
        let has_moved = self.last_in_odometry.is_none_or(|last| {
            let step = last.inverse().compose(base);
            libm::hypotf(step.x_m, step.y_m) >= STEP_M || step.heading_rad.abs() >= STEP_RAD
        });
        if !has_moved || self.failed {
            return;
        }
        self.last_in_odometry = Some(base);
        let ranges = taken.beams.iter().map(|beam| match beam {
            Beam::Hit(end) => end.norm(),
            _ => NO_RANGE_M,
        });
        let record = ScanRecord {
            time_s: taken.scan.stamp.as_micros() as f64 * 1.0e-6,
            odometry: Some(base.compose(self.scanner_in_base).into()),
            first_angle_rad: taken.scan.first_angle_rad,
            step_rad: taken.scan.step_rad,
            ranges_m: ranges.collect(),
            ..ScanRecord::default()
        };
        // A graph that cannot be solved: from then on the robot goes by its wheels, and the map ends here.
        self.failed = self.mapper.push(&record).is_err();
        if self.mapper.tracker.nodes.len() > self.beams.len() {
            self.beams.push(taken.beams.into());
        }
        self.correct();
    }

    /// The newest kept scan says where the odometry frame lies.
    fn correct(&mut self) {
        let newest = self.mapper.tracker.nodes.last().zip(self.mapper.poses.last());
        let Some((odometry, pose)) = newest.and_then(|(node, pose)| Some((node.odometry?, pose))) else {
            return;
        };
        let correction = pose.compose(odometry.inverse());
        self.odometry_in_map = Se2::from(self.start_in_map).compose(correction).single();
    }

    /// All kept scans again, where they belong now: sensor and beams in the map frame. None, unless a place was recognised since
    /// the last call.
    pub(super) fn take_redrawn(&mut self) -> Option<Vec<(Point2, Vec<Beam>)>> {
        let before = std::mem::replace(&mut self.revision, self.mapper.map_revision);
        (before != self.revision).then(|| self.redrawn())
    }

    /// All kept scans, where they belong now.
    pub(super) fn redrawn(&self) -> Vec<(Point2, Vec<Beam>)> {
        let start = Se2::from(self.start_in_map);
        let scans = self.beams.iter().zip(&self.mapper.poses).map(|(beams, pose)| {
            let scanner = start.compose(*pose).single();
            let beams = beams.iter().map(|beam| in_map(scanner, *beam)).collect();
            (Point2::new(scanner.x_m, scanner.y_m), beams)
        });
        scans.collect()
    }

    /// Aligns all scans once more and draws the map.
    ///
    /// # Errors
    /// The robot never moved, the scanner saw nothing, or the graph cannot be solved.
    pub fn finish(&mut self) -> anyhow::Result<SurveyedMap> {
        anyhow::ensure!(
            self.mapper.tracker.nodes.len() > 1,
            "the robot hardly moved: there is nothing to map"
        );
        self.mapper.finish().map_err(|error| anyhow::anyhow!("the graph cannot be solved: {error}"))?;
        self.correct();
        let start = Se2::from(self.start_in_map);
        self.mapper.poses.iter_mut().for_each(|pose| *pose = start.compose(*pose));
        let map =
            build_grid_map(self.mapper.scans(), &GridMapConfig::default()).context("no scan has a return")?;
        let base_in_scanner = Se2::from(self.scanner_in_base).inverse();
        let scanner = self.mapper.matched_trajectory();
        let path: Vec<(f64, Se2)> =
            scanner.into_iter().map(|(time_s, pose)| (time_s, pose.compose(base_in_scanner))).collect();
        let files = map_files(&self.mapper, &map, &path).collect();
        let (kept_scans, loops) = (self.mapper.tracker.nodes.len(), self.mapper.loops.len());
        Ok(SurveyedMap { map, files, kept_scans, loops })
    }
}

/// A beam of the scanner in the map frame.
pub(super) fn in_map(scanner_in_map: Pose2, beam: Beam) -> Beam {
    match beam {
        Beam::Hit(end) => Beam::Hit(scanner_in_map.transform(end)),
        Beam::Free(end) => Beam::Free(scanner_in_map.transform(end)),
        Beam::Unknown => Beam::Unknown,
    }
}

/// The survey; one whose user panicked is still as good as it was.
pub fn locked(survey: &SharedSurvey) -> MutexGuard<'_, Survey> {
    survey.lock().unwrap_or_else(PoisonError::into_inner)
}
