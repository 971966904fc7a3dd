//! PandarXT-16 and XT-32: a firing of sixteen or thirty-two lasers each 50 µs, 4 mm steps, noise, drop-outs (book, Hesai).

use floorguard_types::random::Pcg32;

use super::View;
use super::lidar::{receive, within_turn_rad};
use crate::wire::{FIRINGS, PandarPacket};

/// Duration of a packet, nanoseconds.
const PACKET_NS: u64 = 400_000;
const FIRING_NS: u64 = 50_000;
/// From the start of a firing to its first laser, and from a laser to the next (book, Hesai: Times).
const FIRST_LASER_NS: u64 = 368;
const LASER_NS: u64 = 3_024;
const LASER_32_NS: u64 = 1_512;
const RANGE_MAX_M: f32 = 120.0;
const COUNTS_PER_M: f32 = 250.0;
const DAY_US: u64 = 86_400_000_000;
/// 600 turns a minute, hundredths of a degree a microsecond.
const RATE_CDEG_PER_US: f64 = 0.36;

/// The lidar.
#[derive(Clone, Debug)]
pub struct Pandar {
    /// Start of the packet that is being measured, nanoseconds of the world.
    packet_start_ns: u64,
    /// What the sensor's clock showed when the world began, microseconds of the day.
    clock_offset_us: u64,
    sequence: u32,
    /// One firing in so many is measured; those after it repeat it.
    grain: usize,
    /// Sine and cosine of each laser's elevation, from the uppermost down.
    elevations: Vec<(f32, f32)>,
    random: Pcg32,
}

impl Pandar {
    /// With 16 or 32 lasers, switched on at time 0 at 600 rpm.
    #[must_use]
    pub fn new(lasers: u8, seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 13);
        let step_deg = if lasers == 32 { 1.0 } else { 2.0 };
        let elevation = |laser| libm::sincosf((15.0 - step_deg * f32::from(laser)).to_radians());
        Self {
            packet_start_ns: 0,
            clock_offset_us: u64::from(random.below(86_400_000)) * 1_000,
            sequence: random.below(1_000_000),
            grain: 1,
            elevations: (0..lasers).map(elevation).collect(),
            random,
        }
    }

    /// See [`super::Lidar::coarse`].
    pub const fn coarse(&mut self, grain: usize) {
        self.grain = if grain == 0 { 1 } else { grain };
    }

    /// When the packet now being measured is complete, microseconds of the world.
    #[must_use]
    pub fn due_us(&self) -> u64 {
        (self.packet_start_ns + PACKET_NS).div_ceil(1_000)
    }

    /// Measures the packet that ends now; the robot's last step was at `step_us`.
    pub fn measure(&mut self, view: &View<'_>, step_us: u64) -> Vec<u8> {
        let start_ns = self.packet_start_ns;
        self.packet_start_ns += PACKET_NS;
        // The packet's time is that of the start of its last firing, 5.632 us before.
        let stamp_ns = start_ns + (FIRINGS as u64 - 1) * FIRING_NS - 5_632;
        let day_us = (self.clock_offset_us + stamp_ns / 1_000) % DAY_US;
        let mut packet = PandarPacket::new(self.elevations.len(), day_us, self.sequence);
        let between_ns = if self.elevations.len() == 32 { LASER_32_NS } else { LASER_NS };
        self.sequence = self.sequence.wrapping_add(1);
        let mut candidates = Vec::new();
        let mut cells = vec![None; self.elevations.len()];
        for firing in 0..FIRINGS {
            let firing_ns = start_ns + FIRING_NS * firing as u64;
            let azimuth_cdeg = firing_ns as f64 * 1.0e-3 * RATE_CDEG_PER_US;
            packet.set_azimuth(firing, (azimuth_cdeg % 36_000.0) as u32);
            if firing % self.grain == 0 {
                let ahead_s = (firing_ns as f64 * 1.0e-9 - step_us as f64 * 1.0e-6) as f32;
                let sensor = view.sensor(ahead_s);
                let turns_cdeg = (azimuth_cdeg / 36_000.0).floor() * 36_000.0;
                let bearing_rad = |cdeg: f64| sensor.heading_rad - within_turn_rad(cdeg, turns_cdeg);
                view.candidates(bearing_rad(azimuth_cdeg), &mut candidates);
                for (laser, (cell, elevation)) in cells.iter_mut().zip(&self.elevations).enumerate() {
                    let laser_us = (FIRST_LASER_NS + between_ns * laser as u64) as f64 * 1.0e-3;
                    let beam = (bearing_rad(azimuth_cdeg + laser_us * RATE_CDEG_PER_US), *elevation);
                    let hit = view.cast(sensor, beam, &candidates, RANGE_MAX_M);
                    *cell = hit.and_then(|hit| receive(hit, COUNTS_PER_M, &mut self.random));
                }
            }
            for (laser, cell) in cells.iter().enumerate() {
                if let Some(seen) = *cell {
                    packet.set_cell(firing, laser, seen);
                }
            }
        }
        packet.into_bytes()
    }
}
