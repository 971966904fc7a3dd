//! The CMSDK UARTs, interrupt-driven, behind the serial traits that the tasks know.
//!
//! The device buffers one byte each way. The receive interrupt takes a bounded number of bytes; when the software
//! buffer is full the byte stays in the device, the interrupt is switched off, and the reader switches it on again.

use core::convert::Infallible;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_sync::signal::Signal;
use embedded_io_async::{ErrorType, Read, Write};

use crate::interrupts::{self, Interrupt, priority};
use crate::register::Register;

const STATE_TRANSMIT_FULL: u32 = 1;
const STATE_RECEIVE_FULL: u32 = 1 << 1;
const CONTROL_TRANSMIT: u32 = 1;
const CONTROL_RECEIVE: u32 = 1 << 1;
const CONTROL_TRANSMIT_INTERRUPT: u32 = 1 << 2;
const CONTROL_RECEIVE_INTERRUPT: u32 = 1 << 3;
/// Bytes taken per interrupt: bounds the time that the line can steal from the rings.
const BYTES_PER_INTERRUPT: usize = 32;
/// Polls of the device's state per byte of the crash record: ten milliseconds of a fast processor.
const LAST_WORDS_POLLS: u32 = 1_000_000;
/// Software buffer, bytes: more than one S300 telegram (1,108).
const BUFFER: usize = 1_536;

/// One port. Invariant: `base` is a UART of the board, `receive` its line.
pub struct Uart {
    base: usize,
    receive: Interrupt,
    transmit: Interrupt,
    received: Pipe<CriticalSectionRawMutex, BUFFER>,
    /// Bytes taken from the device since the start.
    taken: AtomicU32,
    sent: Signal<CriticalSectionRawMutex, ()>,
}

/// The safety scanner.
pub static SCANNER: Uart = Uart::new(0x4000_4000, Interrupt::Uart0Receive, Interrupt::Uart0Transmit);
/// The inertial unit.
pub static IMU: Uart = Uart::new(0x4000_5000, Interrupt::Uart1Receive, Interrupt::Uart1Transmit);
/// CAN, as SLCAN text.
pub static CAN: Uart = Uart::new(0x4000_6000, Interrupt::Uart2Receive, Interrupt::Uart2Transmit);
/// The log.
pub static LOG: Uart = Uart::new(0x4000_7000, Interrupt::Uart3Receive, Interrupt::Uart3Transmit);

/// The black box, on request.
pub static BLACK_BOX: Uart = Uart::new(0x4000_9000, Interrupt::Uart4Receive, Interrupt::Uart4Transmit);

/// The line of the log's transmitter keeps itself pending while this is set: a fault on purpose.
pub static STORM: AtomicBool = AtomicBool::new(false);

impl Uart {
    const fn new(base: usize, receive: Interrupt, transmit: Interrupt) -> Self {
        Self { base, receive, transmit, received: Pipe::new(), taken: AtomicU32::new(0), sent: Signal::new() }
    }

    const fn data(&self) -> Register {
        Register::at(self.base)
    }

    const fn state(&self) -> Register {
        Register::at(self.base + 0x04)
    }

    const fn control(&self) -> Register {
        Register::at(self.base + 0x08)
    }

    const fn clear(&self) -> Register {
        Register::at(self.base + 0x0c)
    }

    /// Switches the port on. The divider is for the record: the emulator does not simulate the rate.
    pub fn start(&self, baud: u32) {
        Register::at(self.base + 0x10).write((25_000_000 / baud.max(1)).max(16));
        self.control().write(CONTROL_TRANSMIT | CONTROL_RECEIVE | CONTROL_RECEIVE_INTERRUPT);
        interrupts::enable(self.receive, priority::DEVICE);
        interrupts::enable(self.transmit, priority::DEVICE);
    }

    fn on_receive(&self) {
        // Clear first: an edge that comes while the byte is read must not be lost.
        self.clear().write(1 << 1);
        let free = self.received.free_capacity();
        if free == 0 {
            self.control().modify(CONTROL_RECEIVE_INTERRUPT, 0);
            return;
        }
        let mut bytes = [0; BYTES_PER_INTERRUPT];
        let mut count = 0;
        for slot in bytes.iter_mut().take(free) {
            if self.state().read() & STATE_RECEIVE_FULL == 0 {
                break;
            }
            *slot = self.data().read() as u8;
            count += 1;
        }
        // There is space: only this handler writes. Two turns at most: up to the end of the buffer, and from its
        // beginning.
        let mut rest = &bytes[..count];
        for _ in 0..2 {
            let written = self.received.try_write(rest).unwrap_or(0);
            rest = &rest[written..];
            if rest.is_empty() {
                break;
            }
        }
        self.taken.fetch_add(count as u32, Ordering::Relaxed);
        if self.state().read() & STATE_RECEIVE_FULL != 0 {
            cortex_m::peripheral::NVIC::pend(self.receive);
        }
    }

    fn on_transmit(&self) {
        self.clear().write(1);
        self.control().modify(CONTROL_TRANSMIT_INTERRUPT, 0);
        self.sent.signal(());
        if STORM.load(Ordering::Relaxed) {
            cortex_m::peripheral::NVIC::pend(self.transmit);
        }
    }

    /// Bytes taken from the device since the start; wraps.
    pub fn taken(&self) -> u32 {
        self.taken.load(Ordering::Relaxed)
    }

    /// Writes without waiting for the executor: for crash record.
    pub fn write_blocking(&self, bytes: &[u8]) {
        for byte in bytes {
            // The bound keeps a dead device from hanging the crash record.
            for _ in 0..LAST_WORDS_POLLS {
                if self.state().read() & STATE_TRANSMIT_FULL == 0 {
                    break;
                }
            }
            self.data().write(u32::from(*byte));
        }
    }
}

/// A port as a task sees it.
pub struct Port(pub &'static Uart);

impl ErrorType for Port {
    type Error = Infallible;
}

impl Read for Port {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let count = self.0.received.read(buffer).await;
        critical_section::with(|_| self.0.control().modify(0, CONTROL_RECEIVE_INTERRUPT));
        // A byte that waited in the device raises no new edge.
        if self.0.state().read() & STATE_RECEIVE_FULL != 0 {
            cortex_m::peripheral::NVIC::pend(self.0.receive);
        }
        Ok(count)
    }
}

impl Write for Port {
    async fn write(&mut self, buffer: &[u8]) -> Result<usize, Infallible> {
        let Some(byte) = buffer.first() else { return Ok(0) };
        if self.0.state().read() & STATE_TRANSMIT_FULL != 0 {
            self.0.sent.reset();
            critical_section::with(|_| self.0.control().modify(0, CONTROL_TRANSMIT_INTERRUPT));
            if self.0.state().read() & STATE_TRANSMIT_FULL != 0 {
                self.0.sent.wait().await;
            }
        }
        self.0.data().write(u32::from(*byte));
        Ok(1)
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

macro_rules! handlers {
    ($($receive:ident $transmit:ident $port:ident),* $(,)?) => {$(
        #[unsafe(no_mangle)]
        extern "C" fn $receive() {
            $port.on_receive();
        }
        #[unsafe(no_mangle)]
        extern "C" fn $transmit() {
            $port.on_transmit();
        }
    )*};
}

handlers! {
    UART0_RECEIVE UART0_TRANSMIT SCANNER,
    UART1_RECEIVE UART1_TRANSMIT IMU,
    UART2_RECEIVE UART2_TRANSMIT CAN,
    UART3_RECEIVE UART3_TRANSMIT LOG,
    UART4_RECEIVE UART4_TRANSMIT BLACK_BOX,
}
