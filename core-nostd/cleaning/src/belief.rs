//! The joint belief about where the robot went and how much dirt lies where: a particle filter that carries dirt.
//!
//! Every particle is a pose with its own dirt for the cells under its brush. Localisation doubt is therefore in the
//! dirt belief by construction: a cell that only some of the possible brushes have swept stays partly dirty
//! (book, Cleaning: Joint belief).

use super::active_cells::{ActiveCell, ActiveCells, Collapse};
use super::brush_places::BrushPlaces;
use super::dirt_model::{ActuatorModel, DirtSensorModel, sweep_cell};
use super::swath::{Brush, Swath};
use super::swath_mask::{SwathMask, SweptCell};
use floorguard_localisation::{MotionNoise, OdometryStep, sample_motion};
use floorguard_localisation::{RangeModel, RangeModelConfig};
use floorguard_localisation::{normalise, systematic};
use floorguard_mapping::{DirtCell, DirtMap, DistanceField, GridCoordinates};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::nearest_f32;
use floorguard_types::random::Pcg32;

/// Parameters of the belief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeliefConfig {
    /// The brush of the robot.
    pub brush: Brush,
    /// Share of the dirt that one pass picks up, p, within (0, 1). Over-estimating it makes false claims.
    pub pickup_probability: f32,
    /// How a step acts on a cell.
    pub actuator: ActuatorModel,
    /// How particles become the map again.
    pub collapse: Collapse,
    /// What the dirt sensor counts.
    pub dirt_sensor: DirtSensorModel,
    /// Doubt of the odometry.
    pub motion: MotionNoise,
    /// Doubt of the range sensor.
    pub range: RangeModelConfig,
    /// Units that may stay in a clean cell, τ.
    pub tolerated_units: u8,
    /// Every twentieth particle is moved by these deviations (metres, radians) beside the odometry's doubt:
    /// recovery particles that find the robot after a slip or a push. Where nothing happened their weight is next
    /// to nothing.
    pub recovery_particles: Option<(f32, f32)>,
    /// Resample at every update, as published; otherwise when fewer than half of the particles are effective.
    pub resample_always: bool,
}

/// What was seen since the last update.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// Ends of the beams that hit something, in the robot's frame. Empty: no scan arrived.
    pub hits_in_base: &'a [Point2],
    /// Hits of the dirt sensor since the last update; `None`: its packets were lost, or it is not to be used.
    pub dirt_hits: Option<u32>,
    /// The brush was down and turning. Without it nothing is claimed.
    pub brush_is_cleaning: bool,
}

/// What an update came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UpdateReport {
    /// 1/Σw² before resampling.
    pub effective_particles: f32,
    /// Share of the beams that the map explains at the best particle; `None`: too few beams to tell.
    pub explained_share: Option<f32>,
    /// All weights were lost; the poses are kept with equal weights.
    pub is_degenerate: bool,
    /// Part of a swath lay beyond the window and was not claimed.
    pub is_swath_clipped: bool,
}

/// Standard deviations of a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseDeviation {
    /// Of each coordinate, metres.
    pub position_m: f32,
    /// Of the heading, radians.
    pub heading_rad: f32,
}

/// The particles' mean and deviations, in the map frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParticlePose {
    /// Weighted mean.
    pub mean_in_map: Pose2,
    /// The particle with the largest weight ("most likely").
    pub best_in_map: Pose2,
    /// Root of the mean squared distance from the mean, metres.
    pub position_deviation_m: f32,
    /// Deviation of the heading, radians.
    pub heading_deviation_rad: f32,
}

/// The joint belief. `S` stores the active cells: its length is how many cells the particles can hold at once.
#[derive(Clone, Debug)]
pub struct Belief<S, const PARTICLES: usize> {
    config: BeliefConfig,
    range: RangeModel,
    poses: [Pose2; PARTICLES],
    log_weights: [f32; PARTICLES],
    weights: [f32; PARTICLES],
    cells: ActiveCells<S, PARTICLES>,
    random: Pcg32,
}

/// One particle in this many is a recovery particle.
const RECOVERY_INTERVAL: usize = 20;

/// A pose with normal deviations of position (metres) and heading (radians).
fn scatter(pose: Pose2, (position_m, heading_rad): (f32, f32), random: &mut Pcg32) -> Pose2 {
    let (x, y) = random.normal_pair();
    Pose2::new(
        pose.x_m + x * position_m,
        pose.y_m + y * position_m,
        pose.heading_rad + random.normal() * heading_rad,
    )
}

impl<S: AsMut<[ActiveCell<PARTICLES>]>, const PARTICLES: usize> Belief<S, PARTICLES> {
    /// A belief that knows nothing of the pose yet: call [`Self::place`].
    #[must_use]
    pub fn new(config: BeliefConfig, storage: S, random: Pcg32) -> Self {
        Self {
            config,
            range: RangeModel::new(config.range),
            poses: [Pose2::default(); PARTICLES],
            log_weights: [0.0; PARTICLES],
            weights: [1.0 / nearest_f32(PARTICLES).max(1.0); PARTICLES],
            cells: ActiveCells::new(storage),
            random,
        }
    }

    /// Spreads the particles around a pose of the map frame.
    pub fn place(&mut self, pose_in_map: Pose2, doubt: PoseDeviation) {
        self.poses = [pose_in_map; PARTICLES];
        self.widen(doubt);
        self.log_weights = [0.0; PARTICLES];
        self.weights = [1.0 / nearest_f32(PARTICLES).max(1.0); PARTICLES];
    }

    /// Adds doubt to every particle, and gives up what the present cells were credited with: for a robot that finds
    /// that it is not where it believed to be.
    pub fn distrust<M: AsRef<[DirtCell]> + AsMut<[DirtCell]>>(
        &mut self,
        map: &mut DirtMap<M>,
        doubt: PoseDeviation,
    ) {
        self.cells.distrust(map);
        self.widen(doubt);
    }

    fn widen(&mut self, PoseDeviation { position_m, heading_rad }: PoseDeviation) {
        for pose in &mut self.poses {
            *pose = scatter(*pose, (position_m, heading_rad), &mut self.random);
        }
    }

    /// One step: move, weigh by the scan, sweep, weigh by the dirt, empty the cells that were left, resample. Cost:
    /// PARTICLES × (beams + cells under the brush), whatever the size of the floor.
    pub fn update<F, M>(
        &mut self,
        step: OdometryStep,
        evidence: &Evidence<'_>,
        (field, map): (&DistanceField<F>, &mut DirtMap<M>),
    ) -> UpdateReport
    where
        F: AsRef<[u8]> + AsMut<[u8]>,
        M: AsRef<[DirtCell]> + AsMut<[DirtCell]>,
    {
        let mut report = UpdateReport::default();
        let places = self.advance(step, evidence, (field, map), &mut report);
        let effective = normalise(&self.log_weights, &mut self.weights);
        report.is_degenerate = effective.is_none();
        report.effective_particles = effective.unwrap_or(nearest_f32(PARTICLES));
        if effective.is_none() {
            self.log_weights = [0.0; PARTICLES];
        }
        report.explained_share = self.range.explained_share(field, self.best(), evidence.hits_in_base);
        let geometry = *map.geometry();
        self.cells.empty(map, (&self.weights, self.config.tolerated_units), |cell| {
            let GridCoordinates { column, row } = geometry.coordinates(cell);
            !places.is_near(column, row)
        });
        if self.config.resample_always || report.effective_particles < 0.5 * nearest_f32(PARTICLES) {
            self.resample();
        }
        report
    }

    /// Moves and weighs every particle and sweeps the cells under its brush. Returns where the brushes are.
    fn advance<F, M>(
        &mut self,
        step: OdometryStep,
        evidence: &Evidence<'_>,
        (field, map): (&DistanceField<F>, &mut DirtMap<M>),
        report: &mut UpdateReport,
    ) -> BrushPlaces
    where
        F: AsRef<[u8]> + AsMut<[u8]>,
        M: AsRef<[DirtCell]> + AsMut<[DirtCell]>,
    {
        let config = self.config;
        let deviations = config.motion.deviations(step);
        let geometry = *map.geometry();
        let mut places = BrushPlaces::new(config.brush, &geometry);
        for (particle, (pose, log_weight)) in self.poses.iter_mut().zip(&mut self.log_weights).enumerate() {
            let before = *pose;
            *pose = sample_motion(before, step, deviations, &mut self.random);
            let recovery = config.recovery_particles.filter(|_| particle % RECOVERY_INTERVAL == 0);
            if let Some(deviations) = recovery {
                *pose = scatter(*pose, deviations, &mut self.random);
            }
            *log_weight += self.range.log_likelihood(field, *pose, evidence.hits_in_base);
            let bar = config.brush.bar_at(*pose);
            places.add(bar, &geometry);
            let mut removed = 0_u32;
            // A recovery particle leaps; the floor below its leap was not cleaned.
            if evidence.brush_is_cleaning && recovery.is_none() {
                let swath = Swath::between(config.brush.bar_at(before), bar);
                let mask = SwathMask::of(&swath, &geometry);
                report.is_swath_clipped |= mask.is_clipped();
                for SweptCell { column, row, samples: swept } in mask.cells() {
                    let Some(cell) = geometry.index(column, row) else { continue };
                    let Some(touched) = self.cells.touch(map, cell, (particle, &mut self.random)) else {
                        continue;
                    };
                    let mut dirt = touched.get();
                    let model = (config.actuator, config.pickup_probability);
                    removed = removed.saturating_add(u32::from(sweep_cell(
                        &mut dirt,
                        swept,
                        model,
                        &mut self.random,
                    )));
                    touched.set(dirt);
                }
            }
            if let Some(hits) = evidence.dirt_hits {
                *log_weight += config.dirt_sensor.log_likelihood(hits, removed);
            }
        }
        places
    }

    fn resample(&mut self) {
        let mut parents = [0_u16; PARTICLES];
        systematic(&self.weights, &mut self.random, &mut parents);
        let poses = self.poses;
        for (pose, &parent) in self.poses.iter_mut().zip(&parents) {
            *pose = poses.get(usize::from(parent)).copied().unwrap_or(*pose);
        }
        self.cells.inherit(&parents);
        self.log_weights = [0.0; PARTICLES];
        self.weights = [1.0 / nearest_f32(PARTICLES).max(1.0); PARTICLES];
    }

    fn best(&self) -> Pose2 {
        let mut best = (f32::NEG_INFINITY, Pose2::default());
        for (&weight, &pose) in self.weights.iter().zip(&self.poses) {
            if weight > best.0 {
                best = (weight, pose);
            }
        }
        best.1
    }

    /// Where the robot is believed to be.
    #[must_use]
    pub fn pose(&self) -> ParticlePose {
        let (mut x, mut y, mut sin, mut cos) = (0.0, 0.0, 0.0, 0.0);
        for (&weight, pose) in self.weights.iter().zip(&self.poses) {
            let (s, c) = libm::sincosf(pose.heading_rad);
            x += weight * pose.x_m;
            y += weight * pose.y_m;
            sin += weight * s;
            cos += weight * c;
        }
        let mut squared = 0.0;
        for (&weight, pose) in self.weights.iter().zip(&self.poses) {
            let (dx, dy) = (pose.x_m - x, pose.y_m - y);
            squared += weight * (dx * dx + dy * dy);
        }
        let length = libm::sqrtf(sin * sin + cos * cos).clamp(1e-6, 1.0);
        ParticlePose {
            mean_in_map: Pose2::new(x, y, libm::atan2f(sin, cos)),
            best_in_map: self.best(),
            position_deviation_m: libm::sqrtf(squared.max(0.0)),
            // Circular deviation.
            heading_deviation_rad: libm::sqrtf((-2.0 * libm::logf(length)).max(0.0)),
        }
    }

    /// Lets all active cells fall back into the map: at the end of a mission and before the belief is stored.
    pub fn settle<M: AsRef<[DirtCell]> + AsMut<[DirtCell]>>(&mut self, map: &mut DirtMap<M>) {
        self.cells.empty(map, (&self.weights, self.config.tolerated_units), |_| true);
    }

    /// Calls `visit(cell, the map's prior, share that the brush has swept since)` for every cell that the
    /// particles hold: a cell that the brush only grazed must stay on the tour.
    pub fn visit_active(&mut self, visit: impl FnMut(usize, &DirtCell, f32)) {
        self.cells.visit(&self.weights, visit);
    }

    /// Number of cells that the particles hold at the moment.
    #[must_use]
    pub fn active_cells(&mut self) -> usize {
        self.cells.count()
    }

    /// Cells that did not fit among the active ones; they kept their dirt.
    #[must_use]
    pub const fn refused_cells(&self) -> u32 {
        self.cells.refused()
    }

    /// The parameters.
    #[must_use]
    pub const fn config(&self) -> &BeliefConfig {
        &self.config
    }
}
