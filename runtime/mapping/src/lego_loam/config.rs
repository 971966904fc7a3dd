//! Values of the published program for a lidar of 16 lasers.

/// How a step of the odometry is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepSolver {
    /// As published: a twentieth of the step of Gauss and Newton.
    #[default]
    Published,
    /// Damped (Levenberg, Marquardt): the whole step where it lowers the error.
    Damped,
}

/// Settings. Lengths in metres, angles in degrees as in the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegoLoamConfig {
    /// Columns of the range image: 0.2° each.
    pub columns: usize,
    /// Rows: one for each laser.
    pub rows: usize,
    /// Angle from row to row.
    pub row_deg: f32,
    /// The lowest laser looks this far below the horizontal; a tenth more keeps it in its row.
    pub bottom_deg: f32,
    /// Rows below this one may be ground.
    pub ground_rows: usize,
    /// Nearer returns are left out.
    pub range_least_m: f32,
    /// Ground rises by at most this from row to row.
    pub ground_deg: f32,
    /// Neighbours belong together if the line between them is steeper than this against the view.
    pub segment_deg: f32,
    /// Segments with so many returns are kept ...
    pub segment_points: usize,
    /// ... and those with so many on so many rows.
    pub small_segment_points: usize,
    /// Rows of a small segment.
    pub small_segment_rows: usize,
    /// Smoothness of edges is above this, and that of flats below.
    pub smoothness: f32,
    /// Largest squared distance of a correspondence in the odometry, m².
    pub nearest_m2: f32,
    /// Rounds of each step.
    pub rounds: usize,
    /// How a step is solved.
    pub solver: StepSolver,
    /// Least time between mappings, seconds.
    pub mapping_s: f64,
    /// Edges of the cubes that thin corners, surfaces and outliers of the map.
    pub corner_m: f32,
    /// Of surfaces and of outliers.
    pub surface_m: f32,
    /// Key frames within this distance are the map.
    pub surrounding_m: f64,
    /// A key frame each so many metres.
    pub key_m: f64,
}

impl Default for LegoLoamConfig {
    fn default() -> Self {
        Self {
            columns: 1_800,
            rows: 16,
            row_deg: 2.0,
            bottom_deg: 15.1,
            ground_rows: 7,
            range_least_m: 1.0,
            ground_deg: 10.0,
            segment_deg: 60.0,
            segment_points: 30,
            small_segment_points: 5,
            small_segment_rows: 3,
            smoothness: 0.1,
            nearest_m2: 25.0,
            rounds: 25,
            solver: StepSolver::Published,
            mapping_s: 0.3,
            corner_m: 0.2,
            surface_m: 0.4,
            surrounding_m: 50.0,
            key_m: 0.3,
        }
    }
}
