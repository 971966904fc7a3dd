//! VLP-16: exact firing times, 2 mm steps, noise, drop-outs, single and dual return (book, Velodyne).

use floorguard_types::random::Pcg32;

use super::View;
use crate::scene::Hit;
use crate::wire::{DataPacket, ReturnMode, encode_position};

/// Duration of a single-return packet, nanoseconds (book, Velodyne: Firing times).
pub const LIDAR_PACKET_NS: u64 = 1_327_104;
const FIRING_NS: u64 = 55_296;
const LASER_NS: u64 = 2_304;
/// Elevations by laser id, degrees (book, Velodyne: Laser angles).
const ELEVATIONS_DEG: [f32; 16] =
    [-15.0, 1.0, -13.0, 3.0, -11.0, 5.0, -9.0, 7.0, -7.0, 9.0, -5.0, 11.0, -3.0, 13.0, -1.0, 15.0];
const RANGE_MIN_M: f32 = 0.45;
const RANGE_MAX_M: f32 = 100.0;
const COUNTS_PER_M: f32 = 500.0;
const NOISE_M: f32 = 0.008;
/// Share of beams that get lost for no visible reason.
const DROP_OUT: f32 = 0.001;
const HOUR_US: u64 = 3_600_000_000;

/// The lidar.
#[derive(Clone, Debug)]
pub struct Lidar {
    mode: ReturnMode,
    /// Start of the packet that is being measured, nanoseconds of the world.
    packet_start_ns: u64,
    /// Turn of the head, hundredths of a degree a microsecond: 0.36 at 600 rpm.
    rate_cdeg_per_us: f64,
    /// What the sensor's own clock showed when the world began, and how fast it goes wrong.
    clock_offset_us: u64,
    clock_drift_ppm: f64,
    /// One firing in so many is measured; those after it repeat it.
    grain: usize,
    /// Sine and cosine of each laser's elevation.
    elevations: [(f32, f32); 16],
    random: Pcg32,
}

impl Lidar {
    /// Switched on at time 0 at 600 rpm.
    #[must_use]
    pub fn new(seed: u64, mode: ReturnMode) -> Self {
        let mut random = Pcg32::new(seed, 11);
        let clock_offset_us = u64::from(random.below(3_000_000)) * 1_000;
        let clock_drift_ppm = f64::from(random.uniform_between(-30.0, 30.0));
        let elevations = ELEVATIONS_DEG.map(|degrees| libm::sincosf(degrees.to_radians()));
        Self {
            mode,
            packet_start_ns: 0,
            rate_cdeg_per_us: 0.36,
            clock_offset_us,
            clock_drift_ppm,
            grain: 1,
            elevations,
            random,
        }
    }

    /// Measures only one firing in `grain`, which those after it repeat: as many returns at a fraction of the cost, where
    /// many hours are to be played and nobody asks how fine a lidar sees.
    pub const fn coarse(&mut self, grain: usize) {
        self.grain = if grain == 0 { 1 } else { grain };
    }

    fn packet_ns(&self) -> u64 {
        if self.mode == ReturnMode::Dual { LIDAR_PACKET_NS / 2 } else { LIDAR_PACKET_NS }
    }

    /// When the packet now being measured is complete, microseconds of the world.
    #[must_use]
    pub fn due_us(&self) -> u64 {
        (self.packet_start_ns + self.packet_ns()).div_ceil(1_000)
    }

    /// The sensor's clock, microseconds of its hour.
    fn hour_us(&self, world_ns: u64) -> u32 {
        let elapsed_us = world_ns as f64 * 1.0e-3 * (1.0 + self.clock_drift_ppm * 1.0e-6);
        ((self.clock_offset_us + elapsed_us as u64) % HOUR_US) as u32
    }

    /// A position packet: no receiver connected, so no PPS and an invalid sentence that starts at 2000-01-01.
    #[must_use]
    pub fn position_packet(&self, now_us: u64) -> Vec<u8> {
        encode_position(
            self.hour_us(now_us * 1_000),
            0,
            "$GPRMC,000000,V,0000.00,N,00000.00,E,000.0,000.0,010100,000.0,E*61",
        )
    }

    /// Measures the packet that ends now; the robot's last step was at `step_us`.
    pub fn measure(&mut self, view: &View<'_>, step_us: u64) -> Vec<u8> {
        let start_ns = self.packet_start_ns;
        self.packet_start_ns += self.packet_ns();
        let mut packet = DataPacket::new(self.mode, self.hour_us(start_ns));
        let dual = self.mode == ReturnMode::Dual;
        let sequences = if dual { 12 } else { 24 };
        let mut candidates = Vec::new();
        let mut cells = [None; 16];
        for sequence in 0..sequences {
            let firing_ns = start_ns + FIRING_NS * sequence as u64;
            let azimuth_cdeg = firing_ns as f64 * 1.0e-3 * self.rate_cdeg_per_us;
            let (block, half) = (sequence / 2, sequence % 2);
            let blocks = if dual { 2 * block..2 * block + 2 } else { block..block + 1 };
            if half == 0 {
                let on_wire = (azimuth_cdeg % 36_000.0) as u32;
                blocks.clone().for_each(|block| packet.set_azimuth(block, on_wire));
            }
            if sequence % self.grain == 0 {
                let ahead_s = (firing_ns as f64 * 1.0e-9 - step_us as f64 * 1.0e-6) as f32;
                let sensor = view.sensor(ahead_s);
                let turns_cdeg = (azimuth_cdeg / 36_000.0).floor() * 36_000.0;
                let bearing_rad = |cdeg: f64| sensor.heading_rad - within_turn_rad(cdeg, turns_cdeg);
                view.candidates(bearing_rad(azimuth_cdeg), &mut candidates);
                for (laser, (cell, elevation)) in cells.iter_mut().zip(&self.elevations).enumerate() {
                    let laser_us = (LASER_NS * laser as u64) as f64 * 1.0e-3;
                    let beam = (bearing_rad(azimuth_cdeg + laser_us * self.rate_cdeg_per_us), *elevation);
                    let hit = view.cast(sensor, beam, &candidates, RANGE_MAX_M);
                    *cell = hit.and_then(|hit| receive(hit, COUNTS_PER_M, &mut self.random));
                }
            }
            for (laser, cell) in cells.iter().enumerate() {
                if let Some((raw, reflectivity)) = *cell {
                    let channel = 16 * half + laser;
                    blocks.clone().for_each(|block| packet.set_cell(block, channel, raw, reflectivity));
                }
            }
        }
        packet.into_bytes()
    }
}

/// Noise, weak echoes and the grid of the counts.
pub(super) fn receive(hit: Hit, counts_per_m: f32, random: &mut Pcg32) -> Option<(u16, u8)> {
    let reach_m = RANGE_MAX_M * libm::sqrtf(f32::from(hit.reflectivity.min(40)) / 40.0);
    if hit.range_m < RANGE_MIN_M || hit.range_m > reach_m || random.bernoulli(DROP_OUT) {
        return None;
    }
    // Twelve uniform numbers would be exact enough; four give the same spread at a third of the cost.
    let sum: f32 = (0..4).map(|_| random.uniform()).sum::<f32>() - 2.0;
    let range_m = hit.range_m + sum * NOISE_M * 1.732;
    Some(((range_m * counts_per_m + 0.5) as u16, hit.reflectivity))
}

/// What is left of an azimuth beyond whole turns, radians. Both numbers are multiples of the azimuth's last bit, so that the
/// difference is exact: the remainder of a division would be the same and cost ten times as much.
pub(super) fn within_turn_rad(azimuth_cdeg: f64, turns_cdeg: f64) -> f32 {
    let rest_cdeg = azimuth_cdeg - turns_cdeg;
    let rest_cdeg = if rest_cdeg < 36_000.0 { rest_cdeg } else { rest_cdeg - 36_000.0 };
    (rest_cdeg * 0.01).to_radians() as f32
}

#[cfg(test)]
mod tests {
    use crate::scenario::Scenario;
    use crate::simulation::Simulation;
    use crate::wire::{Payload, Stream};

    /// Cells of the packets of a tenth of a second, a row for each firing.
    fn firings(grain: usize) -> Vec<Vec<u8>> {
        let mut simulation = Simulation::new(&Scenario::named("crossing").unwrap(), 3).unwrap();
        simulation.coarse_lidar(grain);
        let mut rows = Vec::new();
        simulation.advance_to(100_000, &mut |event| {
            if let (Stream::LidarData, Payload::Bytes(bytes)) = (event.stream, event.payload) {
                let blocks = bytes[..1_200].chunks(100);
                rows.extend(blocks.flat_map(|block| block[4..].chunks(48).map(<[u8]>::to_vec)));
            }
        });
        rows
    }

    /// Two people before the robot, with bodies as the scenario says.
    fn two(bodies: &str) -> Scenario {
        let person = |at: &str| format!("[[person]]\nat_m = {at}\nbodies = \"{bodies}\"\n");
        Scenario::from_toml(&format!("title = \"two\"\n{}{}", person("[3.0, 0.6]"), person("[3.0, -0.6]")))
            .unwrap()
    }

    #[test]
    fn only_individual_bodies_differ() {
        let [one, other] = &two("varied").people(3)[..] else { panic!("two people") };
        assert!((one.height_m() - other.height_m()).abs() > 0.005 && one.radius_m() != other.radius_m());
        assert!(one.build.clothes.is_some() && one.build.clothes != other.build.clothes);
        let [one, other] = &two("same").people(3)[..] else { panic!("two people") };
        assert_eq!((one.height_m(), one.build), (other.height_m(), other.build));
    }

    /// The lidar sees what people wear.
    #[test]
    fn clothes_throw_back_more_or_less() {
        let brightnesses = |bodies: &str| {
            let mut simulation = Simulation::new(&two(bodies), 3).unwrap();
            let mut seen = std::collections::BTreeSet::new();
            simulation.advance_to(100_000, &mut |event| {
                if let (Stream::LidarData, Payload::Bytes(bytes)) = (event.stream, event.payload) {
                    let cells = bytes[..1_200].chunks(100).flat_map(|block| block[4..].chunks(3));
                    seen.extend(cells.filter(|cell| cell[..2] != [0, 0]).map(|cell| cell[2]));
                }
            });
            seen.len()
        };
        let (same, varied) = (brightnesses("same"), brightnesses("varied"));
        assert!(same < 12 && varied > 25, "{same} {varied}");
    }

    #[test]
    fn coarse_lidar_repeats_firings_with_equal_returns() {
        let (fine, coarse) = (firings(1), firings(4));
        assert!(coarse.chunks(4).all(|four| four.iter().all(|row| *row == four[0])));
        assert!(fine.chunks(4).any(|four| four[0] != four[1]));
        let returns = |rows: &[Vec<u8>]| {
            rows.iter().flat_map(|row| row.chunks(3)).filter(|cell| cell[..2] != [0, 0]).count() as f64
        };
        let share = returns(&coarse) / returns(&fine);
        assert!(fine.len() == coarse.len() && (0.95..1.05).contains(&share), "{share}");
    }
}
