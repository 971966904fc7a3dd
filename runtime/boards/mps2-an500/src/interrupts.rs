//! The board's interrupt lines and their vectors.
//!
//! Numbers from the board's manual (AN500, platform notes 2.1). `DefaultHandler` catches the rest.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;

/// Interrupts that the firmware uses.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u16)]
pub enum Interrupt {
    Uart0Receive = 0,
    Uart0Transmit = 1,
    Uart1Receive = 2,
    Uart1Transmit = 3,
    Uart2Receive = 4,
    Uart2Transmit = 5,
    DualTimer = 10,
    Ethernet = 13,
    Uart3Receive = 18,
    Uart3Transmit = 19,
    Uart4Receive = 20,
    Uart4Transmit = 21,
    /// No device: pended by the waker of the guard's executor.
    GuardExecutor = 31,
}

// SAFETY: the numbers are those of the device and constant.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

/// Priorities, 0 most urgent. Time comes before the devices, and they before the guard: they cannot buffer what
/// arrives meanwhile. What they take from the guard is bounded by what their wires can bring.
pub mod priority {
    /// Timer interrupt: wakes both rings.
    pub const CLOCK: u8 = 0x20;
    /// Devices: they only move bytes, within a bound per interrupt.
    pub const DEVICE: u8 = 0x40;
    /// The guard ring.
    pub const GUARD: u8 = 0x60;
}

/// Sets the priority of a line and lets it through.
pub fn enable(line: Interrupt, level: u8) {
    // SAFETY: called once per line at start, before the handlers' data is shared; the handlers synchronise through
    // critical sections, so no mask-based section is broken by a new priority.
    unsafe {
        let mut peripherals = cortex_m::Peripherals::steal();
        peripherals.NVIC.set_priority(line, level);
        NVIC::unmask(line);
    }
}

type Handler = unsafe extern "C" fn();

unsafe extern "C" {
    fn DefaultHandler();
    fn UART0_RECEIVE();
    fn UART0_TRANSMIT();
    fn UART1_RECEIVE();
    fn UART1_TRANSMIT();
    fn UART2_RECEIVE();
    fn UART2_TRANSMIT();
    fn UART3_RECEIVE();
    fn UART3_TRANSMIT();
    fn UART4_RECEIVE();
    fn UART4_TRANSMIT();
    fn DUAL_TIMER();
    fn ETHERNET();
    fn GUARD_EXECUTOR();
}

/// The vector table behind the sixteen system exceptions.
#[used]
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [Handler; 32] = {
    let mut table: [Handler; 32] = [DefaultHandler; 32];
    table[0] = UART0_RECEIVE;
    table[1] = UART0_TRANSMIT;
    table[2] = UART1_RECEIVE;
    table[3] = UART1_TRANSMIT;
    table[4] = UART2_RECEIVE;
    table[5] = UART2_TRANSMIT;
    table[10] = DUAL_TIMER;
    table[13] = ETHERNET;
    table[18] = UART3_RECEIVE;
    table[19] = UART3_TRANSMIT;
    table[20] = UART4_RECEIVE;
    table[21] = UART4_TRANSMIT;
    table[31] = GUARD_EXECUTOR;
    table
};
