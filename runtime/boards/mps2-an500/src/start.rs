//! Start-up, faults, and what happens when everything else has failed.

use core::arch::global_asm;

use cortex_m_rt::{entry, exception};
use floorguard_board_support::{robot, share, start_perception_ring};
use floorguard_runtime::black_box_log::RestartCause;
use floorguard_runtime::configuration::RobotConfiguration;
use static_cell::StaticCell;

use crate::crash_record;
use crate::faults::break_perception;
use crate::robot::{robot_for, tape};
use crate::wired::{options, start_guard_ring};
use crate::{clock, executor, log, stack_guard, watchdog};

// What no device writes lies where the chip has its tightly coupled memory, so that both images have the same room.
global_asm!(
    ".section .text.__pre_init, \"ax\"",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "b __zero_dtcm",
);

/// A guard that decides nothing for this long is dead, milliseconds; after twice as long the machine is reset.
const WATCHDOG_MS: u32 = 100;

#[unsafe(link_section = ".dtcm.robot")]
static ROBOT: StaticCell<RobotConfiguration> = StaticCell::new();

#[entry]
fn main() -> ! {
    stack_guard::start();
    clock::start();
    // From here on, whatever hangs is ended.
    watchdog::start(WATCHDOG_MS);
    let options = options::read();
    let robot = ROBOT.init(tape().and_then(robot_for).unwrap_or_else(robot));
    let shared = match share(robot) {
        Ok(shared) => shared,
        // Without the reason, whose formatting takes 14 KiB and which nobody would see: the build has asked the guard.
        Err(_) => panic!("the guard refuses the robot"),
    };
    start_guard_ring(executor::start_guard(), shared, robot, options);
    executor::run_thread(!options.never_sleep, |spawner| {
        start_perception_ring(spawner, shared, robot);
        log::start(spawner, shared);
        if let Some(fault) = options.fault {
            spawner.spawn(break_perception(shared, fault).unwrap());
        }
    })
}

#[exception]
unsafe fn DefaultHandler(number: i16) {
    crash_record::die(RestartCause::Interrupt, number as u32);
}

#[exception]
unsafe fn NonMaskableInt() {
    // The watchdog's first expiry; its second one resets the machine.
    crash_record::die(RestartCause::Watchdog, 0);
}

#[exception]
unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
    // The frame may lie beyond the end of the stack: it is not read. SAFETY: the register can always be read.
    let status = unsafe { (*cortex_m::peripheral::SCB::PTR).cfsr.read() };
    crash_record::die(RestartCause::Fault, status)
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    crash_record::die(RestartCause::Panic, info.location().map_or(0, |location| location.line()))
}
