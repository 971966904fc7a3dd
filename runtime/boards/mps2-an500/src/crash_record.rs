//! What the machine died of, kept across a reset: in memory that the start-up code leaves alone.

use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_time::Instant;
use floorguard_runtime::black_box_log::{LogRestart, RestartCause};

use crate::uart;

/// "FGLW".
const MAGIC: u32 = 0x574c_4746;
/// NMT: stop all nodes, as an SLCAN line (book, CAN frames: SLCAN; book, CANopen: Identifiers).
const STOP_ALL_NODES: &[u8] = b"\rt00020200\r";

/// Magic, cause, program counter or number, uptime in milliseconds, deaths so far, and their sum.
struct Words([AtomicU32; 6]);

#[unsafe(link_section = ".uninit.crash_record")]
static WORDS: MaybeUninit<Words> = MaybeUninit::uninit();

static DYING: AtomicBool = AtomicBool::new(false);

fn words() -> &'static Words {
    // SAFETY: any bits are a valid atomic integer; memory that holds no words fails the sum.
    unsafe { WORDS.assume_init_ref() }
}

/// Cause, detail, uptime in milliseconds, deaths so far; all zero if the machine was switched on.
pub fn read() -> [u32; 4] {
    let [magic, cause, detail, uptime_ms, deaths, sum] =
        [0, 1, 2, 3, 4, 5].map(|index| words().0[index].load(Ordering::Relaxed));
    let whole = cause.wrapping_add(detail).wrapping_add(uptime_ms).wrapping_add(deaths);
    if magic == MAGIC && sum == whole { [cause, detail, uptime_ms, deaths] } else { [0; 4] }
}

/// The same for the black box; `None` if the machine was switched on.
pub fn restart() -> Option<LogRestart> {
    let [cause, detail, uptime_ms, deaths] = read();
    (deaths != 0).then_some(LogRestart { cause: cause as u8, detail, uptime_ms, deaths })
}

/// Stops the drives, writes down why, and waits for the watchdog to reset the machine.
pub fn die(cause: RestartCause, detail: u32) -> ! {
    cortex_m::interrupt::disable();
    // The watchdog that ends the dying is no second cause.
    if !DYING.swap(true, Ordering::Relaxed) {
        write_down(cause, detail);
    }
    loop {
        cortex_m::asm::nop();
    }
}

fn write_down(cause: RestartCause, detail: u32) {
    uart::CAN.write_blocking(STOP_ALL_NODES);
    let [.., deaths] = read();
    let uptime_ms = Instant::now().as_millis() as u32;
    let entry = [cause as u32, detail, uptime_ms, deaths.wrapping_add(1)];
    let sum = entry.iter().fold(0_u32, |sum, word| sum.wrapping_add(*word));
    let [cause, detail, uptime_ms, deaths] = entry;
    for (slot, word) in words().0.iter().zip([MAGIC, cause, detail, uptime_ms, deaths, sum]) {
        slot.store(word, Ordering::Relaxed);
    }
}
