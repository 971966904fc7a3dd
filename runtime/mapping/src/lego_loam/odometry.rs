//! From sweep to sweep in two steps: height, roll and pitch from flats on planes; then the motion on the plane from edges on lines.

use floorguard_mapping::lidar_odometry::Pose3;
use nalgebra::{Matrix3, Vector3};

use super::config::{LegoLoamConfig, StepSolver};
use super::correspondences::{Distance, Line, Triangle, from_line, from_plane, line, triangle};
use super::features::{Feature, Features};
use super::motion::SweepStep;

/// Rounds after which correspondences are looked for again, and from which on far ones count less.
const REFRESH: usize = 5;
/// Fewer correspondences do not move the sensor.
const CORRESPONDENCES_LEAST: usize = 10;
/// Features that the sweep before must have: edges and flats.
const FEATURES_LEAST: [usize; 2] = [10, 100];
/// Share of the step that is made, as published.
const GAIN: f64 = 0.05;
/// An eigenvalue of the equations below this is no information.
const EIGENVALUE_LEAST: f64 = 10.0;
/// A round that moves by less ends the step: radians and metres.
const STOP_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;
const STOP_M: f64 = 0.001;
/// Keeps equations solvable, 1/m².
const REST: f64 = 1.0e-6;
/// Of the damped solution.
const DAMPING_FIRST: f64 = 1.0e-3;
const DAMPING_ROUNDS: usize = 5;

/// Which three numbers a step finds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Step {
    /// Roll, pitch, height.
    Ground,
    /// Yaw and the two directions of the plane.
    Plane,
}

/// The odometry: the sweep before, and the motion.
#[derive(Clone, Debug, Default)]
pub(super) struct Odometry {
    /// Less sharp and less flat features in the frame of the end of the sweep before.
    pub(super) edges: Vec<Feature>,
    pub(super) surfaces: Vec<Feature>,
    step: SweepStep,
    /// The sensor at the end of the sweep, in the frame of the first one.
    pub(super) pose: Option<Pose3>,
}

/// What became of a sweep.
pub(super) struct Moved {
    pub(super) pose: Pose3,
    /// Too few features: the last motion was taken again.
    pub(super) is_blind: bool,
    /// Outliers in the frame of the end.
    pub(super) outliers: Vec<Feature>,
}

impl Odometry {
    /// Takes the features of a sweep.
    pub(super) fn push(&mut self, features: &Features, config: &LegoLoamConfig) -> Moved {
        let last = self.pose;
        let is_seen = self.edges.len() >= FEATURES_LEAST[0] && self.surfaces.len() >= FEATURES_LEAST[1];
        if last.is_some() && is_seen {
            self.ground_step(&features.flat, config);
            self.plane_step(&features.sharp, config);
        }
        let pose = last.map_or_else(Pose3::identity, |last| last.compose(&self.step.pose()));
        self.pose = Some(pose);
        let step = self.step;
        let at_end = |features: &[Feature]| features.iter().map(|each| step.to_end(each)).collect();
        self.edges = at_end(&features.less_sharp);
        self.surfaces = at_end(&features.less_flat);
        Moved { pose, is_blind: last.is_some() && !is_seen, outliers: at_end(&features.outliers) }
    }

    fn ground_step(&mut self, flats: &[Feature], config: &LegoLoamConfig) {
        let mut partners: Vec<Triangle> = Vec::new();
        let mut solver = Solver::new(Step::Ground, config.solver);
        for round in 0..config.rounds {
            if round % REFRESH == 0 {
                let find = |flat| triangle(flat, self.step, &self.surfaces, config.nearest_m2);
                partners = flats.iter().map(find).collect();
            }
            let measure = |step: SweepStep| -> Vec<Distance> {
                let pairs = flats.iter().zip(&partners);
                let distance = |(flat, partner): (&Feature, &Triangle)| {
                    let points = (*partner)?.map(|index| self.surfaces[index].point);
                    from_plane(flat, step, points, round >= REFRESH)
                };
                pairs.filter_map(distance).collect()
            };
            if solver.round(&mut self.step, &measure) {
                break;
            }
        }
    }

    fn plane_step(&mut self, sharp: &[Feature], config: &LegoLoamConfig) {
        let mut partners: Vec<Line> = Vec::new();
        let mut solver = Solver::new(Step::Plane, config.solver);
        for round in 0..config.rounds {
            if round % REFRESH == 0 {
                let find = |edge| line(edge, self.step, &self.edges, config.nearest_m2);
                partners = sharp.iter().map(find).collect();
            }
            let measure = |step: SweepStep| -> Vec<Distance> {
                let pairs = sharp.iter().zip(&partners);
                let distance = |(edge, partner): (&Feature, &Line)| {
                    let points = (*partner)?.map(|index| self.edges[index].point);
                    from_line(edge, step, points, round >= REFRESH)
                };
                pairs.filter_map(distance).collect()
            };
            if solver.round(&mut self.step, &measure) {
                break;
            }
        }
    }
}

/// Solves one step, round by round.
struct Solver {
    step: Step,
    solver: StepSolver,
    /// Directions without information are taken out, as they were found in the first round.
    projection: Option<Matrix3<f64>>,
    damping: f64,
}

impl Solver {
    fn new(step: Step, solver: StepSolver) -> Self {
        Self { step, solver, projection: None, damping: DAMPING_FIRST }
    }

    /// Moves the step once; true if that was little.
    fn round(&mut self, step: &mut SweepStep, measure: &dyn Fn(SweepStep) -> Vec<Distance>) -> bool {
        let distances = measure(*step);
        if distances.len() < CORRESPONDENCES_LEAST {
            return false;
        }
        let (matrix, gradient) = self.equations(&distances);
        let projection = *self.projection.get_or_insert_with(|| informed(&matrix));
        let by = match self.solver {
            StepSolver::Published => {
                let Some(inverse) = matrix.try_inverse() else { return true };
                projection * (inverse * gradient * -GAIN)
            }
            StepSolver::Damped => {
                let Some(by) = self.damped((&matrix, &gradient), (*step, measure), &projection) else {
                    return true;
                };
                by
            }
        };
        *step = self.moved(step, &by);
        let (turn, place) = match self.step {
            Step::Ground => (libm::hypot(by.x, by.y), by.z.abs()),
            Step::Plane => (by.x.abs(), libm::hypot(by.y, by.z)),
        };
        turn < STOP_RAD && place < STOP_M
    }

    fn row(&self, distance: &Distance) -> Vector3<f64> {
        match self.step {
            Step::Ground => Vector3::new(distance.turn.x, distance.turn.y, distance.step.z),
            Step::Plane => Vector3::new(distance.turn.z, distance.step.x, distance.step.y),
        }
    }

    /// As published, the weight scales the row and the distance.
    fn equations(&self, distances: &[Distance]) -> (Matrix3<f64>, Vector3<f64>) {
        // Where all distances point the same way, the rest stays where it is.
        let mut sums = (Matrix3::from_diagonal_element(REST), Vector3::zeros());
        for distance in distances {
            let row = self.row(distance) * distance.weight;
            sums.0 += row * row.transpose();
            sums.1 += row * (distance.weight * distance.distance_m);
        }
        sums
    }

    fn moved(&self, step: &SweepStep, by: &Vector3<f64>) -> SweepStep {
        let mut moved = *step;
        match self.step {
            Step::Ground => {
                moved.angles_rad += Vector3::new(by.x, by.y, 0.0);
                moved.step_m.z += by.z;
            }
            Step::Plane => {
                moved.angles_rad.z += by.x;
                moved.step_m += Vector3::new(by.y, by.z, 0.0);
            }
        }
        moved
    }

    fn damped(
        &mut self,
        (matrix, gradient): (&Matrix3<f64>, &Vector3<f64>),
        (step, measure): (SweepStep, &dyn Fn(SweepStep) -> Vec<Distance>),
        projection: &Matrix3<f64>,
    ) -> Option<Vector3<f64>> {
        let error = |step: SweepStep| {
            let square = |each: &Distance| (each.weight * each.distance_m) * (each.weight * each.distance_m);
            measure(step).iter().map(square).sum::<f64>()
        };
        let before = error(step);
        for _ in 0..DAMPING_ROUNDS {
            let damped = matrix + Matrix3::from_diagonal(&(matrix.diagonal() * self.damping));
            let by = projection * -(damped.try_inverse()? * gradient);
            if error(self.moved(&step, &by)) <= before {
                self.damping *= 0.3;
                return Some(by);
            }
            self.damping *= 10.0;
        }
        None
    }
}

/// Keeps the directions whose eigenvalue is large enough (Zhang et al. 2016).
fn informed(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = matrix.symmetric_eigen();
    let mut projection = Matrix3::zeros();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value >= EIGENVALUE_LEAST {
            projection += vector * vector.transpose();
        }
    }
    projection
}

#[cfg(test)]
#[path = "odometry_tests.rs"]
mod tests;
