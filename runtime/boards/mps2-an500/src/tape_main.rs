//! Firmware that plays a tape from memory instead of listening to devices: deterministic, on virtual time.
//!
//! The emulator loads the tape to the board's PSRAM; the program prints the fingerprint of everything that the robot
//! put out, and what each kind of work cost in instructions.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]
#![allow(missing_docs)]

#[cfg(target_os = "none")]
mod register;
#[cfg(target_os = "none")]
mod robot;
#[cfg(target_os = "none")]
mod tape;

#[cfg(target_os = "none")]
mod start {
    use cortex_m_rt::{entry, exception};
    use cortex_m_semihosting::{debug, hprintln};

    use crate::robot;
    use crate::tape::{play, stopwatch};

    /// No interrupt is used: every vector leads to the default handler.
    #[unsafe(link_section = ".vector_table.interrupts")]
    #[unsafe(no_mangle)]
    static __INTERRUPTS: [unsafe extern "C" fn(); 32] = [unexpected; 32];

    unsafe extern "C" {
        #[link_name = "DefaultHandler"]
        fn unexpected();
    }

    #[entry]
    fn main() -> ! {
        stopwatch::start();
        let played = match robot::tape() {
            Some(tape) => play::play(tape),
            None => {
                hprintln!("there is no tape at {:#010x}: load one with -device loader", robot::TAPE_AT);
                false
            }
        };
        debug::exit(if played { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
        loop {
            cortex_m::asm::wfi();
        }
    }

    #[exception]
    unsafe fn DefaultHandler(number: i16) {
        hprintln!("unexpected interrupt {}", number);
        debug::exit(debug::EXIT_FAILURE);
    }

    #[exception]
    unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
        hprintln!("hard fault at {:#010x}", frame.pc());
        debug::exit(debug::EXIT_FAILURE);
        loop {
            cortex_m::asm::wfi();
        }
    }

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo) -> ! {
        hprintln!("{}", info);
        debug::exit(debug::EXIT_FAILURE);
        loop {
            cortex_m::asm::wfi();
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("this is firmware; run it with: cargo xtask firmware");
}
