//! A Hokuyo sensor: answers commands, and sends scans.

use floorguard_types::random::Pcg32;

use crate::wire::{scip_line, scip_number, scip_reply, scip_scan};

/// From the end of a scan to the arrival of its last byte, microseconds: USB or TCP.
const SEND_US: u64 = 3_000;
/// From a command to its answer, microseconds.
const ANSWER_US: u64 = 1_000;

/// Which sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LidarModel {
    /// URG-04LX on a serial line: 1,024 steps a turn, ten turns a second, 5.6 m.
    Urg04lx,
    /// UST-10LX on TCP: 1,440 steps a turn, forty turns a second, 10 m here.
    Ust10lx,
}

impl LidarModel {
    /// Steps of a turn, first, last and front step, turns a minute, farthest distance in millimetres.
    const fn numbers(self) -> [u32; 6] {
        match self {
            Self::Urg04lx => [1_024, 44, 725, 384, 600, 5_600],
            Self::Ust10lx => [1_440, 0, 1_080, 540, 2_400, 30_000],
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Urg04lx => "URG-04LX(Hokuyo Automatic Co.,Ltd.)",
            Self::Ust10lx => "UST-10LX",
        }
    }

    /// Angle of a step from the front, radians, counter-clockwise.
    #[must_use]
    pub fn angle_rad(self, step: u32) -> f64 {
        let [turn, _, _, front, ..] = self.numbers();
        (f64::from(step) - f64::from(front)) * std::f64::consts::TAU / f64::from(turn)
    }

    /// Microseconds of a turn.
    #[must_use]
    pub fn turn_us(self) -> u64 {
        60_000_000 / u64::from(self.numbers()[4])
    }

    /// When a step is passed after step 0, microseconds.
    #[must_use]
    pub fn step_us(self, step: u32) -> f64 {
        self.turn_us() as f64 * f64::from(step) / f64::from(self.numbers()[0])
    }
}

/// What it is sending.
#[derive(Clone, Debug)]
struct Sending {
    /// Of the command without the number of scans.
    echo: String,
    first: u32,
    last: u32,
    cluster: u32,
    characters: u32,
    /// Scans that are left; `None` without end.
    left: Option<u32>,
}

/// The sensor.
#[derive(Clone, Debug)]
pub struct ScanLidar {
    model: LidarModel,
    /// The sensor's counter is so much ahead of the world, microseconds.
    counter_us: u64,
    line: Vec<u8>,
    sending: Option<Sending>,
    tells_time: bool,
    /// Turns since the start; step 0 of the present one.
    turn: u64,
    next_step: u32,
    values: Vec<u32>,
    random: Pcg32,
    answers: Vec<(u64, Vec<u8>)>,
}

impl ScanLidar {
    /// A sensor that is switched on at time 0.
    #[must_use]
    pub fn new(model: LidarModel, seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 21);
        let counter_us = u64::from(random.below(1 << 24)) * 1_000;
        let (line, values, answers) = (Vec::new(), Vec::new(), Vec::new());
        Self {
            model,
            counter_us,
            line,
            sending: None,
            tells_time: false,
            turn: 0,
            next_step: 0,
            values,
            random,
            answers,
        }
    }

    /// Which sensor.
    #[must_use]
    pub const fn model(&self) -> LidarModel {
        self.model
    }

    fn counter_ms(&self, at_us: u64) -> u32 {
        ((self.counter_us + at_us) / 1_000 % (1 << 24)) as u32
    }

    /// Bytes of the host.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64) {
        for byte in bytes {
            if *byte != b'\n' {
                self.line.push(*byte);
                continue;
            }
            let command = String::from_utf8_lossy(&std::mem::take(&mut self.line)).into_owned();
            let answer = self.answer(&command, now_us + ANSWER_US / 2);
            self.answers.push((now_us + ANSWER_US, answer));
        }
    }

    fn answer(&mut self, command: &str, at_us: u64) -> Vec<u8> {
        let status = match command {
            "QT" | "RS" => {
                self.sending = None;
                "00"
            }
            "BM" => "00",
            "TM0" => {
                self.sending = None;
                if std::mem::replace(&mut self.tells_time, true) { "02" } else { "00" }
            }
            "TM1" if self.tells_time => {
                let time = scip_line(&scip_number(self.counter_ms(at_us), 4), "");
                return scip_reply(command, "00", &[time]);
            }
            "TM1" => "04",
            "TM2" => {
                if std::mem::replace(&mut self.tells_time, false) {
                    "00"
                } else {
                    "03"
                }
            }
            "PP" => return scip_reply(command, "00", &self.parameters()),
            _ if command.starts_with("MD") || command.starts_with("MS") => match self.begin(command) {
                Some(sending) => {
                    self.sending = Some(sending);
                    "00"
                }
                None => "04",
            },
            _ => "0E",
        };
        scip_reply(command, status, &[])
    }

    fn parameters(&self) -> Vec<String> {
        let [turn, first, last, front, speed, farthest] = self.model.numbers();
        let lines = [
            format!("MODL:{}", self.model.name()),
            "DMIN:20".to_owned(),
            format!("DMAX:{farthest}"),
            format!("ARES:{turn}"),
            format!("AMIN:{first}"),
            format!("AMAX:{last}"),
            format!("AFRT:{front}"),
            format!("SCAN:{speed}"),
        ];
        lines.iter().map(|content| scip_line(content, ";")).collect()
    }

    fn begin(&self, command: &str) -> Option<Sending> {
        let number = |range: std::ops::Range<usize>| command.get(range)?.parse::<u32>().ok();
        let (first, last, cluster) = (number(2..6)?, number(6..10)?, number(10..12)?.max(1));
        let count = number(13..15)?;
        let characters = if command.starts_with("MS") { 2 } else { 3 };
        let is_possible = first <= last && last <= self.model.numbers()[2];
        let echo = command.get(..13)?.to_owned();
        let left = (count > 0).then_some(count);
        is_possible.then_some(Sending { echo, first, last, cluster, characters, left })
    }

    /// Measures steps up to a time: `range_m` gives the distance at a time in microseconds and an angle from the front in radians,
    /// noise not included. Returns what arrives at the host, each with its time.
    pub fn measure(
        &mut self,
        now_us: u64,
        mut range_m: impl FnMut(f64, f64) -> Option<f32>,
    ) -> Vec<(u64, Vec<u8>)> {
        let mut arrives = std::mem::take(&mut self.answers);
        loop {
            let begin_us = self.turn * self.model.turn_us();
            let at_us = begin_us as f64 + self.model.step_us(self.next_step);
            if at_us > now_us as f64 {
                return arrives;
            }
            let Some(sending) = self.sending.clone().filter(|_| !self.tells_time) else {
                self.next_turn(now_us);
                return arrives;
            };
            if (sending.first..=sending.last).contains(&self.next_step) {
                let measured = range_m(at_us, self.model.angle_rad(self.next_step));
                let value = self.value(measured);
                self.values.push(value);
            }
            if self.next_step < sending.last {
                self.next_step += 1;
                continue;
            }
            if self.values.len() as u32 == sending.last - sending.first + 1 {
                let bytes = self.reply(&sending, begin_us);
                arrives.push((at_us as u64 + SEND_US, bytes));
            }
            self.turn += 1;
            self.next_step = 0;
            self.values.clear();
        }
    }

    /// It does not measure: the mirror turns on.
    fn next_turn(&mut self, now_us: u64) {
        self.turn = now_us / self.model.turn_us() + 1;
        self.next_step = 0;
        self.values.clear();
    }

    /// Millimetres with noise: one centimetre up to one metre, one part in a hundred beyond; an error code without a return.
    fn value(&mut self, range_m: Option<f32>) -> u32 {
        let [.., farthest_mm] = self.model.numbers();
        let Some(range_m) = range_m else {
            return if self.model == LidarModel::Urg04lx { 1 } else { 65_533 };
        };
        let sum: f32 = (0..12).map(|_| self.random.uniform()).sum();
        let noisy_m = range_m + (sum - 6.0) * 0.01 * range_m.max(1.0);
        let millimetres = (noisy_m * 1_000.0).round().max(0.0) as u32;
        if (20..=farthest_mm).contains(&millimetres) { millimetres } else { 0 }
    }

    fn reply(&mut self, sending: &Sending, begin_us: u64) -> Vec<u8> {
        let left = sending.left.map(|left| left - 1);
        // The nearest of a cluster that is no error code.
        let nearest = |steps: &[u32]| {
            steps
                .iter()
                .copied()
                .filter(|value| *value >= 20)
                .min()
                .unwrap_or(steps.first().copied().unwrap_or(0))
        };
        let values: Vec<u32> = self.values.chunks(sending.cluster as usize).map(nearest).collect();
        let echo = format!("{}{:02}", sending.echo, left.unwrap_or(0));
        self.sending = (left != Some(0)).then(|| Sending { left, ..sending.clone() });
        scip_scan(&echo, "99", (self.counter_ms(begin_us), &values), sending.characters)
    }
}
