//! Two executors that sleep until an interrupt.
//!
//! The thread executor runs perception; the interrupt executor runs the guard and preempts it. Both idle with `wfi`:
//! the emulator treats `wfe` as a yield and would burn a whole core of its host.

use core::sync::atomic::{AtomicBool, AtomicPtr, AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use embassy_executor::raw::Executor;
use embassy_executor::{SendSpawner, Spawner};
use embassy_time::Instant;
use static_cell::StaticCell;

use crate::interrupts::{self, Interrupt, priority};

/// What the waker carries for the thread executor; every other value means the guard's.
const THREAD: usize = usize::MAX;
const GUARD: usize = 31;

/// Spent between two polls of the devices while the thread has nothing to do and must not sleep.
const AWAKE_CYCLES: u32 = 4_000;

/// When the guard ring began to work, microseconds since the start; wraps.
static POLL_BEGAN_US: AtomicU32 = AtomicU32::new(0);
/// How long it worked at a stretch at most since somebody asked, microseconds.
static LONGEST_POLL_US: AtomicU32 = AtomicU32::new(0);

/// How long the guard ring has worked at a stretch at most since this was asked, the stretch of the caller included up
/// to now, microseconds.
pub fn longest_guard_poll_us() -> u32 {
    let now_us = Instant::now().as_micros() as u32;
    let this_us = now_us.wrapping_sub(POLL_BEGAN_US.load(Ordering::Relaxed));
    LONGEST_POLL_US.swap(0, Ordering::Relaxed).max(this_us)
}

static THREAD_HAS_WORK: AtomicBool = AtomicBool::new(false);
static THREAD_EXECUTOR: StaticCell<Executor> = StaticCell::new();
static GUARD_EXECUTOR_CELL: StaticCell<Executor> = StaticCell::new();
/// Where the guard's executor lives; null until it is started.
static GUARD_EXECUTOR_AT: AtomicPtr<Executor> = AtomicPtr::new(core::ptr::null_mut());

/// Called by wakers from any context.
#[unsafe(export_name = "__pender")]
fn pender(context: *mut ()) {
    if context.addr() == THREAD {
        THREAD_HAS_WORK.store(true, Ordering::Release);
    } else {
        NVIC::pend(Interrupt::GuardExecutor);
    }
}

/// Starts the guard's executor. Call once.
pub fn start_guard() -> SendSpawner {
    let executor = GUARD_EXECUTOR_CELL.init(Executor::new(core::ptr::without_provenance_mut(GUARD)));
    GUARD_EXECUTOR_AT.store(executor, Ordering::Release);
    interrupts::enable(Interrupt::GuardExecutor, priority::GUARD);
    // SAFETY: the cell keeps the executor for ever.
    let executor: &'static Executor = unsafe { &*GUARD_EXECUTOR_AT.load(Ordering::Acquire) };
    executor.spawner().make_send()
}

#[unsafe(no_mangle)]
extern "C" fn GUARD_EXECUTOR() {
    // SAFETY: the pointer is null or that of a static executor, of which only shared references exist.
    if let Some(executor) = unsafe { GUARD_EXECUTOR_AT.load(Ordering::Acquire).as_ref() } {
        let began_us = Instant::now().as_micros() as u32;
        POLL_BEGAN_US.store(began_us, Ordering::Relaxed);
        // SAFETY: only this handler polls the executor, and it does not preempt itself.
        unsafe { executor.poll() };
        let took_us = (Instant::now().as_micros() as u32).wrapping_sub(began_us);
        LONGEST_POLL_US.fetch_max(took_us, Ordering::Relaxed);
    }
}

/// Runs the thread executor for ever. One that does not sleep keeps the emulator's virtual time in step with the
/// instructions that it executes.
pub fn run_thread(sleeps: bool, spawn: impl FnOnce(Spawner)) -> ! {
    let executor: &'static Executor =
        THREAD_EXECUTOR.init(Executor::new(core::ptr::without_provenance_mut(THREAD)));
    spawn(executor.spawner());
    loop {
        // SAFETY: only this function polls the executor.
        unsafe { executor.poll() };
        // With interrupts masked, nothing can set the flag between the look and the sleep; a pending one still wakes.
        cortex_m::interrupt::disable();
        if !THREAD_HAS_WORK.swap(false, Ordering::Acquire) {
            if sleeps {
                cortex_m::asm::wfi();
            } else {
                // Time goes on by some instructions, then the emulator looks after its devices.
                cortex_m::asm::delay(AWAKE_CYCLES);
                cortex_m::asm::wfe();
            }
        }
        // SAFETY: interrupts were enabled before this loop began.
        unsafe { cortex_m::interrupt::enable() };
    }
}
