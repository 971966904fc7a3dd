//! Instructions, counted with the board's dual timer: exact where the emulator counts them (`-icount shift=6`).

use cortex_m_semihosting::hprintln;

/// Dual timer of the board (Arm Application Note AN500): load, value, control.
const BASE: usize = 0x4000_2000;
/// Enabled, 32 bits, no interrupt.
const ENABLE: u32 = 1 << 7 | 1 << 1;
/// A tick of 25 MHz takes 40 ns, an instruction 64.
const TICK_NS: u64 = 40;
const INSTRUCTION_NS: u64 = 64;

fn write(offset: usize, value: u32) {
    // SAFETY: `BASE` is the dual timer of the emulated board; the offsets are those of its registers, aligned to four bytes.
    unsafe { core::ptr::with_exposed_provenance_mut::<u32>(BASE + offset).write_volatile(value) }
}

fn now() -> u32 {
    // SAFETY: as above.
    unsafe { core::ptr::with_exposed_provenance::<u32>(BASE + 4).read_volatile() }
}

/// Starts the counter. Call once.
pub fn start() {
    write(0, u32::MAX);
    write(8, ENABLE);
}

/// Adds up one kind of work.
#[derive(Default)]
pub struct Stopwatch {
    total: u64,
    largest: u64,
    count: u64,
}

impl Stopwatch {
    /// Does a piece of work; its instructions.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, u64) {
        let begun = now();
        let done = work();
        // The counter runs down.
        (done, u64::from(begun.wrapping_sub(now())) * TICK_NS / INSTRUCTION_NS)
    }

    /// Enters one.
    pub fn enter(&mut self, instructions: u64) {
        self.total += instructions;
        self.largest = self.largest.max(instructions);
        self.count += 1;
    }

    /// Prints them.
    pub fn print(&self, name: &str) {
        let mean = self.total / self.count.max(1);
        hprintln!("instructions {} count {} mean {} max {}", name, self.count, mean, self.largest);
    }
}
