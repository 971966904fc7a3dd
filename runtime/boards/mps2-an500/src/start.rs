//! Start-up, faults, and what happens when everything else has failed.

use cortex_m_rt::{entry, exception};
use cortex_m_semihosting::{debug, hprintln};
use embassy_executor::Spawner;
use embassy_time::{Duration, Instant, Timer};

use crate::{clock, executor};

#[entry]
fn main() -> ! {
    clock::start();
    let guard = executor::start_guard();
    guard.spawn(tick().unwrap());
    executor::run_thread(|spawner: Spawner| spawner.spawn(check().unwrap()))
}

#[embassy_executor::task]
async fn tick() {
    loop {
        Timer::after(Duration::from_millis(10)).await;
    }
}

#[embassy_executor::task]
async fn check() {
    let start = Instant::now();
    Timer::after(Duration::from_millis(250)).await;
    let begin = clock::ticks();
    for _ in 0..1000 {
        cortex_m::asm::nop();
    }
    hprintln!("waited {} us, {} ticks", start.elapsed().as_micros(), clock::ticks() - begin);
    debug::exit(debug::EXIT_SUCCESS);
}

#[exception]
unsafe fn DefaultHandler(number: i16) {
    hprintln!("unexpected interrupt {}", number);
    debug::exit(debug::EXIT_FAILURE);
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    hprintln!("{}", info);
    debug::exit(debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::wfi();
    }
}
