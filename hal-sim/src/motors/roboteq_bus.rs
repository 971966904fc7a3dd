//! A Roboteq of one or two channels in closed-loop speed on CANopen. No object is its watchdog: a script in it shows the setting in a user
//! variable. Any command wakes the speeds from before the watchdog acted.

use super::bank::Turning;
use crate::can::{CanFrame, Node};

/// How fast it changes a motor's speed, turns/s².
const RAMP_TURNS_PER_S2: f32 = 40.0;
/// Fault flags.
const UNDER_VOLTAGE: u32 = 0x04;
const EMERGENCY_STOP: u32 = 0x10;
/// Status flags: commands by line or bus; a script runs.
const SERIAL_MODE: u32 = 0x01;
const SCRIPT_RUNS: u32 = 0x80;
/// The script looks so often.
const SCRIPT_US: u64 = 50_000;
/// Value out of range.
const ABORT_RANGE: u32 = 0x0609_0030;

#[derive(Clone, Debug)]
pub(super) struct RoboteqBusController {
    node: Node,
    channels: u8,
    demands: Vec<f32>,
    faults: u32,
    /// RWD, milliseconds; 0: never.
    watchdog_ms: u32,
    /// The script is loaded.
    has_script: bool,
    fed_us: u64,
    is_silent: bool,
    next_script_us: u64,
}

impl RoboteqBusController {
    /// As its maker's tool has set it: its watchdog, and the script where the watchdog is on.
    pub fn new(id: u8, channels: u8, watchdog_ms: u32) -> Self {
        let mut node = Node::new(id, 0x0002_0192);
        let objects = &mut node.objects;
        objects.set(0x1017, 0, 100);
        for channel in 1..=channels {
            objects.define(0x2000, channel, 4, 0);
            objects.define(0x2002, channel, 4, 0);
            objects.define_read_only(0x2103, channel, 4, 0);
            objects.define_read_only(0x2104, channel, 4, 0);
        }
        for variable in 1..=16 {
            objects.define(0x2005, variable, 4, 0);
            objects.define_read_only(0x2106, variable, 4, 0);
        }
        for command in [0x200C, 0x200D] {
            objects.define(command, 0, 1, 0);
        }
        objects.define_read_only(0x2111, 0, 2, SERIAL_MODE | SCRIPT_RUNS);
        objects.define_read_only(0x2112, 0, 2, 0);
        // The maker's file: all four are on, of the device and not to be requested.
        for pdo in 0..4_u16 {
            objects.set(0x1800 + pdo, 1, 0x4000_0180 + 0x100 * u32::from(pdo) + u32::from(id));
        }
        Self {
            node,
            channels,
            demands: vec![0.0; usize::from(channels)],
            faults: 0,
            watchdog_ms,
            has_script: watchdog_ms > 0,
            fed_us: 0,
            is_silent: true,
            next_script_us: 0,
        }
    }

    pub const fn id(&self) -> u8 {
        self.node.id
    }

    pub fn receive(&mut self, frame: &CanFrame, now_us: u64, out: &mut Vec<CanFrame>) {
        if let Some(refusal) = self.refuse(frame) {
            out.push(refusal);
            return;
        }
        if !self.node.receive(frame, now_us, out) {
            return;
        }
        for (index, sub) in self.written(frame) {
            self.obey(index, sub, now_us);
        }
    }

    /// An identifier of process data of the device must say that they are not to be requested.
    fn refuse(&self, frame: &CanFrame) -> Option<CanFrame> {
        let [command, low, high, sub, _, _, _, top] = frame.data;
        let index = u16::from_le_bytes([low, high]);
        let is_identifier = command == 0x23 && (0x1800..0x1804).contains(&index) && sub == 1;
        let is_wrong = !frame.extended
            && frame.id == 0x600 + u32::from(self.node.id)
            && is_identifier
            && top & 0x40 == 0;
        let [a, b, c, d] = ABORT_RANGE.to_le_bytes();
        is_wrong.then(|| CanFrame::new(0x580 + u32::from(self.node.id), &[0x80, low, high, sub, a, b, c, d]))
    }

    /// Which objects a frame has written.
    fn written(&self, frame: &CanFrame) -> Vec<(u16, u8)> {
        if frame.id == 0x600 + u32::from(self.node.id) {
            return vec![(u16::from_le_bytes([frame.data[1], frame.data[2]]), frame.data[3])];
        }
        let pdo = ((frame.id >> 8) as u16).wrapping_sub(2) & 3;
        let count = self.node.objects.get(0x1600 + pdo, 0) as u8;
        let mapped = (1..=count.min(8)).map(|sub| self.node.objects.get(0x1600 + pdo, sub));
        mapped.map(|object| ((object >> 16) as u16, (object >> 8) as u8)).collect()
    }

    fn obey(&mut self, index: u16, sub: u8, now_us: u64) {
        if !(0x2000..0x2100).contains(&index) {
            return;
        }
        // Every command feeds the watchdog.
        (self.fed_us, self.is_silent) = (now_us, false);
        match index {
            0x2005 => {
                let value = self.node.objects.get(0x2005, sub);
                self.node.objects.set(0x2106, sub, value);
            }
            0x200C => self.faults |= EMERGENCY_STOP,
            0x200D => self.faults &= !EMERGENCY_STOP,
            _ => {}
        }
    }

    pub const fn cut_power(&mut self) {
        self.faults |= UNDER_VOLTAGE;
    }

    /// A step; its motors turn so.
    pub fn tick(&mut self, (now_us, step_s): (u64, f32), turning: &[Turning], out: &mut Vec<CanFrame>) {
        if self.watchdog_ms > 0 && now_us > self.fed_us + u64::from(self.watchdog_ms) * 1_000 {
            self.is_silent = true;
        }
        if self.has_script && now_us >= self.next_script_us {
            self.next_script_us = now_us + SCRIPT_US;
            // It commands only where the variable differs: a command feeds the watchdog.
            if self.node.objects.get(0x2106, 1) != self.watchdog_ms {
                self.node.objects.set(0x2106, 1, self.watchdog_ms);
                (self.fed_us, self.is_silent) = (now_us, false);
            }
        }
        for channel in 0..self.channels {
            let at = usize::from(channel);
            let objects = &mut self.node.objects;
            let rpm = if self.is_silent { 0 } else { objects.get(0x2002, channel + 1) as i32 };
            let step = RAMP_TURNS_PER_S2 * step_s;
            self.demands[at] += (rpm as f32 / 60.0 - self.demands[at]).clamp(-step, step);
            if self.faults != 0 {
                self.demands[at] = 0.0;
            }
            let measured = turning.get(at).copied().unwrap_or_default();
            objects.set(0x2103, channel + 1, (measured.turns_per_s * 60.0).round() as i32 as u32);
            objects.set(0x2104, channel + 1, measured.counts as u32);
        }
        self.node.objects.set(0x2112, 0, self.faults);
        self.node.objects.set(
            0x2111,
            0,
            if self.has_script { SERIAL_MODE | SCRIPT_RUNS } else { SERIAL_MODE },
        );
        self.node.tick(now_us, out);
    }

    /// What a channel demands, turns a second; none without power.
    pub fn demand_turns_per_s(&self, channel: usize) -> Option<f32> {
        self.demands.get(channel).copied().filter(|_| self.faults == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the Python package `canopen` with the maker's file, node 12: −120 and 2500 turns a minute.
    const SPEEDS: [u8; 8] = [0x88, 0xFF, 0xFF, 0xFF, 0xC4, 0x09, 0, 0];
    const MAPPING: [[u8; 8]; 4] = [
        [0x23, 0, 0x16, 1, 0x20, 0x01, 0x02, 0x20],
        [0x23, 0, 0x16, 2, 0x20, 0x02, 0x02, 0x20],
        [0x2F, 0, 0x16, 0, 2, 0, 0, 0],
        [0x23, 0, 0x14, 1, 0x0C, 0x02, 0, 0],
    ];

    fn controller(watchdog_ms: u32) -> RoboteqBusController {
        let mut controller = RoboteqBusController::new(12, 2, watchdog_ms);
        let mut out = Vec::new();
        for request in MAPPING {
            controller.receive(&CanFrame::new(0x60C, &request), 0, &mut out);
        }
        assert!(out.iter().all(|answer| answer.id == 0x58C && answer.data[0] == 0x60), "{out:?}");
        controller.receive(&CanFrame::new(0x000, &[1, 12]), 0, &mut out);
        // Its script has shown the watchdog.
        let _ = demands(&mut controller, 1_000);
        controller
    }

    fn demands(controller: &mut RoboteqBusController, now_us: u64) -> Vec<Option<f32>> {
        controller.tick((now_us, 10.0), &[Turning::default(); 2], &mut Vec::new());
        (0..2).map(|channel| controller.demand_turns_per_s(channel)).collect()
    }

    #[test]
    fn silence_stops_and_any_command_wakes() {
        let mut controller = controller(200);
        controller.receive(&CanFrame::new(0x20C, &SPEEDS), 10_000, &mut Vec::new());
        let driving = [Some(-2.0), Some(2_500.0 / 60.0)];
        assert_eq!(demands(&mut controller, 210_000), driving);
        assert_eq!(demands(&mut controller, 211_000), [Some(0.0); 2]);
        // The manual, RWD: it resumes the speeds from before.
        controller.receive(
            &CanFrame::new(0x60C, &[0x2F, 0x0D, 0x20, 0, 1, 0, 0, 0]),
            300_000,
            &mut Vec::new(),
        );
        assert_eq!(demands(&mut controller, 301_000), driving);
    }

    /// Roboteq, "CANBus Networking Manual" V2.0, SDO Example 2, with the bits of CiA 301.
    #[test]
    fn emergency_stop_takes_power() {
        let mut controller = controller(200);
        let mut out = Vec::new();
        controller.receive(&CanFrame::new(0x60C, &[0x2F, 0x0C, 0x20, 0, 1, 0, 0, 0]), 10_000, &mut out);
        assert_eq!(out, [CanFrame::new(0x58C, &[0x60, 0x0C, 0x20, 0, 0, 0, 0, 0])]);
        assert_eq!(demands(&mut controller, 11_000), [None; 2]);
        assert_eq!(controller.node.objects.get(0x2112, 0), EMERGENCY_STOP);
    }

    #[test]
    fn script_shows_the_watchdog_again() {
        let mut controller = controller(150);
        assert_eq!(demands(&mut controller, 60_000), [Some(0.0); 2]);
        assert_eq!(controller.node.objects.get(0x2106, 1), 150);
        controller.receive(
            &CanFrame::new(0x60C, &[0x23, 0x05, 0x20, 1, 0, 0, 0, 0]),
            70_000,
            &mut Vec::new(),
        );
        assert_eq!(controller.node.objects.get(0x2106, 1), 0);
        let _ = demands(&mut controller, 130_000);
        assert_eq!(controller.node.objects.get(0x2106, 1), 150);
        let mut without = RoboteqBusController::new(12, 2, 0);
        let _ = demands(&mut without, 60_000);
        assert_eq!((without.node.objects.get(0x2106, 1), without.node.objects.get(0x2111, 0)), (0, 1));
    }

    #[test]
    fn identifiers_that_may_be_requested_are_refused() {
        let mut controller = controller(200);
        let mut out = Vec::new();
        controller.receive(&CanFrame::new(0x60C, &[0x23, 0, 0x18, 1, 0x8C, 0x01, 0, 0x80]), 0, &mut out);
        assert_eq!(out, [CanFrame::new(0x58C, &[0x80, 0, 0x18, 1, 0x30, 0, 0x09, 0x06])]);
    }
}
