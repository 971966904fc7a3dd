//! The serial lines, with buffers that live for ever. Interrupts fill and empty them, no DMA: they lie in DTCM.

use embassy_stm32::mode::Async;
use embassy_stm32::usart::{BufferedUart, Config, DataBits, Parity, StopBits};
use static_cell::StaticCell;

/// More than one S300 telegram (1,108 bytes).
pub const RECEIVE_BYTES: usize = 2_048;
/// Orders to the inertial sensor; a longer one is sent in parts.
pub const SEND_BYTES: usize = 128;

/// Buffers of one line.
pub struct Buffers {
    pub receive: [u8; RECEIVE_BYTES],
    pub send: [u8; SEND_BYTES],
}

impl Buffers {
    pub const fn new() -> Self {
        Self { receive: [0; RECEIVE_BYTES], send: [0; SEND_BYTES] }
    }
}

/// The scanner's.
#[unsafe(link_section = ".dtcm.scanner")]
pub static SCANNER: StaticCell<Buffers> = StaticCell::new();
/// The inertial unit's.
#[unsafe(link_section = ".dtcm.imu")]
pub static IMU: StaticCell<Buffers> = StaticCell::new();

/// A line of eight bits without parity.
pub fn config(baud: u32) -> Config {
    let mut config = Config::default();
    config.baudrate = baud;
    config.data_bits = DataBits::DataBits8;
    config.parity = Parity::ParityNone;
    config.stop_bits = StopBits::STOP1;
    config
}

/// A line as a task holds it.
pub type Line = BufferedUart<'static>;
#[allow(dead_code, reason = "names the mode that the chip's library uses for buffered lines")]
type Mode = Async;
