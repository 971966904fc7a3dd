//! The CMSDK watchdog: first expiry raises an NMI, the second resets the machine.

use crate::register::Register;

const BASE: usize = 0x4000_8000;
const LOAD: Register = Register::at(BASE);
const CONTROL: Register = Register::at(BASE + 0x08);
const CLEAR: Register = Register::at(BASE + 0x0c);
const LOCK: Register = Register::at(BASE + 0xc00);
const KEY: u32 = 0x1acc_e551;
/// Interrupt and counter, reset.
const ENABLE: u32 = 0b11;
const TICKS_PER_MILLISECOND: u32 = 25_000;

/// Starts it; from now on [`feed`] must be called at least every `milliseconds`.
pub fn start(milliseconds: u32) {
    LOCK.write(KEY);
    LOAD.write(milliseconds.saturating_mul(TICKS_PER_MILLISECOND));
    CONTROL.write(ENABLE);
}

/// The guard is healthy: start the count again.
pub fn feed() {
    CLEAR.write(1);
}
