//! RPLidars: set going and asked once, they send the samples of their head in capsules (book, RPLidar).

use floorguard_types::random::Pcg32;

use crate::robot::RplidarModel;
use crate::wire::{rplidar_capsule, rplidar_dense_capsule, rplidar_descriptor};

/// From the last sample of a capsule to the arrival of its last byte, microseconds.
const SEND_US: u64 = 6_000;
/// From a request to its answer, microseconds.
const ANSWER_US: u64 = 2_000;
/// From the request to the first sample: the motor.
const SPIN_UP_US: u64 = 1_000_000;
/// A turn of the head.
const TURN_US: f64 = 100_000.0;
const NOISE_M: f32 = 0.015;

/// Samples of a capsule, microseconds between two, nearest and farthest distance in millimetres.
const fn numbers(model: RplidarModel) -> (usize, f64, [u32; 2]) {
    match model {
        RplidarModel::A => (32, 250.0, [150, 12_000]),
        RplidarModel::S => (40, 62.5, [50, 30_000]),
    }
}

/// The sensor.
#[derive(Clone, Debug)]
pub struct RplidarScanner {
    model: RplidarModel,
    request: Vec<u8>,
    is_turning: bool,
    /// When its first sample is measured; `None`: it does not measure.
    begins_us: Option<u64>,
    /// Samples since then, and those of the capsule that is being filled.
    sample: u64,
    ranges_mm: Vec<u16>,
    is_first: bool,
    answers: Vec<(u64, Vec<u8>)>,
    random: Pcg32,
}

impl RplidarScanner {
    /// Switched on at time 0.
    #[must_use]
    pub fn new(model: RplidarModel, seed: u64) -> Self {
        Self {
            model,
            request: Vec::new(),
            // The motor of an S turns by itself.
            is_turning: model == RplidarModel::S,
            begins_us: None,
            sample: 0,
            ranges_mm: Vec::new(),
            is_first: true,
            answers: Vec::new(),
            random: Pcg32::new(seed, 23),
        }
    }

    /// Bytes of the robot's computer.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64) {
        for byte in bytes {
            self.request.push(*byte);
            if self.request[0] != 0xA5 {
                self.request.clear();
            } else if let Some((command, payload)) = whole_request(&self.request) {
                self.request.clear();
                self.obey((command, &payload), now_us);
            }
        }
    }

    fn obey(&mut self, (command, payload): (u8, &[u8]), now_us: u64) {
        match (command, payload) {
            (0x25, _) => self.begins_us = None,
            (0x52, _) => {
                let health = [rplidar_descriptor(3, false, 0x06), vec![0, 0, 0]].concat();
                self.answers.push((now_us + ANSWER_US, health));
            }
            (0xF0, [low, high]) => self.is_turning = u16::from_le_bytes([*low, *high]) > 100,
            (0x82, [1, ..]) if self.is_turning && self.begins_us.is_none() => {
                let kind = if self.model == RplidarModel::A { 0x82 } else { 0x85 };
                self.answers.push((now_us + ANSWER_US, rplidar_descriptor(84, true, kind)));
                (self.begins_us, self.sample, self.is_first) = (Some(now_us + SPIN_UP_US), 0, true);
                self.ranges_mm.clear();
            }
            _ => {}
        }
    }

    /// Measures samples up to a time: `range_m` gives the distance at a time in microseconds and an angle from the front in radians,
    /// noise not included. Returns what arrives at the host, each with its time.
    pub fn measure(
        &mut self,
        now_us: u64,
        mut range_m: impl FnMut(f64, f64) -> Option<f32>,
    ) -> Vec<(u64, Vec<u8>)> {
        let mut arrives = std::mem::take(&mut self.answers);
        let (count, sample_us, [nearest_mm, farthest_mm]) = numbers(self.model);
        let Some(begins_us) = self.begins_us else { return arrives };
        loop {
            let since_us = self.sample as f64 * sample_us;
            let at_us = begins_us as f64 + since_us;
            if at_us > now_us as f64 {
                return arrives;
            }
            let clockwise_deg = 360.0 * since_us / TURN_US - earlier_deg(self.model, self.sample);
            let spread: f32 = (0..4).map(|_| self.random.uniform()).sum::<f32>() - 2.0;
            let measured =
                range_m(at_us, -clockwise_deg.to_radians()).map(|metres| metres + spread * NOISE_M * 1.732);
            let millimetres = measured.map_or(0, |metres| (metres * 1_000.0 + 0.5).max(0.0) as u32);
            let is_seen = (nearest_mm..=farthest_mm).contains(&millimetres);
            self.ranges_mm.push(if is_seen { millimetres as u16 } else { 0 });
            self.sample += 1;
            if self.ranges_mm.len() == count {
                arrives.push((at_us as u64 + SEND_US, self.capsule(sample_us)));
            }
        }
    }

    fn capsule(&mut self, sample_us: f64) -> Vec<u8> {
        let ranges_mm = std::mem::take(&mut self.ranges_mm);
        let first = self.sample - ranges_mm.len() as u64;
        let angle_deg = (360.0 * first as f64 * sample_us / TURN_US) % 360.0;
        let angle_q6 = (angle_deg * 64.0) as u16;
        let is_first = std::mem::take(&mut self.is_first);
        match self.model {
            RplidarModel::A => {
                let earlier = (first..).map(|sample| (earlier_deg(RplidarModel::A, sample) * 8.0) as u8);
                let samples: Vec<(u16, u8)> = ranges_mm.into_iter().zip(earlier).collect();
                rplidar_capsule(angle_q6, is_first, &samples)
            }
            RplidarModel::S => rplidar_dense_capsule(angle_q6, is_first, &ranges_mm),
        }
    }
}

/// By so much an A measures before the even step: it says so.
fn earlier_deg(model: RplidarModel, sample: u64) -> f64 {
    match model {
        RplidarModel::A => 5.0 + (sample % 4) as f64 / 8.0,
        RplidarModel::S => 0.0,
    }
}

/// A whole request: its command and payload. One with a wrong checksum is none.
fn whole_request(bytes: &[u8]) -> Option<(u8, Vec<u8>)> {
    let command = *bytes.get(1)?;
    if command & 0x80 == 0 {
        return Some((command, Vec::new()));
    }
    let length = usize::from(*bytes.get(2)?);
    let check = *bytes.get(3 + length)?;
    let is_right = bytes[..3 + length].iter().fold(0, |check, byte| check ^ byte) == check;
    Some((if is_right { command } else { 0 }, bytes[3..3 + length].to_vec()))
}
