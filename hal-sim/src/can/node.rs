//! What every CANopen device has: network state, heartbeat, SDO server and mapped process data (book, CANopen).
//!
//! The mapping that the master writes is honoured: nothing is sent or understood by default except the boot-up message.

use super::CanFrame;
use super::dictionary::Dictionary;

const OPERATIONAL: u8 = 5;
const PRE_OPERATIONAL: u8 = 0x7F;
const STOPPED: u8 = 4;

/// A device on the bus.
#[derive(Clone, Debug)]
pub struct Node {
    /// 1…127.
    pub id: u8,
    /// The objects.
    pub objects: Dictionary,
    state: u8,
    booted: bool,
    next_heartbeat_us: u64,
    next_event_us: [u64; 4],
    syncs: [u32; 4],
    /// When the watched master was last heard; the watch starts with the first message.
    master_heard_us: Option<u64>,
    /// The master's heartbeat stopped while watched.
    pub master_lost: bool,
    /// Received process data that were shorter than the mapping.
    pub short_pdos: u32,
}

impl Node {
    /// A device that has just been powered.
    #[must_use]
    pub fn new(id: u8, device_type: u32) -> Self {
        let mut objects = Dictionary::default();
        objects.define_read_only(0x1000, 0, 4, device_type);
        objects.define_read_only(0x1001, 0, 1, 0);
        objects.define_read_only(0x1018, 0, 1, 1);
        objects.define_read_only(0x1018, 1, 4, 0x0100_0056);
        objects.define(0x1016, 0, 1, 1);
        objects.define(0x1016, 1, 4, 0);
        objects.define(0x1017, 0, 2, 0);
        objects.define_read_only(0x1029, 0, 1, 1);
        objects.define(0x1029, 1, 1, 0);
        for pdo in 0..4_u16 {
            let disabled = 0x8000_0000;
            objects.define(0x1400 + pdo, 1, 4, disabled | (0x200 + 0x100 * u32::from(pdo) + u32::from(id)));
            objects.define(0x1400 + pdo, 2, 1, 255);
            objects.define(0x1800 + pdo, 1, 4, disabled | (0x180 + 0x100 * u32::from(pdo) + u32::from(id)));
            objects.define(0x1800 + pdo, 2, 1, 255);
            objects.define(0x1800 + pdo, 3, 2, 0);
            objects.define(0x1800 + pdo, 5, 2, 0);
            for sub in 0..=8 {
                let bytes = if sub == 0 { 1 } else { 4 };
                objects.define(0x1600 + pdo, sub, bytes, 0);
                objects.define(0x1A00 + pdo, sub, bytes, 0);
            }
        }
        Self {
            id,
            objects,
            state: PRE_OPERATIONAL,
            booted: false,
            next_heartbeat_us: 0,
            next_event_us: [0; 4],
            syncs: [0; 4],
            master_heard_us: None,
            master_lost: false,
            short_pdos: 0,
        }
    }

    /// Process data flow.
    #[must_use]
    pub const fn operational(&self) -> bool {
        self.state == OPERATIONAL
    }

    /// The master took it out of operation on purpose.
    #[must_use]
    pub const fn stopped(&self) -> bool {
        self.state == STOPPED
    }

    /// Takes a frame from the master; answers are appended. True when an object may have changed.
    pub fn receive(&mut self, frame: &CanFrame, now_us: u64, out: &mut Vec<CanFrame>) -> bool {
        let payload = frame.payload();
        if frame.extended {
            return false;
        }
        self.hear_master(frame.id, now_us);
        match frame.id {
            0x000 => self.network(payload, now_us, out),
            0x080 => self.synchronise(out),
            id if id == 0x600 + u32::from(self.id) => {
                let (answer, written) = self.objects.serve(&frame.data);
                out.push(CanFrame::new(0x580 + u32::from(self.id), &answer));
                return written;
            }
            id => return self.operational() && self.take_process_data(id, payload),
        }
        false
    }

    /// Heartbeats, timed process data, and the watch over the master.
    pub fn tick(&mut self, now_us: u64, out: &mut Vec<CanFrame>) {
        if !self.booted {
            self.booted = true;
            out.push(CanFrame::new(0x700 + u32::from(self.id), &[0]));
        }
        let period_us = u64::from(self.objects.get(0x1017, 0)) * 1_000;
        if period_us > 0 && now_us >= self.next_heartbeat_us {
            self.next_heartbeat_us = next_due(self.next_heartbeat_us, period_us, now_us);
            out.push(CanFrame::new(0x700 + u32::from(self.id), &[self.state]));
        }
        let watch_us = u64::from(self.objects.get(0x1016, 1) & 0xFFFF) * 1_000;
        if let Some(heard_us) = self.master_heard_us.filter(|_| watch_us > 0) {
            let was_lost = std::mem::replace(&mut self.master_lost, now_us > heard_us + watch_us);
            if self.master_lost && !was_lost && self.operational() {
                self.lose_master();
            }
        }
        if !self.operational() {
            return;
        }
        for pdo in 0..4 {
            let event_us = u64::from(self.objects.get(0x1800 + pdo as u16, 5)) * 1_000;
            if self.objects.get(0x1800 + pdo as u16, 2) >= 254
                && event_us > 0
                && now_us >= self.next_event_us[pdo]
            {
                self.next_event_us[pdo] = next_due(self.next_event_us[pdo], event_us, now_us);
                self.send_process_data(pdo as u16, out);
            }
        }
    }

    /// The reaction to a lost heartbeat that the error behaviour object names (CiA 301, object 1029h, sub-index 1).
    fn lose_master(&mut self) {
        match self.objects.get(0x1029, 1) {
            0 => self.state = PRE_OPERATIONAL,
            2 => self.state = STOPPED,
            _ => {}
        }
    }

    /// An emergency message (book, CANopen: Identifiers).
    pub fn emergency(&mut self, code: u16, register: u8, out: &mut Vec<CanFrame>) {
        self.objects.set(0x1001, 0, u32::from(register));
        let [low, high] = code.to_le_bytes();
        out.push(CanFrame::new(0x080 + u32::from(self.id), &[low, high, register, 0, 0, 0, 0, 0]));
    }

    fn hear_master(&mut self, id: u32, now_us: u64) {
        let watched = (self.objects.get(0x1016, 1) >> 16) & 0x7F;
        if watched != 0 && id == 0x700 + watched {
            self.master_heard_us = Some(now_us);
            self.master_lost = false;
        }
    }

    fn network(&mut self, payload: &[u8], now_us: u64, out: &mut Vec<CanFrame>) {
        let &[command, node] = payload else { return };
        if node != 0 && node != self.id {
            return;
        }
        match command {
            0x01 => {
                self.state = OPERATIONAL;
                self.next_event_us = [now_us; 4];
                // Event-driven process data are sent once on entering the state (book, CANopen: Process data).
                for pdo in 0..4 {
                    if self.objects.get(0x1800 + pdo, 2) >= 254 {
                        self.send_process_data(pdo, out);
                    }
                }
            }
            0x02 => self.state = STOPPED,
            0x80 => self.state = PRE_OPERATIONAL,
            0x81 | 0x82 => {
                self.state = PRE_OPERATIONAL;
                self.booted = false;
                self.master_heard_us = None;
                self.master_lost = false;
            }
            _ => {}
        }
    }

    fn synchronise(&mut self, out: &mut Vec<CanFrame>) {
        if !self.operational() {
            return;
        }
        for pdo in 0..4 {
            let every = self.objects.get(0x1800 + pdo as u16, 2);
            if !(1..=240).contains(&every) {
                continue;
            }
            self.syncs[pdo] += 1;
            if self.syncs[pdo] >= every {
                self.syncs[pdo] = 0;
                self.send_process_data(pdo as u16, out);
            }
        }
    }

    fn send_process_data(&self, pdo: u16, out: &mut Vec<CanFrame>) {
        let id = self.objects.get(0x1800 + pdo, 1);
        let count = self.objects.get(0x1A00 + pdo, 0).min(8) as u8;
        if id & 0x8000_0000 != 0 || count == 0 {
            return;
        }
        let mut payload = Vec::with_capacity(8);
        for sub in 1..=count {
            let mapping = self.objects.get(0x1A00 + pdo, sub);
            let value = self.objects.get((mapping >> 16) as u16, (mapping >> 8) as u8);
            let bytes = ((mapping & 0xFF) / 8).min(4) as usize;
            payload.extend(&value.to_le_bytes()[..bytes]);
        }
        out.push(CanFrame::new(id & 0x7FF, &payload));
    }

    fn take_process_data(&mut self, id: u32, payload: &[u8]) -> bool {
        for pdo in 0..4 {
            let identifier = self.objects.get(0x1400 + pdo, 1);
            if identifier & 0x8000_0000 == 0 && identifier & 0x7FF == id {
                return self.unpack(pdo, payload);
            }
        }
        false
    }

    fn unpack(&mut self, pdo: u16, payload: &[u8]) -> bool {
        let count = self.objects.get(0x1600 + pdo, 0).min(8) as u8;
        let mappings: Vec<u32> = (1..=count).map(|sub| self.objects.get(0x1600 + pdo, sub)).collect();
        let needed: usize = mappings.iter().map(|mapping| ((mapping & 0xFF) / 8) as usize).sum();
        if payload.len() < needed {
            self.short_pdos += 1;
            return false;
        }
        let mut at = 0;
        for mapping in mappings {
            let bytes = ((mapping & 0xFF) / 8) as usize;
            let mut raw = [0; 4];
            for (cell, byte) in raw.iter_mut().zip(&payload[at..at + bytes]) {
                *cell = *byte;
            }
            at += bytes;
            self.objects.set((mapping >> 16) as u16, (mapping >> 8) as u8, u32::from_le_bytes(raw));
        }
        true
    }
}

/// The next multiple of a period, without a burst after a pause.
fn next_due(previous_us: u64, period_us: u64, now_us: u64) -> u64 {
    let next = previous_us + period_us;
    if next > now_us { next } else { now_us + period_us }
}
