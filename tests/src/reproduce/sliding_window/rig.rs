//! The simulated sensor: a URG-04LX on its side, turned back and forth by a motor with an encoder.

use std::f64::consts::TAU;

use floorguard_mapping::sliding_window::{ColumnScan, MotorSample, MotorTrack};
use floorguard_types::geometry::Pose2;
use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;

use super::scene::{Ray, Scene};

/// Beams of the scan: ±90° around the horizon.
pub const BEAMS: usize = 511;
/// From beam to beam: 360°/1,024, in 0.1 s/1,024.
const STEP_RAD: f64 = TAU / 1024.0;
const BEAM_US: f64 = 100_000.0 / 1024.0;
/// From scan to scan, and from encoder sample to encoder sample, microseconds.
pub const SCAN_US: u64 = 100_000;
const ENCODER_US: u64 = 10_000;
/// Height of the lidar and its range, metres.
const HEIGHT: f64 = 0.57;
const RANGE: std::ops::RangeInclusive<f64> = 0.02..=4.0;
/// Standard deviations: of a range up to 1 m, of a farther one as a part of it, of the encoder (0.1°).
const NEAR_SIGMA: f64 = 0.01;
const FAR_SIGMA: f64 = 0.01;
const ENCODER_SIGMA: f64 = 0.1 * TAU / 360.0;

/// Where the robot stands at a time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stand {
    /// Metres.
    pub x: f64,
    /// Metres.
    pub y: f64,
    /// Radians.
    pub heading: f64,
}

impl Stand {
    /// As the core's pose.
    #[must_use]
    pub fn pose(&self) -> Pose2 {
        Pose2::new(self.x as f32, self.y as f32, self.heading as f32)
    }

    /// A place of the robot's frame in that of the world.
    #[must_use]
    pub fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = self.heading.sin_cos();
        [self.x + cos * point[0] - sin * point[1], self.y + sin * point[0] + cos * point[1], point[2]]
    }
}

/// Seeded noise.
#[derive(Clone, Debug)]
struct Noise(u64);

impl Noise {
    /// The finalizer of splitmix64.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().max(1e-300).ln()).sqrt() * (TAU * self.uniform()).cos()
    }
}

/// Between which directions and how fast the motor turns.
#[derive(Clone, Copy, Debug)]
pub struct Sweep {
    /// To both sides of the middle, radians.
    pub half: f64,
    /// Direction of the middle, radians.
    pub middle: f64,
    /// Radians per second.
    pub speed: f64,
}

impl Sweep {
    /// The whole window at the speed that covers cells of 0.05 m at 1.5 m: 13.1 s from end to end.
    pub const WINDOW: Self = Self { half: 112.5 * TAU / 360.0, middle: 0.0, speed: 0.3 };

    /// Seconds from end to end.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        2.0 * self.half / self.speed
    }

    /// Angle and commanded speed at a time; it begins at the right end.
    fn at(&self, seconds: f64) -> [f64; 2] {
        let ends = seconds / self.seconds();
        let part = ends.fract();
        let is_back = (ends.floor() as u64) % 2 == 1;
        let along = if is_back { 1.0 - part } else { part };
        [self.middle - self.half + 2.0 * self.half * along, if is_back { -self.speed } else { self.speed }]
    }

    /// How many ends were reached at a time.
    #[must_use]
    pub fn number(&self, seconds: f64) -> u64 {
        (seconds / self.seconds()) as u64
    }
}

/// The sensor over time.
#[derive(Clone, Debug)]
pub struct Rig {
    /// How the motor turns.
    pub sweep: Sweep,
    /// Its angles, as the encoder gave them.
    pub motor: MotorTrack,
    noise: Noise,
    scans: u64,
    encoder_us: u64,
    beams: Vec<BeamReturn>,
}

impl Rig {
    /// At time 0, at the right end of the sweep.
    #[must_use]
    pub fn new(sweep: Sweep, seed: u64) -> Self {
        let (noise, beams) = (Noise(seed), Vec::with_capacity(BEAMS));
        Self { sweep, motor: MotorTrack::new(), noise, scans: 0, encoder_us: 0, beams }
    }

    /// When the next scan begins, seconds.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        (self.scans * SCAN_US) as f64 * 1e-6
    }

    /// The time of the robot's clock, just after the newest scan.
    #[must_use]
    pub fn now(&self) -> Stamp {
        Stamp::from_micros(self.scans * SCAN_US)
    }

    /// Measures the next scan in a scene, the robot standing by `stand` of the time in seconds; encoder samples up to the end
    /// of its period are taken first.
    pub fn scan(&mut self, scene: &Scene, stand: impl Fn(f64) -> Stand) -> ColumnScan<'_> {
        let begin_us = self.scans * SCAN_US;
        self.scans += 1;
        while self.encoder_us <= self.scans * SCAN_US {
            let [angle, speed] = self.sweep.at(self.encoder_us as f64 * 1e-6);
            let sample = MotorSample {
                stamp: Stamp::from_micros(self.encoder_us),
                angle_rad: (angle + ENCODER_SIGMA * self.noise.normal()) as f32,
                commanded_radps: speed as f32,
            };
            self.motor.push(sample).expect("samples in order");
            self.encoder_us += ENCODER_US;
        }
        self.beams.clear();
        for beam in 0..BEAMS {
            let seconds = (begin_us as f64 + beam as f64 * BEAM_US) * 1e-6;
            let elevation = (beam as f64 - 255.0) * STEP_RAD;
            let stand = stand(seconds);
            let azimuth = stand.heading + self.sweep.at(seconds)[0];
            let direction =
                [elevation.cos() * azimuth.cos(), elevation.cos() * azimuth.sin(), elevation.sin()];
            let range = scene.cast(&Ray { origin: [stand.x, stand.y, HEIGHT], direction }, seconds);
            self.beams.push(self.noise.measured(range));
        }
        ColumnScan {
            first_beam: Stamp::from_micros(begin_us),
            beam_period_us: BEAM_US as f32,
            first_elevation_rad: (-255.0 * STEP_RAD) as f32,
            step_rad: STEP_RAD as f32,
            beams: &self.beams,
        }
    }
}

impl Noise {
    /// What the lidar reports: whole millimetres, and nothing beyond its range.
    fn measured(&mut self, range: Option<f64>) -> BeamReturn {
        let Some(range) = range else { return BeamReturn::Unknown };
        let sigma = if range <= 1.0 { NEAR_SIGMA } else { FAR_SIGMA * range };
        let noisy = range + sigma * self.normal();
        if RANGE.contains(&noisy) {
            BeamReturn::Hit((1_000.0 * noisy).round() as u16)
        } else {
            BeamReturn::Unknown
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::sliding_window::scene::Solid;

    #[test]
    fn the_sensor_is_a_urg() {
        let mut noise = Noise(1);
        let normals: Vec<f64> = (0..20_000).map(|_| noise.normal()).collect();
        let mean = normals.iter().sum::<f64>() / 20_000.0;
        let variance = normals.iter().map(|value| value * value).sum::<f64>() / 20_000.0;
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.05, "{mean} {variance}");
        let scene = Scene { solids: vec![Solid::wall([2.0, -9.0], [2.1, 9.0])], walkers: Vec::new() };
        let mut rig = Rig::new(Sweep { half: 0.5, middle: 0.0, speed: 0.5 }, 7);
        // Straight ahead after a second, at the horizon.
        let stand = |_| Stand::default();
        for _ in 0..10 {
            rig.scan(&scene, stand);
        }
        let scan = rig.scan(&scene, stand);
        let BeamReturn::Hit(range_mm) = scan.beams[255] else { panic!("{:?}", scan.beams[255]) };
        assert!((1_900..2_100).contains(&range_mm), "{range_mm} mm");
        // 16.0° down the floor is 2.05 m away; straight down 0.57 m.
        assert!(matches!(scan.beams[0], BeamReturn::Hit(530..=610)), "{:?}", scan.beams[0]);
        assert_eq!(scan.beams[510], BeamReturn::Unknown);
        let sample_ok = rig.motor.angle_at(Stamp::from_micros(1_000_000)).expect("an angle");
        assert!(sample_ok.abs() < 0.01, "{sample_ok}");
    }
}
