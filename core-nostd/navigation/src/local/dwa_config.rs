//! Parameters of the dynamic window, as shipped with ROS `dwa_local_planner`.

/// Parameters; the fields carry the published names' meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DwaConfig {
    /// Forward, m/s.
    pub speed_max_mps: f32,
    /// Backwards as a negative number, m/s.
    pub speed_min_mps: f32,
    /// Slower than this and turning slower than `turn_min_radps` is refused, m/s.
    pub translation_min_mps: f32,
    /// Turning, rad/s.
    pub turn_max_radps: f32,
    /// See `translation_min_mps`, rad/s.
    pub turn_min_radps: f32,
    /// Change of speed, m/s².
    pub acceleration_mps2: f32,
    /// Change of turning rate, rad/s².
    pub turn_acceleration_radps2: f32,
    /// How far trajectories are simulated, seconds.
    pub horizon_s: f32,
    /// Way between two poses of a trajectory, metres.
    pub granularity_m: f32,
    /// Turn between two poses of a trajectory, radians.
    pub angular_granularity_rad: f32,
    /// Samples of the speed.
    pub speed_samples: u8,
    /// Samples of the turning rate.
    pub turn_samples: u8,
    /// Weight of the distance to the path; multiplied by the cell's edge.
    pub path_bias: f32,
    /// Weight of the distance to the local goal; multiplied by the cell's edge.
    pub goal_bias: f32,
    /// Weight of the costmap.
    pub obstacle_scale: f32,
    /// Weight of turning.
    pub twirling_scale: f32,
    /// The nose that is aligned lies this far ahead, metres.
    pub forward_point_m: f32,
    /// Above this speed the footprint grows, m/s.
    pub scaling_speed_mps: f32,
    /// Up to this share.
    pub scaling_max: f32,
    /// A forbidden sign is allowed again after this way, metres.
    pub oscillation_reset_m: f32,
    /// Or after this turn, radians.
    pub oscillation_reset_rad: f32,
    /// The goal counts as reached within, metres.
    pub goal_within_m: f32,
    /// And within, radians.
    pub goal_within_rad: f32,
    /// Time from command to command, seconds.
    pub period_s: f32,
}

impl DwaConfig {
    /// The defaults of ROS navigation.
    pub const PUBLISHED: Self = Self {
        speed_max_mps: 0.55,
        speed_min_mps: 0.0,
        translation_min_mps: 0.1,
        turn_max_radps: 1.0,
        turn_min_radps: 0.4,
        acceleration_mps2: 2.5,
        turn_acceleration_radps2: 3.2,
        horizon_s: 1.7,
        granularity_m: 0.025,
        angular_granularity_rad: 0.1,
        speed_samples: 3,
        turn_samples: 20,
        path_bias: 0.6,
        goal_bias: 0.8,
        obstacle_scale: 0.01,
        twirling_scale: 0.0,
        forward_point_m: 0.325,
        scaling_speed_mps: 0.25,
        scaling_max: 0.2,
        oscillation_reset_m: 0.05,
        oscillation_reset_rad: 0.2,
        goal_within_m: 0.10,
        goal_within_rad: 0.05,
        period_s: 0.05,
    };
}
