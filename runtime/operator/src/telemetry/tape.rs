//! Writes tapes (the format is the runtime's).

use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::tape::{TAPE_END, TAPE_MAGIC, TapeLine};

/// A tape that is being written, or none.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    bytes: Option<Vec<u8>>,
}

impl Tape {
    /// Nothing is written.
    #[must_use]
    pub const fn none() -> Self {
        Self { bytes: None }
    }

    /// A tape for a run of a robot: its duration in microseconds, and the route.
    #[must_use]
    pub fn new(robot: &RobotConfiguration, duration_us: u64) -> Self {
        let mut bytes = TAPE_MAGIC.to_vec();
        bytes.extend(duration_us.to_le_bytes());
        let mut tape = Self { bytes: Some(bytes) };
        tape.record((0, 0), TapeLine::Route, &encode_route(robot));
        tape
    }

    /// Adds a delivery: moments of delivery and arrival, microseconds.
    pub fn record(&mut self, (deliver_us, arrival_us): (u64, u64), line: TapeLine, data: &[u8]) {
        self.raw((deliver_us, arrival_us), line.number(), data);
    }

    fn raw(&mut self, (deliver_us, arrival_us): (u64, u64), line: u16, data: &[u8]) {
        let Some(bytes) = &mut self.bytes else { return };
        let length = u16::try_from(data.len()).unwrap_or(u16::MAX);
        bytes.extend(deliver_us.to_le_bytes());
        bytes.extend(arrival_us.to_le_bytes());
        bytes.extend(line.to_le_bytes());
        bytes.extend(length.to_le_bytes());
        bytes.extend(data.iter().take(usize::from(length)));
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }

    /// The finished tape; empty when nothing was written.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        self.raw((0, 0), TAPE_END, &[]);
        self.bytes.unwrap_or_default()
    }
}

/// The robot's route, as `floorguard_runtime::tape::decode_route` reads it.
#[must_use]
pub fn encode_route(robot: &RobotConfiguration) -> Vec<u8> {
    let (route, limits) = (&robot.route, robot.route_limits);
    let repeat = if route.repeat { 1.0 } else { 0.0 };
    let head = [limits.speed_mps, limits.turn_radps, limits.look_ahead_m, limits.reached_m, repeat];
    let places = route.waypoints.iter().flat_map(|place| [place.x_m, place.y_m]);
    head.into_iter().chain(places).flat_map(f32::to_le_bytes).collect()
}
