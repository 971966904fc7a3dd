//! Instructions, counted with the dual timer: exact under `-icount`.

use crate::register::Register;

const BASE: usize = 0x4000_2000;
const LOAD: Register = Register::at(BASE);
const VALUE: Register = Register::at(BASE + 0x04);
const CONTROL: Register = Register::at(BASE + 0x08);
/// Enable, 32 bits, no interrupt.
const ENABLE: u32 = 1 << 7 | 1 << 1;
/// A tick of 25 MHz takes 40 ns; under `-icount shift=S` an instruction takes 2^S ns.
const TICK_NS: u64 = 40;

/// Starts the counter. Call once.
pub fn start() {
    LOAD.write(u32::MAX);
    CONTROL.write(ENABLE);
}

/// Adds up the time of one kind of work.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stopwatch {
    begun: u32,
    last_ticks: u32,
    total_ticks: u64,
    largest_ticks: u32,
    count: u32,
}

impl Stopwatch {
    /// Work begins.
    pub fn begin(&mut self) {
        self.begun = VALUE.read();
    }

    /// Work ends.
    pub fn end(&mut self) {
        // The counter runs down and wraps every 171 s, far longer than any piece of work.
        self.last_ticks = self.begun.wrapping_sub(VALUE.read());
        self.enter(self.last_ticks);
    }

    /// Enters what another one measured last.
    pub fn add(&mut self, other: &Self) {
        self.enter(other.last_ticks);
    }

    fn enter(&mut self, ticks: u32) {
        self.total_ticks += u64::from(ticks);
        self.largest_ticks = self.largest_ticks.max(ticks);
        self.count += 1;
    }

    /// Times measured, and instructions on the mean and at most, when an instruction takes 2^shift ns.
    pub fn instructions(&self, shift: u32) -> (u32, u64, u64) {
        let instructions = |ticks: u64| (ticks * TICK_NS) >> shift;
        let mean = instructions(self.total_ticks) / u64::from(self.count.max(1));
        (self.count, mean, instructions(u64::from(self.largest_ticks)))
    }
}
