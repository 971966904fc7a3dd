//! Livox Mid-360: 200,000 points a second all over its field of view, noise, drop-outs (book, Livox).
//!
//! How its beams wander is not published. Here four of them leave every 20 µs, a quarter of a swing apart; they swing up and down 487
//! times a second and turn counter-clockwise ten times a second, so that within a tenth of a second they have been everywhere about
//! once, and are never in the same place again soon.

use floorguard_types::random::Pcg32;

use super::View;
use super::lidar::receive;
use crate::wire::LivoxDatagram;

const BEAMS: u64 = 4;
const FIRINGS_A_DATAGRAM: u64 = 24;
const FIRING_NS: u64 = 20_000;
const SWINGS_A_SECOND: f64 = 487.317;
const TURNS_A_SECOND: f64 = 10.073_9;
/// Lowest elevation, and how far from there to the highest one, degrees (maker's manual).
const ELEVATION_DEG: [f64; 2] = [-7.0, 59.0];
const RANGE_MAX_M: f32 = 40.0;
const COUNTS_PER_M: f32 = 1_000.0;

/// The sensor.
#[derive(Clone, Debug)]
pub struct LivoxMid360 {
    /// Firings since the world began.
    firing: u64,
    clock_offset_ns: u64,
    datagrams: u16,
    /// Its cable points up.
    hangs: bool,
    random: Pcg32,
}

impl LivoxMid360 {
    /// Switched on at time 0; it may hang on its head.
    #[must_use]
    pub fn new(hangs: bool, seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 17);
        let clock_offset_ns = u64::from(random.below(3_000_000)) * 1_000_000;
        Self { firing: 0, clock_offset_ns, datagrams: 0, hangs, random }
    }

    /// When the datagram now being measured is complete, microseconds of the world.
    #[must_use]
    pub const fn due_us(&self) -> u64 {
        ((self.firing + FIRINGS_A_DATAGRAM) * FIRING_NS).div_ceil(1_000)
    }

    /// Measures the datagram that ends now; the robot's last step was at `step_us`.
    pub fn measure(&mut self, view: &View<'_>, step_us: u64) -> Vec<u8> {
        let mut datagram = LivoxDatagram::new(self.clock_offset_ns + self.firing * FIRING_NS, self.datagrams);
        self.datagrams = self.datagrams.wrapping_add(1);
        let mut candidates = Vec::new();
        for _ in 0..FIRINGS_A_DATAGRAM {
            let seconds = (self.firing * FIRING_NS) as f64 * 1.0e-9;
            let azimuth_rad = ((seconds * TURNS_A_SECOND).fract() * core::f64::consts::TAU) as f32;
            let sensor = view.sensor((seconds - step_us as f64 * 1.0e-6) as f32);
            // On its head, left is right and up is down.
            let side = if self.hangs { -1.0 } else { 1.0 };
            let bearing = sensor.heading_rad + side * azimuth_rad;
            view.candidates(bearing, &mut candidates);
            for beam in 0..BEAMS {
                let (sin_e, cos_e) = libm::sincosf(elevation_rad(seconds, beam));
                let hit = view.cast(sensor, (bearing, (side * sin_e, cos_e)), &candidates, RANGE_MAX_M);
                let (counts, reflectivity) =
                    hit.and_then(|hit| receive(hit, COUNTS_PER_M, &mut self.random)).unwrap_or((0, 0));
                let range_mm = f32::from(counts);
                let (sin_a, cos_a) = libm::sincosf(azimuth_rad);
                let at = [cos_e * cos_a, cos_e * sin_a, sin_e];
                datagram.point(at.map(|share| libm::roundf(share * range_mm) as i32), reflectivity);
            }
            self.firing += 1;
        }
        datagram.into_bytes(FIRINGS_A_DATAGRAM * FIRING_NS - FIRING_NS / BEAMS)
    }
}

/// Of one beam: an even swing, radians.
fn elevation_rad(seconds: f64, beam: u64) -> f32 {
    let phase = (seconds * SWINGS_A_SECOND + beam as f64 / BEAMS as f64).fract();
    let [lowest, across] = ELEVATION_DEG;
    (lowest + across * (1.0 - (2.0 * phase - 1.0).abs())).to_radians() as f32
}
