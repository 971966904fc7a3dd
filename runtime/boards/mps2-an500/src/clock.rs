//! The `embassy-time` driver on the CMSDK dual timer.
//!
//! Timer 1 runs free at 25 MHz and wraps every 171.8 s; its interrupt counts the wraps. Timer 2 is the alarm. Ticks are
//! microseconds, as on the other boards.

use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};
use core::task::Waker;

use critical_section::Mutex;
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

use crate::interrupts::{self, Interrupt, priority};
use crate::register::Register;

const BASE: usize = 0x4000_2000;
const COUNTER_LOAD: Register = Register::at(BASE);
const COUNTER_VALUE: Register = Register::at(BASE + 0x04);
const COUNTER_CONTROL: Register = Register::at(BASE + 0x08);
const COUNTER_CLEAR: Register = Register::at(BASE + 0x0c);
const COUNTER_RAW: Register = Register::at(BASE + 0x10);
const ALARM_LOAD: Register = Register::at(BASE + 0x20);
const ALARM_CONTROL: Register = Register::at(BASE + 0x28);
const ALARM_CLEAR: Register = Register::at(BASE + 0x2c);

/// Enable, interrupt, 32 bits.
const ENABLE_32_BIT: u32 = 1 << 7 | 1 << 5 | 1 << 1;
const ONE_SHOT: u32 = 1;
/// The core clock of the board, MHz.
const TICKS_PER_MICROSECOND: u64 = 25;
/// Farthest alarm: half a wrap, so that a late one is never mistaken for a far one.
const LONGEST_ALARM_US: u64 = 80_000_000;

struct Clock {
    wraps: AtomicU32,
    queue: Mutex<RefCell<Queue>>,
}

embassy_time_driver::time_driver_impl!(static CLOCK: Clock = Clock {
    wraps: AtomicU32::new(0),
    queue: Mutex::new(RefCell::new(Queue::new())),
});

/// Starts both timers. Call once, before the first task.
pub fn start() {
    COUNTER_LOAD.write(u32::MAX);
    COUNTER_CONTROL.write(ENABLE_32_BIT);
    interrupts::enable(Interrupt::DualTimer, priority::CLOCK);
}

impl Clock {
    /// Raw 25 MHz ticks since the start.
    fn ticks(&self) -> u64 {
        critical_section::with(|_| {
            let mut wraps = u64::from(self.wraps.load(Ordering::Relaxed));
            let mut counted = !COUNTER_VALUE.read();
            // A wrap whose interrupt is still pending: read again behind it.
            if COUNTER_RAW.read() & 1 != 0 {
                wraps += 1;
                counted = !COUNTER_VALUE.read();
            }
            (wraps << 32) | u64::from(counted)
        })
    }

    fn arm(&self, queue: &mut Queue) {
        let mut next_us = queue.next_expiration(self.now());
        // Two turns are enough: an alarm that was due while it was armed is expired in the second.
        for _ in 0..2 {
            if next_us == u64::MAX {
                ALARM_CONTROL.write(0);
                return;
            }
            let wait_us = next_us.saturating_sub(self.now()).clamp(1, LONGEST_ALARM_US);
            ALARM_CONTROL.write(0);
            ALARM_LOAD.write((wait_us * TICKS_PER_MICROSECOND) as u32);
            ALARM_CONTROL.write(ENABLE_32_BIT | ONE_SHOT);
            if self.now() < next_us {
                return;
            }
            next_us = queue.next_expiration(self.now());
        }
    }

    fn interrupt(&self) {
        critical_section::with(|token| {
            if COUNTER_RAW.read() & 1 != 0 {
                COUNTER_CLEAR.write(1);
                self.wraps.fetch_add(1, Ordering::Relaxed);
            }
            ALARM_CLEAR.write(1);
            self.arm(&mut self.queue.borrow_ref_mut(token));
        });
    }
}

impl Driver for Clock {
    fn now(&self) -> u64 {
        self.ticks() / TICKS_PER_MICROSECOND
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|token| {
            let mut queue = self.queue.borrow_ref_mut(token);
            if queue.schedule_wake(at, waker) {
                self.arm(&mut queue);
            }
        });
    }
}

#[unsafe(no_mangle)]
extern "C" fn DUAL_TIMER() {
    CLOCK.interrupt();
}
