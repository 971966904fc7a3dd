//! Faults on purpose: each is broken once, some time after the first start, to see the drives stop and the cause told.

use core::hint::black_box;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::NVIC;
use embassy_time::{Instant, Timer};

use crate::interrupts::{self, Interrupt, priority};
use crate::last_words;

/// When, after the start, milliseconds.
const AFTER_MS: u64 = 2_000;
/// The same for the watchdog's food.
pub const STARVED_AT: Instant = Instant::from_millis(AFTER_MS);

/// What to break, by the number that the bench gives. It has to happen on the ring that the fault belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Perception panics.
    Panic,
    /// Perception needs more stack than there is.
    StackOverflow,
    /// Perception reads where nothing is.
    EmptyAddress,
    /// A task of the guard ring never ends.
    GuardStall,
    /// A task of perception never ends: the guard has to go on.
    PerceptionStall,
    /// Nobody feeds the watchdog.
    Starvation,
    /// An interrupt line that never rests.
    InterruptStorm,
}

impl Fault {
    /// The fault of a number; `None` for 0, for unknown ones, and after the first start.
    pub fn of(number: u32) -> Option<Self> {
        if last_words::read() != [0; 4] {
            return None;
        }
        Some(match number {
            1 => Self::Panic,
            2 => Self::StackOverflow,
            3 => Self::EmptyAddress,
            4 => Self::GuardStall,
            5 => Self::PerceptionStall,
            6 => Self::Starvation,
            7 => Self::InterruptStorm,
            _ => return None,
        })
    }
}

/// Waits until it is time.
pub async fn wait() {
    Timer::after_millis(AFTER_MS).await;
}

/// Breaks what belongs to the perception ring.
#[embassy_executor::task]
pub async fn break_perception(fault: Fault) {
    wait().await;
    match fault {
        Fault::Panic => panic!("on purpose"),
        Fault::StackOverflow => black_box(deeper(1)),
        Fault::EmptyAddress => {
            // SAFETY: none; the address is empty, and reading it is the fault that is wanted.
            black_box(unsafe { core::ptr::with_exposed_provenance::<u32>(0x3000_0000).read_volatile() })
        }
        Fault::PerceptionStall => stall(),
        _ => 0,
    };
}

/// Breaks what belongs to the guard ring.
#[embassy_executor::task]
pub async fn break_guard(fault: Fault) {
    wait().await;
    match fault {
        Fault::GuardStall => {
            stall();
        }
        Fault::InterruptStorm => {
            STORM.store(true, Ordering::Relaxed);
            interrupts::enable(Interrupt::Uart3Transmit, priority::DEVICE);
            NVIC::pend(Interrupt::Uart3Transmit);
        }
        _ => {}
    }
}

/// The line of the log's transmitter keeps itself pending while this is set.
pub static STORM: AtomicBool = AtomicBool::new(false);

fn stall() -> u32 {
    loop {
        cortex_m::asm::nop();
    }
}

#[allow(unconditional_recursion, reason = "it is to run out of stack")]
fn deeper(depth: u32) -> u32 {
    let room = black_box([depth; 64]);
    deeper(depth.wrapping_add(room[0])).wrapping_add(room[63])
}
