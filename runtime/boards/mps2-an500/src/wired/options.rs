//! What the emulator's bench wants to know, in the last machine words of PSRAM; without a bench they are
//! zero.

use crate::faults::Fault;
use crate::register::Register;

const AT: usize = 0x60ff_ff00;
/// "FGOP".
const MAGIC: u32 = 0x504f_4746;

/// How to run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// A bench is connected, and ends the run.
    pub bench: bool,
    /// The thread never sleeps: virtual time is the number of instructions.
    pub never_sleep: bool,
    /// What to break on purpose.
    pub fault: Option<Fault>,
}

/// Reads them. Call once, before the first task.
pub fn read() -> Options {
    if Register::at(AT).read() != MAGIC {
        return Options::default();
    }
    let flags = Register::at(AT + 4).read();
    Options { bench: true, never_sleep: flags & 1 != 0, fault: Fault::of(Register::at(AT + 8).read()) }
}
