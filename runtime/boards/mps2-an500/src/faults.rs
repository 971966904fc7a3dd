//! Faults on purpose: each is broken once, soon after the robot first drives, to verify that the drives stop and that
//! the cause is reported.

use core::hint::black_box;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use embassy_time::{Duration, Instant, Timer};
use floorguard_board_support::RobotShared;

use crate::crash_record;
use crate::interrupts::{self, Interrupt, priority};
use crate::uart;

/// How long after the robot was first permitted to drive, milliseconds.
const AFTER_MS: u32 = 300;
/// What counts as driving, m/s.
const DRIVES_MPS: f32 = 0.05;

/// When it is going to break, milliseconds since the start; 0: not known yet.
static PLANNED_MS: AtomicU32 = AtomicU32::new(0);

/// When it is going to break or has broken, milliseconds since the start; 0: not known yet.
pub fn planned_ms() -> u32 {
    PLANNED_MS.load(Ordering::Relaxed)
}

/// For how long nobody empties the Ethernet controller, milliseconds: longer than the guard waits for a packet.
const UNSERVED_MS: u64 = 600;
/// A slow perception: busy for this long, then at rest.
const SLOW: Duration = Duration::from_millis(250);
const SLOW_REST_US: u64 = 100;

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
    /// Nobody empties the Ethernet controller for a while.
    EthernetOverrun,
    /// Perception is far too slow: its queues are full.
    SlowPerception,
}

impl Fault {
    /// The fault of a number; `None` for 0, for unknown ones, and after the first start.
    pub fn of(number: u32) -> Option<Self> {
        if crash_record::read() != [0; 4] {
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
            8 => Self::EthernetOverrun,
            9 => Self::SlowPerception,
            _ => return None,
        })
    }
}

/// Waits until it is time.
async fn wait(shared: &RobotShared) {
    while planned_ms() == 0 {
        Timer::after_millis(10).await;
        if shared.decision.get().is_some_and(|decision| decision.permitted.linear_mps > DRIVES_MPS) {
            // Both rings ask; the first one that sees it move says when.
            let at_ms = Instant::now().as_millis() as u32 + AFTER_MS;
            let _ = PLANNED_MS.compare_exchange(0, at_ms, Ordering::Relaxed, Ordering::Relaxed);
        }
    }
    Timer::at(Instant::from_millis(planned_ms().into())).await;
}

/// Breaks what belongs to the perception ring.
#[embassy_executor::task]
pub async fn break_perception(shared: &'static RobotShared, fault: Fault) {
    wait(shared).await;
    match fault {
        Fault::Panic => panic!("on purpose"),
        Fault::StackOverflow => black_box(deeper(1)),
        Fault::EmptyAddress => {
            // SAFETY: none; the address is empty, and reading it is the fault that is wanted.
            black_box(unsafe { core::ptr::with_exposed_provenance::<u32>(0x3000_0000).read_volatile() })
        }
        Fault::PerceptionStall => stall(),
        Fault::SlowPerception => loop {
            let began = Instant::now();
            while began.elapsed() < SLOW {
                cortex_m::asm::nop();
            }
            Timer::after_micros(SLOW_REST_US).await;
        },
        _ => 0,
    };
}

/// Breaks what belongs to the guard ring.
#[embassy_executor::task]
pub async fn break_guard(shared: &'static RobotShared, fault: Fault) {
    wait(shared).await;
    match fault {
        Fault::GuardStall => {
            stall();
        }
        Fault::InterruptStorm => {
            uart::STORM.store(true, Ordering::Relaxed);
            interrupts::enable(Interrupt::Uart3Transmit, priority::DEVICE);
            NVIC::pend(Interrupt::Uart3Transmit);
        }
        Fault::EthernetOverrun => {
            NVIC::mask(Interrupt::Ethernet);
            Timer::after_millis(UNSERVED_MS).await;
            interrupts::enable(Interrupt::Ethernet, priority::DEVICE);
        }
        _ => {}
    }
}

fn stall() -> u32 {
    loop {
        cortex_m::asm::nop();
    }
}

#[allow(unconditional_recursion, reason = "it is to run out of stack")]
fn deeper(depth: u32) -> u32 {
    let frame = black_box([depth; 64]);
    deeper(depth.wrapping_add(frame[0])).wrapping_add(frame[63])
}
