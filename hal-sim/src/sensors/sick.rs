//! SICK TiM5xx and LMS1xx: asked once, they send their scans, the one as text, the other one binary (book, CoLa).

use floorguard_types::random::Pcg32;

use crate::robot::SickModel;
use crate::wire::{ColaHeader, cola_binary, cola_scan, cola_scan_binary, cola_telegram};

/// From the end of a scan to the arrival of its last byte, microseconds: TCP.
const SEND_US: u64 = 4_000;
/// From a command to its answer, microseconds.
const ANSWER_US: u64 = 2_000;
/// The command to send scans, with its frame, in either dialect.
const ASK: &[u8] = b"\x02sEN LMDscandata 1\x03";
const ASK_BINARY: &[u8] = b"\x02\x02\x02\x02\0\0\0\x11sEN LMDscandata \x01\x33";
const NOISE_M: f32 = 0.012;

/// Beams, step in ten-thousandths of a degree, microseconds of a turn, nearest and farthest distance in millimetres.
const fn numbers(model: SickModel) -> (u32, u16, u64, [u32; 2]) {
    match model {
        SickModel::Tim5xx => (811, 3_333, 66_667, [50, 10_000]),
        SickModel::Lms1xx => (541, 5_000, 20_000, [500, 20_000]),
    }
}

/// The sensor.
#[derive(Clone, Debug)]
pub struct SickScanner {
    model: SickModel,
    /// Its clock is so much ahead of the world, microseconds.
    clock_us: u64,
    text: Vec<u8>,
    is_sending: bool,
    turn: u64,
    distances_mm: Vec<u32>,
    answers: Vec<(u64, Vec<u8>)>,
    random: Pcg32,
}

impl SickScanner {
    /// Switched on at time 0.
    #[must_use]
    pub fn new(model: SickModel, seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 22);
        let clock_us = u64::from(random.below(u32::MAX));
        let (text, distances_mm, answers) = (Vec::new(), Vec::new(), Vec::new());
        Self { model, clock_us, text, is_sending: false, turn: 0, distances_mm, answers, random }
    }

    /// Bytes of the robot's computer.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64) {
        self.text.extend(bytes);
        let is_binary = self.model == SickModel::Lms1xx;
        let ask = if is_binary { ASK_BINARY } else { ASK };
        if let Some(at) = self.text.windows(ask.len()).position(|window| window == ask) {
            self.text.drain(..at + ask.len());
            self.is_sending = true;
            let answer = if is_binary {
                cola_binary(b"sEA LMDscandata \x01")
            } else {
                cola_telegram("sEA LMDscandata 1")
            };
            self.answers.push((now_us + ANSWER_US, answer));
        }
    }

    /// Measures beams up to a time: `range_m` gives the distance at a time in microseconds and an angle from the front in radians,
    /// noise not included. Returns what arrives at the host, each with its time.
    pub fn measure(
        &mut self,
        now_us: u64,
        mut range_m: impl FnMut(f64, f64) -> Option<f32>,
    ) -> Vec<(u64, Vec<u8>)> {
        let mut arrives = std::mem::take(&mut self.answers);
        let (beams, step, turn_us, [nearest_mm, farthest_mm]) = numbers(self.model);
        let step_deg = f64::from(step) * 1.0e-4;
        loop {
            let begun_us = self.turn * turn_us;
            // The mirror begins at the back: 45° of its turn pass before the first beam.
            let beam = self.distances_mm.len() as u32;
            let turned_deg = 45.0 + step_deg * f64::from(beam);
            let at_us = begun_us as f64 + turned_deg / 360.0 * turn_us as f64;
            if at_us > now_us as f64 {
                return arrives;
            }
            if beam < beams {
                let angle_rad = (turned_deg - 180.0).to_radians();
                let spread: f32 = (0..4).map(|_| self.random.uniform()).sum::<f32>() - 2.0;
                let measured = range_m(at_us, angle_rad).map(|metres| metres + spread * NOISE_M * 1.732);
                let millimetres = measured.map_or(0, |metres| (metres * 1_000.0 + 0.5).max(0.0) as u32);
                let is_seen = (nearest_mm..=farthest_mm).contains(&millimetres);
                self.distances_mm.push(if is_seen { millimetres } else { 0 });
                continue;
            }
            let scan = self.end_turn(begun_us, at_us as u64);
            arrives.extend(scan.map(|bytes| (at_us as u64 + SEND_US, bytes)));
        }
    }

    fn end_turn(&mut self, begun_us: u64, ended_us: u64) -> Option<Vec<u8>> {
        let (_, step, turn_us, _) = numbers(self.model);
        let clock = |world_us: u64| (self.clock_us + world_us) as u32;
        let header = ColaHeader {
            status: 0,
            scan: self.turn as u16,
            clock_us: [clock(begun_us), clock(ended_us)],
            turns_chz: (100_000_000 / turn_us) as u32,
            angles: (-450_000, step),
        };
        let distances_mm = std::mem::take(&mut self.distances_mm);
        self.turn += 1;
        let encode = if self.model == SickModel::Lms1xx { cola_scan_binary } else { cola_scan };
        self.is_sending.then(|| encode(&header, &distances_mm))
    }
}
