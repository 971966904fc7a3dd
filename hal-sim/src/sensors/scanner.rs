//! The scanner: what it measures in a turn of its mirror, and its link to the robot's computer.
//!
//! An S300 sends a telegram on a serial line (book, SICK S300), a microScan3 a message in datagrams (book, microScan3), and so does a
//! bridge (book, Scan link). A Hokuyo (book,
//! SCIP 2.0), a TiM or LMS (book, CoLa) and an RPLidar must be asked.

use floorguard_types::random::Pcg32;

use super::bridged_scanner::ScanBridge;
use super::{RplidarScanner, SickScanner, View};
use crate::actuated::{LidarModel, ScanLidar};
use crate::robot::{HokuyoModel, ScannerDevice};
use crate::wire::Stream;
use crate::wire::{
    BeamWords, DEVICE_ERROR, MessageHeader, RUNS, STANDS_BY, TelegramHeader, encode_scan_message,
    encode_telegram, scan_datagrams,
};

/// The mirror turns once in 40 ms; the 270° in front take 30 ms of it.
const CYCLE_US: u64 = 40_000;
/// A scanner that must be asked measures what it has passed every so often.
const ASKED_US: u64 = 2_500;
/// Beams are measured in runs of a ninth of a scan: 3.3 ms.
const RUNS_A_SCAN: usize = 9;
/// From the last beam to the first byte of an S300: the evaluation.
const PROCESSING_US: u64 = 5_000;
/// 1,108 bytes of ten bits at 500 kbit/s (book, SICK S300: Line), a fifth at a time.
const PIECES: usize = 5;
const BYTE_US: u64 = 20;
/// From the last beam to the first datagram of a microScan3. No figure is published.
const MESSAGE_US: u64 = 8_000;
/// A full frame at 100 Mbit/s.
const DATAGRAM_US: u64 = 125;
const RANGE_MAX_M: f32 = 29.9;
const NOISE_M: f32 = 0.012;
/// Sine and cosine of the elevation of its beams.
const LEVEL: (f32, f32) = (0.0, 1.0);
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
    /// Says that it stands by.
    StandBy,
    /// Locked out by a fault, and says so.
    LockOut,
}

/// What a beam hit.
#[derive(Clone, Copy, Debug)]
struct Echo {
    range_m: f32,
    is_reflector: bool,
}

/// One that must be asked.
#[derive(Clone, Debug)]
enum AskedScanner {
    Hokuyo(ScanLidar),
    Sick(SickScanner),
    Rplidar(RplidarScanner),
}

/// The scanner.
#[derive(Clone, Debug)]
pub struct Scanner {
    device: ScannerDevice,
    echoes: Vec<Option<Echo>>,
    next_beam: usize,
    cycle_start_us: u64,
    /// One that must be asked, and when it measures next.
    asked: Option<(AskedScanner, u64)>,
    /// The program that sends its scans, where one does.
    bridge: Option<ScanBridge>,
    scan: u32,
    /// What it is doing.
    pub state: ScannerState,
    random: Pcg32,
}

impl Scanner {
    /// An S300 that is switched on at time 0.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self::of(ScannerDevice::S300, seed)
    }

    /// A second S300 that is switched on at time 0: its noise is its own, and its mirror does not turn in step with the first one.
    #[must_use]
    pub fn at_rear(seed: u64) -> Self {
        let mut scanner = Self::drawn(ScannerDevice::S300, Pcg32::new(seed, 13));
        scanner.cycle_start_us = u64::from(scanner.random.below(CYCLE_US as u32));
        scanner
    }

    /// A scanner that is switched on at time 0.
    #[must_use]
    pub fn of(device: ScannerDevice, seed: u64) -> Self {
        Self::drawn(device, Pcg32::new(seed, 12))
    }

    fn drawn(device: ScannerDevice, mut random: Pcg32) -> Self {
        let scan = random.below(10_000);
        let beams = match device {
            ScannerDevice::S300 => 541,
            ScannerDevice::MicroScan3(beams) => usize::from(beams.max(2)),
            ScannerDevice::Bridged(scans) => usize::from(scans.beams.max(2)),
            ScannerDevice::Hokuyo(_) | ScannerDevice::Sick(_) | ScannerDevice::Rplidar(_) => 0,
        };
        let own = |random: &mut Pcg32| u64::from(random.below(u32::MAX));
        let asked = match device {
            ScannerDevice::Hokuyo(model) => {
                let model = match model {
                    HokuyoModel::Ust => LidarModel::Ust10lx,
                    HokuyoModel::Urg04lx => LidarModel::Urg04lx,
                };
                Some(AskedScanner::Hokuyo(ScanLidar::new(model, own(&mut random))))
            }
            ScannerDevice::Sick(model) => Some(AskedScanner::Sick(SickScanner::new(model, own(&mut random)))),
            ScannerDevice::Rplidar(model) => {
                Some(AskedScanner::Rplidar(RplidarScanner::new(model, own(&mut random))))
            }
            ScannerDevice::S300 | ScannerDevice::MicroScan3(_) | ScannerDevice::Bridged(_) => None,
        };
        let bridge = match device {
            ScannerDevice::Bridged(scans) => Some(ScanBridge::new(scans, &mut random)),
            _ => None,
        };
        let asked = asked.map(|scanner| (scanner, ASKED_US));
        Self {
            device,
            echoes: vec![None; beams],
            next_beam: 0,
            cycle_start_us: 0,
            asked,
            bridge,
            scan,
            state: ScannerState::default(),
            random,
        }
    }

    /// The line it speaks on.
    #[must_use]
    pub const fn stream(&self) -> Stream {
        match self.device {
            ScannerDevice::MicroScan3(_) | ScannerDevice::Bridged(_) => Stream::ScannerData,
            _ => Stream::ScannerSerial,
        }
    }

    /// First angle and step, degrees; 0 is straight ahead.
    fn angles_deg(&self) -> (f64, f64) {
        if let Some(bridge) = &self.bridge {
            return bridge.angles_deg();
        }
        let sector_deg = if self.stream() == Stream::ScannerSerial { 270.0 } else { 275.0 };
        (-sector_deg / 2.0, sector_deg / (self.echoes.len() - 1) as f64)
    }

    /// From beam to beam, nanoseconds.
    fn beam_ns(&self) -> u64 {
        let (_, step_deg) = self.angles_deg();
        (step_deg / 360.0 * (self.cycle_us() * 1_000) as f64).round() as u64
    }

    /// A turn of its mirror, microseconds.
    fn cycle_us(&self) -> u64 {
        self.bridge.as_ref().map_or(CYCLE_US, ScanBridge::period_us)
    }

    fn beam_at_us(&self, beam: usize) -> u64 {
        self.cycle_start_us + beam as u64 * self.beam_ns() / 1_000
    }

    /// When the beams that lie before it should be measured next, microseconds.
    #[must_use]
    pub fn due_us(&self) -> u64 {
        if let Some((_, due_us)) = self.asked {
            return due_us;
        }
        if self.next_beam >= self.echoes.len() {
            self.cycle_start_us + self.cycle_us()
        } else {
            self.beam_at_us(self.next_beam + self.echoes.len() / RUNS_A_SCAN)
        }
    }

    /// Measures all beams up to now. Returns what it sends, each with its time, after the last beam.
    pub fn measure(&mut self, view: &View<'_>, now_us: u64, step_us: u64) -> Vec<(u64, Vec<u8>)> {
        if let Some((scanner, due_us)) = &mut self.asked {
            *due_us = now_us + ASKED_US;
            return measure_asked(scanner, self.state, view, (now_us, step_us));
        }
        if self.next_beam >= self.echoes.len() && now_us >= self.cycle_start_us + self.cycle_us() {
            self.cycle_start_us += self.cycle_us();
            self.next_beam = 0;
            return Vec::new();
        }
        let (first_deg, step_deg) = self.angles_deg();
        let mut candidates = Vec::new();
        for beam in self.next_beam..self.echoes.len() {
            let at_us = self.beam_at_us(beam);
            if at_us > now_us {
                return Vec::new();
            }
            let sensor = view.sensor((at_us as f32 - step_us as f32) * 1.0e-6);
            let bearing = sensor.heading_rad + ((first_deg + step_deg * beam as f64) as f32).to_radians();
            view.candidates(bearing, &mut candidates);
            let hit = view.cast(sensor, (bearing, LEVEL), &candidates, RANGE_MAX_M);
            self.echoes[beam] = hit.map(|hit| {
                let spread: f32 = (0..4).map(|_| self.random.uniform()).sum::<f32>() - 2.0;
                let range_m = hit.range_m + spread * NOISE_M * 1.732;
                Echo { range_m, is_reflector: hit.reflectivity > 100 }
            });
            self.next_beam = beam + 1;
        }
        self.scan = self.scan.wrapping_add(1);
        match self.device {
            ScannerDevice::MicroScan3(_) => self.message(now_us),
            ScannerDevice::Bridged(_) => self.bridged(now_us),
            _ => self.telegram(now_us),
        }
    }

    /// What the robot's computer has written.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64) {
        match &mut self.asked {
            Some((AskedScanner::Hokuyo(scanner), _)) => scanner.receive(bytes, now_us),
            Some((AskedScanner::Sick(scanner), _)) => scanner.receive(bytes, now_us),
            Some((AskedScanner::Rplidar(scanner), _)) => scanner.receive(bytes, now_us),
            None => {}
        }
    }

    fn telegram(&self, now_us: u64) -> Vec<(u64, Vec<u8>)> {
        let status = u16::from(self.state == ScannerState::LockOut);
        let header = TelegramHeader { version: 0x0103, status, scan: self.scan, telegram: self.scan as u16 };
        let word = |echo: &Option<Echo>| match (self.state, echo) {
            (ScannerState::StandBy | ScannerState::LockOut, _) => STAND_BY,
            (ScannerState::Measuring, None) => NO_ECHO,
            (ScannerState::Measuring, Some(echo)) => {
                let range_cm = (echo.range_m * 100.0 + 0.5).max(3.0) as u16;
                range_cm.min(NO_ECHO - 1) | if echo.is_reflector { 0x2000 } else { 0 }
            }
        };
        let words: Vec<u16> = self.echoes.iter().map(word).collect();
        let bytes = encode_telegram(header, &words);
        let mut sent = 0;
        let mut piece = |chunk: &[u8]| {
            sent += chunk.len() as u64;
            (now_us + PROCESSING_US + sent * BYTE_US, chunk.to_vec())
        };
        bytes.chunks(bytes.len().div_ceil(PIECES)).map(&mut piece).collect()
    }

    /// One that does not measure says so by nothing but beams without a return.
    fn bridged(&self, now_us: u64) -> Vec<(u64, Vec<u8>)> {
        let measures = self.state == ScannerState::Measuring;
        let range_m = |echo: &Option<Echo>| echo.filter(|_| measures).map(|echo| echo.range_m);
        let times = (self.scan, self.cycle_start_us, now_us);
        let sent = self.bridge.as_ref();
        sent.map(|bridge| bridge.send(times, self.beam_ns(), self.echoes.iter().map(range_m)))
            .unwrap_or_default()
    }

    fn message(&self, now_us: u64) -> Vec<(u64, Vec<u8>)> {
        let (_, step_deg) = self.angles_deg();
        let header = MessageHeader {
            number: self.scan,
            state: if self.state == ScannerState::StandBy { STANDS_BY } else { RUNS },
            errors: if self.state == ScannerState::LockOut { DEVICE_ERROR } else { 0 },
            // Straight ahead is 90° in the device's own frame.
            first_deg: -47.5,
            step_deg,
            scan_ms: (CYCLE_US / 1_000) as u16,
            beam_us: (self.beam_ns() / 1_000) as u32,
        };
        let words = |echo: &Option<Echo>| match echo {
            None => BeamWords { status: 0x02, ..BeamWords::default() },
            Some(echo) => BeamWords {
                distance_mm: (echo.range_m * 1_000.0 + 0.5).max(30.0) as u16,
                strength: if echo.is_reflector { 255 } else { 90 },
                status: if echo.is_reflector { 0x09 } else { 0x01 },
            },
        };
        let beams: Vec<BeamWords> = self.echoes.iter().map(words).collect();
        let datagrams = scan_datagrams(&encode_scan_message(&header, &beams), self.scan);
        let first_us = now_us + MESSAGE_US;
        (1..).zip(datagrams).map(|(index, bytes)| (first_us + index * DATAGRAM_US, bytes)).collect()
    }
}

/// What a scanner that must be asked has measured up to now. One that does not measure sees nothing: all its beams are errors.
fn measure_asked(
    scanner: &mut AskedScanner,
    state: ScannerState,
    view: &View<'_>,
    (now_us, step_us): (u64, u64),
) -> Vec<(u64, Vec<u8>)> {
    let mut candidates = Vec::new();
    let range_m = |at_us: f64, angle_rad: f64| {
        if state != ScannerState::Measuring {
            return None;
        }
        let sensor = view.sensor(((at_us - step_us as f64) * 1.0e-6) as f32);
        let bearing = sensor.heading_rad + angle_rad as f32;
        view.candidates(bearing, &mut candidates);
        view.cast(sensor, (bearing, LEVEL), &candidates, RANGE_MAX_M).map(|hit| hit.range_m)
    };
    match scanner {
        AskedScanner::Hokuyo(scanner) => scanner.measure(now_us, range_m),
        AskedScanner::Sick(scanner) => scanner.measure(now_us, range_m),
        AskedScanner::Rplidar(scanner) => scanner.measure(now_us, range_m),
    }
}
