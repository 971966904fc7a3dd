//! A controller on the wheel line, as its maker would build it from the book alone.

use super::bank::Turning;
use super::text::Lines;

/// How fast it changes a speed, m/s².
const RAMP_MPS2: f32 = 3.0;
const REPORT_US: u64 = 20_000;

/// CRC-16 of the polynomial 1021h that begins with FFFFh, bit by bit.
fn checksum(text: &str) -> u16 {
    text.bytes().fold(0xFFFF, |sum, byte| {
        (0..8).fold(
            sum ^ u16::from(byte) << 8,
            |sum, _| {
                if sum & 0x8000 == 0 { sum << 1 } else { sum << 1 ^ 0x1021 }
            },
        )
    })
}

#[derive(Clone, Debug)]
pub(super) struct WheelController {
    lines: Lines,
    /// Sequence of the newest request.
    newest: Option<u32>,
    ends_us: u64,
    follows: bool,
    targets_mps: Vec<f32>,
    demands_mps: Vec<f32>,
    reports: u32,
    next_us: u64,
    is_cut: bool,
}

impl WheelController {
    pub fn new(wheels: usize) -> Self {
        Self {
            lines: Lines::default(),
            newest: None,
            ends_us: 0,
            follows: false,
            targets_mps: vec![0.0; wheels],
            demands_mps: vec![0.0; wheels],
            reports: 0,
            next_us: 0,
            is_cut: false,
        }
    }

    pub fn receive(&mut self, bytes: &[u8], now_us: u64) {
        for line in self.lines.push(bytes) {
            let _ = self.take(&line, now_us);
        }
    }

    fn take(&mut self, line: &str, now_us: u64) -> Option<()> {
        let (text, sum) = line.split_once('*')?;
        if sum != format!("{:04X}", checksum(text)) {
            return None;
        }
        let mut words = text.strip_prefix("W ")?.split(' ').map(str::parse::<i64>);
        let mut word = || words.next()?.ok();
        let (sequence, deadline_ms, follow) = (word()? as u32, word()? as u64, word()?);
        let speeds: Vec<f32> = std::iter::from_fn(word).map(|mmps| mmps as f32 * 1.0e-3).collect();
        let is_newer = self.newest.is_none_or(|newest| (1..1 << 31).contains(&sequence.wrapping_sub(newest)));
        if !is_newer || speeds.len() != self.targets_mps.len() {
            return None;
        }
        (self.newest, self.follows, self.targets_mps) = (Some(sequence), follow == 1, speeds);
        self.ends_us = now_us + deadline_ms * 1_000;
        Some(())
    }

    pub const fn cut_power(&mut self) {
        self.is_cut = true;
    }

    pub fn demands_mps(&self) -> Vec<Option<f32>> {
        let is_on = self.follows && !self.is_cut;
        self.demands_mps.iter().map(|demand| is_on.then_some(*demand)).collect()
    }

    /// A step; gives the bytes of a report when it is time.
    pub fn tick(&mut self, (now_us, step_s): (u64, f32), turning: [Turning; 4]) -> Vec<u8> {
        let is_in_time = now_us < self.ends_us;
        for (demand, target) in self.demands_mps.iter_mut().zip(&self.targets_mps) {
            let target = if is_in_time && self.follows { *target } else { 0.0 };
            *demand += (target - *demand).clamp(-RAMP_MPS2 * step_s, RAMP_MPS2 * step_s);
            if !self.follows {
                *demand = 0.0;
            }
        }
        if now_us < self.next_us {
            return Vec::new();
        }
        self.next_us += REPORT_US;
        self.reports = self.reports.wrapping_add(1);
        let state = match (self.is_cut, self.follows, is_in_time) {
            (true, ..) => 3,
            (false, false, _) => 0,
            (false, true, true) => 1,
            (false, true, false) => 2,
        };
        let mut text = format!("M {} {} 0 {state}", self.reports, self.newest.unwrap_or(0));
        for turning in turning.iter().take(self.targets_mps.len()) {
            text += &format!(" {} {}", (turning.turns_per_s * 1_000.0).round() as i32, turning.counts as i32);
        }
        let sum = checksum(&text);
        format!("{text}*{sum:04X}\n").into_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines that `examples/wheel_line.py vectors` prints.
    #[test]
    fn takes_the_line_of_the_reference() {
        let mut controller = WheelController::new(2);
        controller.receive(b"W 7 100 1 250 -250*3AF2\n", 0);
        let still = [Turning::default(); 4];
        let _ = controller.tick((50_000, 1.0), still);
        assert_eq!(controller.demands_mps(), [Some(0.25), Some(-0.25)]);
        // The same again is not newer, and a damaged one is none.
        controller.receive(b"W 7 100 1 250 -250*3AF2\nW 8 100 1 250 -250*3AF2\n", 90_000);
        let sent = controller.tick((100_000, 1.0), still);
        assert_eq!(controller.demands_mps(), [Some(0.0), Some(0.0)]);
        assert!(String::from_utf8(sent).unwrap().starts_with("M 2 7 0 2 0 0 0 0*"));
    }
}
