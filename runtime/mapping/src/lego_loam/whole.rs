//! Sweeps in, poses out.

use floorguard_mapping::lidar_odometry::{Pose3, SweepReturn};

use super::config::LegoLoamConfig;
use super::features::Features;
use super::mapping::{Mapping, SweepFeatures};
use super::odometry::{Moved, Odometry};

/// What became of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegoOutcome {
    /// The sensor at the end of the sweep, in the frame of the first one.
    pub pose: Pose3,
    /// The same by the odometry alone.
    pub odometry: Pose3,
    /// The sweep was laid onto the map.
    pub is_mapped: bool,
    /// The sweep before had too few features.
    pub is_blind: bool,
}

/// The published program without its messages: odometry for each sweep, mapping every 0.3 s.
#[derive(Clone, Debug)]
pub struct LegoLoam {
    config: LegoLoamConfig,
    odometry: Odometry,
    mapping: Mapping,
    /// Pose in the map, and by the odometry, at the last mapping; and when.
    mapped: Option<(Pose3, Pose3)>,
    mapped_s: f64,
}

impl LegoLoam {
    /// Nothing seen.
    #[must_use]
    pub fn new(config: LegoLoamConfig) -> Self {
        Self {
            config,
            odometry: Odometry::default(),
            mapping: Mapping::default(),
            mapped: None,
            mapped_s: 0.0,
        }
    }

    /// Takes a sweep that ended at a time, seconds.
    pub fn push(&mut self, sweep: &[SweepReturn], end_s: f64) -> LegoOutcome {
        let features = Features::of(sweep, &self.config);
        let Moved { pose: odometry, is_blind, outliers } = self.odometry.push(&features, &self.config);
        let supposed = match &self.mapped {
            Some((pose, then)) => pose.compose(&then.inverse().compose(&odometry)),
            None => odometry,
        };
        let is_due = self.mapped.is_none() || end_s - self.mapped_s >= self.config.mapping_s - 1.0e-3;
        if !is_due {
            return LegoOutcome { pose: supposed, odometry, is_mapped: false, is_blind };
        }
        let surfaces = (self.odometry.surfaces.as_slice(), outliers.as_slice());
        let features = SweepFeatures::new(&self.odometry.edges, surfaces, &self.config);
        let pose = self.mapping.push(features, supposed, &self.config);
        (self.mapped, self.mapped_s) = (Some((pose, odometry)), end_s);
        LegoOutcome { pose, odometry, is_mapped: true, is_blind }
    }

    /// Key frames of the map.
    #[must_use]
    pub fn keys(&self) -> usize {
        self.mapping.keys()
    }
}
