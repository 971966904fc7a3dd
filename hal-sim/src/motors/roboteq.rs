//! A Roboteq with two channels in closed-loop speed: it echoes each command, answers it, and stops when no command comes in time.

use super::bank::Turning;
use super::text::Lines;

/// How fast it changes a motor's speed, turns/s².
const RAMP_TURNS_PER_S2: f32 = 40.0;
/// Fault flags.
const UNDER_VOLTAGE: u32 = 4;
const EMERGENCY_STOP: u32 = 16;

#[derive(Clone, Debug)]
pub(super) struct RoboteqController {
    lines: Lines,
    rpm: [i32; 2],
    demands: [f32; 2],
    faults: u32,
    watchdog_ms: u64,
    fed_us: u64,
    measured: [Turning; 2],
    ticked_us: u64,
}

impl Default for RoboteqController {
    fn default() -> Self {
        Self {
            lines: Lines::default(),
            rpm: [0; 2],
            demands: [0.0; 2],
            faults: 0,
            // As it leaves the factory.
            watchdog_ms: 1_000,
            fed_us: 0,
            measured: [Turning::default(); 2],
            ticked_us: 0,
        }
    }
}

impl RoboteqController {
    /// Takes bytes of the line; gives those that it sends.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64) -> Vec<u8> {
        let lines = self.lines.push(bytes);
        let answers = lines.iter().map(|line| format!("{line}\r{}\r", self.answer(line, now_us)));
        answers.collect::<String>().into_bytes()
    }

    fn answer(&mut self, line: &str, now_us: u64) -> String {
        let mut words = line.split_ascii_whitespace();
        let command = words.next().unwrap_or_default();
        let numbers: Vec<i64> = words.filter_map(|word| word.parse().ok()).collect();
        if command.starts_with('!') {
            self.fed_us = now_us;
        }
        let [left, right] = self.measured;
        match (command, numbers.as_slice()) {
            ("!S", [channel @ 1..=2, rpm]) => self.rpm[*channel as usize - 1] = *rpm as i32,
            ("!EX", []) => (self.faults, self.rpm) = (self.faults | EMERGENCY_STOP, [0; 2]),
            ("!MG", []) => self.faults &= !EMERGENCY_STOP,
            ("^RWD", [ms]) => self.watchdog_ms = *ms as u64,
            ("~RWD", []) => return format!("RWD={}", self.watchdog_ms),
            ("?S", []) => {
                let rpm = [left, right].map(|turning| (turning.turns_per_s * 60.0).round() as i32);
                return format!("S={}:{}", rpm[0], rpm[1]);
            }
            ("?C", []) => return format!("C={}:{}", left.counts as i32, right.counts as i32),
            ("?FF", []) => return format!("FF={}", self.faults),
            _ => return "-".to_owned(),
        }
        "+".to_owned()
    }

    pub const fn cut_power(&mut self) {
        self.faults |= UNDER_VOLTAGE;
        self.rpm = [0; 2];
    }

    pub fn tick(&mut self, (now_us, step_s): (u64, f32), turning: [Turning; 4]) {
        self.measured = [turning[0], turning[1]];
        if self.watchdog_ms > 0 && now_us > self.fed_us + self.watchdog_ms * 1_000 {
            self.rpm = [0; 2];
        }
        for (demand, rpm) in self.demands.iter_mut().zip(self.rpm) {
            let step = RAMP_TURNS_PER_S2 * step_s;
            *demand += (rpm as f32 / 60.0 - *demand).clamp(-step, step);
        }
        if self.faults != 0 {
            self.demands = [0.0; 2];
        }
        self.ticked_us = now_us;
    }

    pub fn demands_turns_per_s(&self) -> [Option<f32>; 2] {
        self.demands.map(|demand| (self.faults == 0).then_some(demand))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_and_stops_after_silence() {
        let mut controller = RoboteqController::default();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        assert_eq!(text(controller.receive(b"^RWD 200\r~RW", 0)), "^RWD 200\r+\r");
        assert_eq!(text(controller.receive(b"D\r!S 2 -120\r", 0)), "~RWD\rRWD=200\r!S 2 -120\r+\r");
        controller.tick((100_000, 1.0), [Turning::default(); 4]);
        assert_eq!(controller.demands_turns_per_s(), [Some(0.0), Some(-2.0)]);
        controller.tick((201_000, 1.0), [Turning::default(); 4]);
        assert_eq!(controller.demands_turns_per_s(), [Some(0.0); 2]);
        assert_eq!(text(controller.receive(b"!EX\r?FF\r?X\r", 0)), "!EX\r+\r?FF\rFF=16\r?X\r-\r");
        assert_eq!(controller.demands_turns_per_s(), [None; 2]);
    }
}
