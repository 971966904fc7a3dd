//! S300: 541 beams every 40 ms as one telegram on the serial line (wire-formats 2).

use floorguard_core::random::Pcg32;

use super::View;
use crate::wire::{ScanWords, TelegramHeader, encode_telegram};

const BEAMS: usize = 541;
/// The mirror turns once in 40 ms; the 270° in front take 30 ms of it.
const CYCLE_US: u64 = 40_000;
const BEAM_NS: u64 = 55_556;
/// From the last beam to the first byte: the evaluation.
const PROCESSING_US: u64 = 5_000;
/// 1,108 bytes of ten bits at 500 kbit/s (wire-formats 2.1), a fifth at a time.
const PIECES: usize = 5;
const BYTE_US: u64 = 20;
const RANGE_MAX_M: f32 = 29.9;
const NOISE_M: f32 = 0.012;
/// Nothing came back.
const NO_ECHO: u16 = 0x1FFF;
/// All words of a scanner in stand-by.
const STAND_BY: u16 = 0x4004;

/// What the scanner is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ScannerState {
    /// Measures.
    #[default]
    Measuring,
    /// Sends stand-by words.
    StandBy,
    /// Locked out by a fault: sends status 1.
    LockOut,
}

/// The scanner.
#[derive(Clone, Debug)]
pub struct Scanner {
    words: ScanWords,
    next_beam: usize,
    cycle_start_us: u64,
    scan: u32,
    /// What it is doing.
    pub state: ScannerState,
    random: Pcg32,
}

impl Scanner {
    /// Switched on at time 0.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 12);
        let scan = random.below(10_000);
        Self {
            words: [NO_ECHO; BEAMS],
            next_beam: 0,
            cycle_start_us: 0,
            scan,
            state: ScannerState::default(),
            random,
        }
    }

    /// When the beams that lie before it should be measured next, microseconds.
    #[must_use]
    pub const fn due_us(&self) -> u64 {
        if self.next_beam >= BEAMS {
            self.cycle_start_us + CYCLE_US
        } else {
            // In runs of sixty beams: 3.3 ms.
            self.cycle_start_us + (self.next_beam as u64 + 60) * BEAM_NS / 1_000
        }
    }

    /// Measures all beams up to now. Returns the pieces of the telegram, each with its time, after the last beam.
    pub fn measure(&mut self, view: &View<'_>, now_us: u64, step_us: u64) -> Vec<(u64, Vec<u8>)> {
        if self.next_beam >= BEAMS && now_us >= self.cycle_start_us + CYCLE_US {
            self.cycle_start_us += CYCLE_US;
            self.next_beam = 0;
            return Vec::new();
        }
        let mut candidates = Vec::new();
        for beam in self.next_beam..BEAMS {
            let at_us = self.cycle_start_us + beam as u64 * BEAM_NS / 1_000;
            if at_us > now_us {
                return Vec::new();
            }
            let sensor = view.sensor((at_us as f32 - step_us as f32) * 1.0e-6);
            let bearing = sensor.heading_rad + (-135.0 + 0.5 * beam as f32).to_radians();
            view.candidates(bearing, &mut candidates);
            let hit = view.cast(sensor, (bearing, 0.0), &candidates, RANGE_MAX_M);
            self.words[beam] = hit.map_or(NO_ECHO, |hit| {
                let spread: f32 = (0..4).map(|_| self.random.uniform()).sum::<f32>() - 2.0;
                let range_cm = (hit.range_m + spread * NOISE_M * 1.732) * 100.0 + 0.5;
                let reflector = if hit.reflectivity > 100 { 0x2000 } else { 0 };
                (range_cm.max(3.0) as u16).min(NO_ECHO - 1) | reflector
            });
            self.next_beam = beam + 1;
        }
        self.telegram(now_us)
    }

    fn telegram(&mut self, now_us: u64) -> Vec<(u64, Vec<u8>)> {
        self.scan = self.scan.wrapping_add(1);
        let status = u16::from(self.state == ScannerState::LockOut);
        let header = TelegramHeader { version: 0x0103, status, scan: self.scan, telegram: self.scan as u16 };
        let bytes = match self.state {
            ScannerState::Measuring => encode_telegram(header, &self.words),
            _ => encode_telegram(header, &[STAND_BY; BEAMS]),
        };
        let mut sent = 0;
        let mut piece = |chunk: &[u8]| {
            sent += chunk.len() as u64;
            (now_us + PROCESSING_US + sent * BYTE_US, chunk.to_vec())
        };
        bytes.chunks(bytes.len().div_ceil(PIECES)).map(&mut piece).collect()
    }
}
