//! Where the image begins, and how it ends.

use cortex_m_rt::{entry, exception};
use cortex_m_semihosting::{debug, hprintln};

use crate::{scans, stopwatch, sweeps};

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
    sweeps::run();
    scans::run();
    end(debug::EXIT_SUCCESS)
}

fn end(how: debug::ExitStatus) -> ! {
    debug::exit(how);
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
    end(debug::EXIT_FAILURE)
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    hprintln!("{}", info);
    end(debug::EXIT_FAILURE)
}
