//! Any lidar of sixteen rings behind a bridge: 1,024 columns a turn, noise, drop-outs (book, Lidar link).

use floorguard_types::random::Pcg32;

use super::View;
use super::lidar::{receive, within_turn_rad};
use crate::wire::ColumnsDatagram;

const COLUMNS_A_TURN: u64 = 1_024;
const COLUMNS_A_DATAGRAM: u64 = 16;
/// Ten turns a second.
const TURN_NS: u64 = 100_000_000;
const RANGE_MAX_M: f32 = 100.0;
const COUNTS_PER_M: f32 = 250.0;

/// The lidar and its bridge.
#[derive(Clone, Debug)]
pub struct BridgedLidar {
    /// The next column, counted since the world began.
    column: u64,
    clock_offset_us: u64,
    sender: u32,
    sequence: u32,
    /// One column in so many is measured; those after it repeat it.
    grain: u64,
    /// Sine and cosine of each ring's elevation.
    elevations: [(f32, f32); 16],
    random: Pcg32,
}

impl BridgedLidar {
    /// Switched on at time 0 at 600 rpm; elevations in thousandths of a degree.
    #[must_use]
    pub fn new(elevations_mdeg: &[i32; 16], seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 15);
        Self {
            column: 0,
            clock_offset_us: u64::from(random.below(3_000_000)) * 1_000,
            sender: random.below(u32::MAX) | 1,
            sequence: random.below(1_000),
            grain: 1,
            elevations: elevations_mdeg.map(|mdeg| libm::sincosf((mdeg as f32 * 1.0e-3).to_radians())),
            random,
        }
    }

    /// See [`super::Lidar::coarse`].
    pub const fn coarse(&mut self, grain: usize) {
        self.grain = if grain == 0 { 1 } else { grain as u64 };
    }

    /// When the datagram now being measured is complete, microseconds of the world.
    #[must_use]
    pub fn due_us(&self) -> u64 {
        ((self.column + COLUMNS_A_DATAGRAM) * TURN_NS / COLUMNS_A_TURN).div_ceil(1_000)
    }

    /// Measures the datagram that ends now; the robot's last step was at `step_us`.
    pub fn measure(&mut self, view: &View<'_>, step_us: u64) -> Vec<u8> {
        let at_ns = |column: u64| column * TURN_NS / COLUMNS_A_TURN;
        let first_us = at_ns(self.column) / 1_000;
        let mut datagram =
            ColumnsDatagram::new((self.sender, self.sequence), self.clock_offset_us + first_us, 16);
        self.sequence = self.sequence.wrapping_add(1);
        let mut candidates = Vec::new();
        let mut cells = [(0, 0); 16];
        for index in 0..COLUMNS_A_DATAGRAM {
            let azimuth_cdeg = (self.column % COLUMNS_A_TURN) as f64 * 36_000.0 / COLUMNS_A_TURN as f64;
            if index % self.grain == 0 {
                let ahead_s = (at_ns(self.column) as f64 * 1.0e-9 - step_us as f64 * 1.0e-6) as f32;
                let sensor = view.sensor(ahead_s);
                let bearing = sensor.heading_rad - within_turn_rad(azimuth_cdeg, 0.0);
                view.candidates(bearing, &mut candidates);
                for (cell, elevation) in cells.iter_mut().zip(&self.elevations) {
                    let hit = view.cast(sensor, (bearing, *elevation), &candidates, RANGE_MAX_M);
                    *cell =
                        hit.and_then(|hit| receive(hit, COUNTS_PER_M, &mut self.random)).unwrap_or((0, 0));
                }
            }
            let offset_us = at_ns(self.column) / 1_000 - first_us;
            datagram.column(azimuth_cdeg as u16, offset_us as u16, &cells);
            self.column += 1;
        }
        datagram.into_bytes()
    }
}
