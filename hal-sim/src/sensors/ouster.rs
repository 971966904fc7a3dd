//! Ouster: columns of up to 128 beams that look to different sides, noise, drop-outs (book, Ouster).

use floorguard_types::geometry::Pose2;
use floorguard_types::random::Pcg32;

use super::View;
use super::lidar::{receive, within_turn_rad};
use crate::robot::OusterDevice;
use crate::wire::{OusterFormat, OusterPacket};

/// Ten turns a second.
const TURN_NS: u64 = 100_000_000;
const RANGE_MAX_M: f32 = 65.0;
/// Two millimetres: finer than its noise.
const COUNTS_PER_M: f32 = 500.0;
/// Column 0 looks to the connector, at the back: hundredths of a degree.
const BACK_CDEG: f64 = 18_000.0;

/// Millimetres and reflectivity.
type Pixel = Option<(u32, u8)>;

/// The lidar.
#[derive(Clone, Debug)]
pub struct Ouster {
    device: OusterDevice,
    /// The next column, counted since the world began.
    column: u64,
    /// What the sensor's clock showed then, nanoseconds.
    clock_offset_ns: u64,
    first_frame: u16,
    /// One column in so many is measured; those after it repeat it.
    grain: usize,
    /// Sine and cosine of each beam's elevation.
    elevations: Vec<(f32, f32)>,
    random: Pcg32,
}

impl Ouster {
    /// Switched on at time 0 at 600 rpm.
    #[must_use]
    pub fn new(device: OusterDevice, seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 14);
        let elevations =
            device.altitude_mdeg.iter().map(|mdeg| libm::sincosf((*mdeg as f32 * 1.0e-3).to_radians()));
        Self {
            device,
            column: 0,
            clock_offset_ns: u64::from(random.below(3_000_000)) * 1_000_000,
            first_frame: random.below(60_000) as u16,
            grain: 1,
            elevations: elevations.collect(),
            random,
        }
    }

    /// See [`super::Lidar::coarse`].
    pub const fn coarse(&mut self, grain: usize) {
        self.grain = if grain == 0 { 1 } else { grain };
    }

    fn column_ns(&self, column: u64) -> u64 {
        column * TURN_NS / u64::from(self.device.columns_per_turn)
    }

    /// When the packet now being measured is complete, microseconds of the world.
    #[must_use]
    pub fn due_us(&self) -> u64 {
        self.column_ns(self.column + u64::from(self.device.columns_per_packet)).div_ceil(1_000)
    }

    /// Measures the packet that ends now; the robot's last step was at `step_us`.
    pub fn measure(&mut self, view: &View<'_>, step_us: u64) -> Vec<u8> {
        let OusterDevice { format, columns_per_turn, columns_per_packet, .. } = self.device;
        let (turn, columns) = (u64::from(columns_per_turn), usize::from(columns_per_packet));
        let frame = self.first_frame.wrapping_add((self.column / turn) as u16);
        let channels = self.elevations.len();
        let mut packet = OusterPacket::new(format, (columns, channels), frame);
        let mut candidates = Vec::new();
        let mut seen = vec![None; channels];
        for index in 0..columns {
            let at_ns = self.column_ns(self.column);
            packet.set_column(index, self.clock_offset_ns + at_ns, (self.column % turn) as u16);
            if index % self.grain == 0 {
                let ahead_s = (at_ns as f64 * 1.0e-9 - step_us as f64 * 1.0e-6) as f32;
                let azimuth_cdeg = (self.column % turn) as f64 * 36_000.0 / turn as f64;
                self.look(view, (view.sensor(ahead_s), azimuth_cdeg), (&mut candidates, &mut seen));
            }
            for (channel, pixel) in seen.iter().enumerate() {
                if let Some((range_mm, reflectivity)) = *pixel {
                    packet.set_pixel((index, channel), range_mm, reflectivity);
                }
            }
            self.column += 1;
        }
        packet.into_bytes()
    }

    /// All beams of a column. Each leaves beside the axis, and its range counts from the axis on.
    fn look(
        &mut self,
        view: &View<'_>,
        (sensor, azimuth_cdeg): (Pose2, f64),
        (candidates, seen): (&mut Vec<usize>, &mut [Pixel]),
    ) {
        let bearing_rad = |cdeg: f64| sensor.heading_rad - within_turn_rad(cdeg.rem_euclid(36_000.0), 0.0);
        let head_rad = bearing_rad(azimuth_cdeg + BACK_CDEG);
        let origin_m = self.device.beam_origin_um as f32 * 1.0e-6;
        let (sin, cos) = libm::sincosf(head_rad);
        let leaves = Pose2::new(sensor.x_m + origin_m * cos, sensor.y_m + origin_m * sin, sensor.heading_rad);
        let beams = self.elevations.iter().zip(self.device.azimuth_mdeg);
        let mut before = None;
        for ((elevation, azimuth_mdeg), pixel) in beams.zip(seen) {
            let bearing = bearing_rad(azimuth_cdeg + BACK_CDEG + f64::from(*azimuth_mdeg) * 0.1);
            if before.replace(bearing) != Some(bearing) {
                view.candidates(bearing, candidates);
            }
            let hit = view.cast(leaves, (bearing, *elevation), candidates, RANGE_MAX_M);
            let received = hit.and_then(|hit| receive(hit, COUNTS_PER_M, &mut self.random));
            let step_mm = if self.device.format == OusterFormat::LowRate { 8 } else { 1 };
            *pixel = received.map(|(raw, reflectivity)| {
                let range_mm = u32::from(raw) * 2 + (origin_m * 1_000.0) as u32;
                (range_mm / step_mm * step_mm, reflectivity)
            });
        }
    }
}
