//! How exactly, how fast, how often.

/// Settings of an approach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DockingConfig {
    /// The place counts as met within, metres along and across.
    pub within_m: f32,
    /// And within, radians.
    pub within_rad: f32,
    /// Fastest on the way, m/s.
    pub speed_mps: f32,
    /// Slowest at its end, m/s.
    pub creep_mps: f32,
    /// Backwards, m/s.
    pub reverse_mps: f32,
    /// Slowing down before the place, m/s²: much less than the brakes can.
    pub braking_mps2: f32,
    /// The robot rolls on for so long after a command, seconds.
    pub response_s: f32,
    /// Turning on the spot: slowest and fastest, rad/s.
    pub turn_radps: [f32; 2],
    /// Way over which it comes onto the line through the place, metres.
    pub line_m: f32,
    /// Over the last of the way, metres, only the heading counts once it is near enough to the line: a robot that turns on the spot at
    /// the end rolls on by more than is allowed.
    pub align_m: f32,
    /// Sharpest bend on the way, 1/m.
    pub curvature_per_m: f32,
    /// It goes back so far before another try, metres.
    pub back_m: f32,
    /// Tries at most.
    pub tries: u8,
    /// It stands for so many commands before it judges what it reached.
    pub stands: u8,
}

impl DockingConfig {
    /// For a robot of the example's size: within 1 cm and 1°, with a reserve for what the sensors may be wrong by.
    pub const DEFAULT: Self = Self {
        within_m: 0.005,
        within_rad: 0.010,
        speed_mps: 0.2,
        creep_mps: 0.04,
        reverse_mps: 0.15,
        braking_mps2: 0.05,
        response_s: 0.1,
        turn_radps: [0.07, 0.3],
        line_m: 0.18,
        align_m: 0.15,
        curvature_per_m: 1.5,
        back_m: 1.0,
        tries: 5,
        stands: 10,
    };
}
