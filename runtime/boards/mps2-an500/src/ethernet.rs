//! The LAN9118 Ethernet controller, interrupt-driven, as a driver for `embassy-net`.
//!
//! The emulated receive FIFO holds eight lidar packets (10.6 ms) and drops beyond, so the interrupt drains it into a
//! ring of frames at once; the network task takes them from there. Registers: platform notes, 3.

use core::cell::RefCell;
use core::task::Context;

use critical_section::Mutex;
use embassy_net_driver::{Capabilities, HardwareAddress, LinkState, RxToken, TxToken};
use embassy_sync::waitqueue::AtomicWaker;

use crate::interrupts::{self, Interrupt, priority};
use crate::register::Register;

const BASE: usize = 0xa000_0000;
const RECEIVE_DATA: Register = Register::at(BASE);
const TRANSMIT_DATA: Register = Register::at(BASE + 0x20);
const RECEIVE_STATUS: Register = Register::at(BASE + 0x40);
const TRANSMIT_STATUS: Register = Register::at(BASE + 0x48);
const IDENTITY: Register = Register::at(BASE + 0x50);
const INTERRUPT_CONFIGURATION: Register = Register::at(BASE + 0x54);
const INTERRUPT_STATUS: Register = Register::at(BASE + 0x58);
const INTERRUPT_ENABLE: Register = Register::at(BASE + 0x5c);
const FIFO_INTERRUPT: Register = Register::at(BASE + 0x68);
const TRANSMIT_CONFIGURATION: Register = Register::at(BASE + 0x70);
const HARDWARE_CONFIGURATION: Register = Register::at(BASE + 0x74);
const RECEIVE_FIFO: Register = Register::at(BASE + 0x7c);
const TRANSMIT_FIFO: Register = Register::at(BASE + 0x80);
const MAC_COMMAND: Register = Register::at(BASE + 0xa4);
const MAC_DATA: Register = Register::at(BASE + 0xa8);

const RECEIVE_STATUS_LEVEL: u32 = 1 << 3;
const EXPECTED_IDENTITY: u32 = 0x0118_0001;
/// The longest frame of Ethernet without its checksum.
const FRAME_BYTES: usize = 1_514;
/// Frames that wait for the network task, which runs at the guard's priority: 12 are 16 ms of lidar, beside the eight
/// that the controller holds.
const FRAMES: usize = 12;
/// The controller's receive FIFO can hold another frame up to this fill level, bytes.
const FIFO_FREE_UP_TO: u32 = 10_560 - 1_518;
/// Frames taken per interrupt: the FIFO cannot hold more.
const FRAMES_PER_INTERRUPT: usize = 16;
/// Our address on the emulated network, locally administered.
pub const HARDWARE_ADDRESS: [u8; 6] = [0x02, 0x00, 0x00, 0x00, 0x05, 0x00];

/// Frames between the interrupt and the network task.
struct Ring {
    frames: [[u8; FRAME_BYTES]; FRAMES],
    lengths: [usize; FRAMES],
    first: usize,
    count: usize,
    /// Frames that did not fit.
    lost: u32,
    /// Times that the controller's FIFO was found full: it drops what comes then, and does not count it.
    full: u32,
}

static RING: Mutex<RefCell<Ring>> = Mutex::new(RefCell::new(Ring {
    frames: [[0; FRAME_BYTES]; FRAMES],
    lengths: [0; FRAMES],
    first: 0,
    count: 0,
    lost: 0,
    full: 0,
}));
static RECEIVED: AtomicWaker = AtomicWaker::new();

/// The controller, started.
pub struct Ethernet(());

impl Ethernet {
    /// Resets and starts the controller. Call once. Panics where it is not soldered to the board.
    pub fn start() -> Self {
        let identity = IDENTITY.read();
        assert!(identity == EXPECTED_IDENTITY, "no LAN9118, its identity is {identity:#010x}");
        HARDWARE_CONFIGURATION.write(1);
        HARDWARE_CONFIGURATION.write(1 << 20 | 5 << 16);
        // Active high and push-pull; otherwise the line is inverted and interrupts for ever.
        INTERRUPT_CONFIGURATION.write(0x111);
        FIFO_INTERRUPT.write(0x4800_0000);
        TRANSMIT_CONFIGURATION.write(1 << 1);
        let [a, b, c, d, e, f] = HARDWARE_ADDRESS;
        mac_write(2, u32::from_le_bytes([e, f, 0, 0]));
        mac_write(3, u32::from_le_bytes([a, b, c, d]));
        mac_write(1, 1 << 20 | 1 << 3 | 1 << 2);
        INTERRUPT_STATUS.write(u32::MAX);
        INTERRUPT_ENABLE.write(RECEIVE_STATUS_LEVEL);
        interrupts::enable(Interrupt::Ethernet, priority::DEVICE);
        Self(())
    }

    /// Frames lost because the network task came too late.
    pub fn lost_frames() -> u32 {
        critical_section::with(|token| RING.borrow_ref(token).lost)
    }

    /// Times that frames may have been lost because the interrupt came too late.
    pub fn overruns() -> u32 {
        critical_section::with(|token| RING.borrow_ref(token).full)
    }
}

fn mac_write(index: u32, value: u32) {
    MAC_DATA.write(value);
    MAC_COMMAND.write(1 << 31 | index);
}

#[unsafe(no_mangle)]
extern "C" fn ETHERNET() {
    critical_section::with(|token| {
        let mut ring = RING.borrow_ref_mut(token);
        if RECEIVE_FIFO.read() & 0xffff > FIFO_FREE_UP_TO {
            ring.full = ring.full.saturating_add(1);
        }
        for _ in 0..FRAMES_PER_INTERRUPT {
            if (RECEIVE_FIFO.read() >> 16) & 0xff == 0 {
                break;
            }
            take_frame(&mut ring);
        }
        INTERRUPT_STATUS.write(RECEIVE_STATUS_LEVEL);
    });
    // The status bit is an edge of the level; a frame that came in between raises no new one.
    if (RECEIVE_FIFO.read() >> 16) & 0xff != 0 {
        cortex_m::peripheral::NVIC::pend(Interrupt::Ethernet);
    }
    RECEIVED.wake();
}

/// Moves one frame out of the FIFO, into the ring if that is not full.
fn take_frame(ring: &mut Ring) {
    let length = (RECEIVE_STATUS.read() >> 16 & 0x3fff) as usize;
    let words = length.div_ceil(4);
    let payload = length.saturating_sub(4).min(FRAME_BYTES);
    if ring.count == FRAMES {
        ring.lost = ring.lost.saturating_add(1);
        (0..words).for_each(|_| _ = RECEIVE_DATA.read());
        return;
    }
    let slot = (ring.first + ring.count) % FRAMES;
    let frame = &mut ring.frames[slot];
    for word in 0..words {
        let bytes = RECEIVE_DATA.read().to_le_bytes();
        let start = word * 4;
        if start < payload {
            let end = (start + 4).min(payload);
            frame[start..end].copy_from_slice(&bytes[..end - start]);
        }
    }
    ring.lengths[slot] = payload;
    ring.count += 1;
}

/// Permission to take one frame out of the ring.
pub struct Receive(());
/// Permission to send one frame.
pub struct Transmit(());

impl RxToken for Receive {
    fn consume<R, F: FnOnce(&mut [u8]) -> R>(self, use_frame: F) -> R {
        let mut frame = [0; FRAME_BYTES];
        let length = critical_section::with(|token| {
            let mut ring = RING.borrow_ref_mut(token);
            let first = ring.first;
            let length = ring.lengths[first];
            frame[..length].copy_from_slice(&ring.frames[first][..length]);
            ring.first = (first + 1) % FRAMES;
            ring.count = ring.count.saturating_sub(1);
            length
        });
        use_frame(&mut frame[..length])
    }
}

impl TxToken for Transmit {
    fn consume<R, F: FnOnce(&mut [u8]) -> R>(self, length: usize, fill: F) -> R {
        let mut frame = [0; FRAME_BYTES];
        let length = length.min(FRAME_BYTES);
        let result = fill(&mut frame[..length]);
        TRANSMIT_DATA.write(1 << 13 | 1 << 12 | length as u32);
        TRANSMIT_DATA.write(length as u32);
        for word in frame[..length].chunks(4) {
            let mut bytes = [0; 4];
            bytes[..word.len()].copy_from_slice(word);
            TRANSMIT_DATA.write(u32::from_le_bytes(bytes));
        }
        // The status FIFO must be emptied or the controller stops.
        let _ = TRANSMIT_STATUS.read();
        result
    }
}

impl embassy_net_driver::Driver for Ethernet {
    type RxToken<'a> = Receive;
    type TxToken<'a> = Transmit;

    fn receive(&mut self, context: &mut Context<'_>) -> Option<(Receive, Transmit)> {
        RECEIVED.register(context.waker());
        let waiting = critical_section::with(|token| RING.borrow_ref(token).count);
        (waiting > 0).then_some((Receive(()), Transmit(())))
    }

    fn transmit(&mut self, _: &mut Context<'_>) -> Option<Transmit> {
        (TRANSMIT_FIFO.read() & 0xffff > FRAME_BYTES as u32 + 16).then_some(Transmit(()))
    }

    fn link_state(&mut self, _: &mut Context<'_>) -> LinkState {
        LinkState::Up
    }

    fn capabilities(&self) -> Capabilities {
        let mut capabilities = Capabilities::default();
        capabilities.max_transmission_unit = FRAME_BYTES;
        capabilities.max_burst_size = Some(1);
        capabilities
    }

    fn hardware_address(&self) -> HardwareAddress {
        HardwareAddress::Ethernet(HARDWARE_ADDRESS)
    }
}
