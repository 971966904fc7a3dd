//! The log: `defmt` frames on a port of its own, read with `defmt-print` and the image.
//!
//! A frame is packed in the caller's context into a buffer and sent from there by a task of the lowest priority. A
//! frame that does not fit is counted and reported later: logging never blocks.

use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};

use critical_section::{Mutex, RestoreState};
use defmt::Encoder;
use embassy_executor::Spawner;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_time::Instant;
use embedded_io_async::Write;
use floorguard_board_support::{RobotShared, log_decisions};
use heapless::Vec;

use crate::uart::{self, Port};

const BAUD: u32 = 115_200;
/// Bytes of frames that wait for the port.
const WAITING_BYTES: usize = 1_024;
/// Longest frame.
const FRAME_BYTES: usize = 128;

static WAITING: Pipe<CriticalSectionRawMutex, WAITING_BYTES> = Pipe::new();
static LOST: AtomicU32 = AtomicU32::new(0);

/// The frame that is being written, and what ends the critical section around it.
struct Frame {
    encoder: Encoder,
    bytes: Vec<u8, FRAME_BYTES>,
    restore: RestoreState,
    open: bool,
    too_long: bool,
}

static FRAME: Mutex<RefCell<Frame>> = Mutex::new(RefCell::new(Frame {
    encoder: Encoder::new(),
    bytes: Vec::new(),
    restore: RestoreState::invalid(),
    open: false,
    too_long: false,
}));

#[defmt::global_logger]
struct Logger;

/// Packs into the frame's buffer.
fn with_frame(use_frame: impl FnOnce(&mut Encoder, &mut dyn FnMut(&[u8]))) {
    critical_section::with(|token| {
        let Frame { encoder, bytes, too_long, .. } = &mut *FRAME.borrow_ref_mut(token);
        use_frame(encoder, &mut |packed| *too_long |= bytes.extend_from_slice(packed).is_err());
    });
}

// SAFETY: between `acquire` and `release` interrupts are off, so that no two frames mix on the only core.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        // SAFETY: released in `release`, with the state that is kept here.
        let restore = unsafe { critical_section::acquire() };
        critical_section::with(|token| {
            let frame = &mut *FRAME.borrow_ref_mut(token);
            assert!(!frame.open, "a frame within a frame");
            (frame.open, frame.too_long, frame.restore) = (true, false, restore);
            frame.bytes.clear();
        });
        with_frame(|encoder, write| encoder.start_frame(write));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        with_frame(|encoder, write| encoder.end_frame(write));
        let restore = critical_section::with(|token| {
            let frame = &mut *FRAME.borrow_ref_mut(token);
            if frame.too_long || frame.bytes.len() > WAITING.free_capacity() {
                LOST.fetch_add(1, Ordering::Relaxed);
            } else {
                let mut rest = frame.bytes.as_slice();
                // At most two turns: one up to the end of the buffer, one from its beginning.
                while let Ok(count @ 1..) = WAITING.try_write(rest) {
                    rest = rest.get(count..).unwrap_or_default();
                    if rest.is_empty() {
                        break;
                    }
                }
            }
            frame.open = false;
            frame.restore
        });
        // SAFETY: the state that `acquire` got.
        unsafe { critical_section::release(restore) };
    }

    unsafe fn write(bytes: &[u8]) {
        with_frame(|encoder, write| encoder.write(bytes, write));
    }
}

defmt::timestamp!("{=u64:us}", Instant::now().as_micros());

/// Starts the tasks of the log, and tells who speaks. Call once.
pub fn start(spawner: Spawner, shared: &'static RobotShared) {
    uart::LOG.start(BAUD);
    let version = env!("CARGO_PKG_VERSION");
    match crate::crash_record::restart() {
        None => defmt::info!("floorguard {} on mps2-an500, switched on", version),
        Some(last) => defmt::error!(
            "floorguard {} on mps2-an500, death {}: cause {}, detail {:x}, after {} ms",
            version,
            last.deaths,
            last.cause,
            last.detail,
            last.uptime_ms
        ),
    }
    spawner.spawn(send().unwrap());
    spawner.spawn(decisions(shared).unwrap());
}

#[embassy_executor::task]
async fn send() {
    let (mut bytes, mut reported) = ([0; 64], 0);
    loop {
        let count = WAITING.read(&mut bytes).await;
        // The port cannot fail.
        let _ = Port(&uart::LOG).write_all(&bytes[..count]).await;
        let lost = LOST.load(Ordering::Relaxed);
        if lost != reported {
            reported = lost;
            defmt::warn!("{} messages did not fit so far", lost);
        }
    }
}

#[embassy_executor::task]
async fn decisions(shared: &'static RobotShared) {
    log_decisions(shared).await;
}
