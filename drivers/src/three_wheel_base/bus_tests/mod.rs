//! What each device tells reaches the robot once, and what it may not tell does not.

mod lost_devices;
mod reports;

use std::vec::Vec;

use floorguard_types::sensing::{DirtReading, DriveState};
use floorguard_types::time::Stamp;

use super::*;
use crate::can::CanFrame;
use crate::canopen::Emergency;

/// A bus on which every device answers what it is asked.
struct Bus {
    base: ThreeWheelBase,
    now_ms: u64,
    /// Devices that are gone.
    silent: Vec<u8>,
}

impl Bus {
    fn running() -> Self {
        Self::with(BaseConfiguration::default())
    }

    fn with(configuration: BaseConfiguration) -> Self {
        let mut bus = Self { base: ThreeWheelBase::new(configuration), now_ms: 1_000, silent: Vec::new() };
        (0..80).for_each(|_| _ = bus.poll());
        assert!(bus.base.is_complete());
        bus
    }

    fn now(&self) -> Stamp {
        Stamp::from_micros(self.now_ms * 1_000)
    }

    fn hear(&mut self, id: u16, payload: &[u8]) -> Vec<BaseEvent> {
        let (mut events, now) = (Vec::new(), self.now());
        self.base.on_frame(&CanFrame::standard(id, payload), now, &mut |event| events.push(event));
        events
    }

    /// Ten milliseconds: what the master sent, and what it reported; then the devices answer.
    fn poll(&mut self) -> (Vec<CanFrame>, Vec<BaseEvent>) {
        self.now_ms += 10;
        let (mut sent, mut events) = (Vec::new(), Vec::new());
        self.base.poll(self.now(), &mut |event| events.push(event), &mut |frame| sent.push(*frame));
        for node in 1..=5 {
            if self.base.devices()[usize::from(node) - 1].is_operational()
                && !self.silent.contains(&(node as u8))
            {
                self.hear(0x700 + node, &[5]);
            }
        }
        let gone = self.silent.clone();
        for frame in &sent {
            match (frame.standard_id().unwrap(), frame.payload()) {
                (0x000, [_, node]) if gone.contains(node) => {}
                (id @ 0x601..=0x67F, _) if gone.contains(&((id & 0x7F) as u8)) => {}
                (0x000, [1, node]) => _ = self.hear(0x700 + u16::from(*node), &[5]),
                (id @ 0x601..=0x67F, [command, low, high, sub, ..]) => {
                    let done = if *command == 0x40 { 0x43 } else { 0x60 };
                    self.hear(id - 0x80, &[done, *low, *high, *sub, 0, 0, 0, 1]);
                }
                _ => {}
            }
        }
        (sent, events)
    }

    /// Both drives report this state; the report is complete with the second one.
    fn drives(&mut self, status: u16, speed: i32, angle: i32) -> Vec<BaseEvent> {
        let report = |value: i32| {
            let ([low, high], [a, b, c, d]) = (status.to_le_bytes(), value.to_le_bytes());
            [low, high, a, b, c, d]
        };
        assert_eq!(self.hear(0x182, &report(angle)), []);
        self.hear(0x181, &report(speed))
    }

    fn words(&self) -> Vec<(u16, u16)> {
        let mut sent = Vec::new();
        self.base.send_command(&mut |frame| sent.push(*frame));
        let word = |frame: &CanFrame| u16::from_le_bytes([frame.payload()[0], frame.payload()[1]]);
        sent.iter().map(|frame| (frame.standard_id().unwrap(), word(frame))).collect()
    }
}
