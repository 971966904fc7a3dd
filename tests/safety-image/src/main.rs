//! The safety image: every public stage of core and drivers as a root, nothing else.
//!
//! It is linked and read, never run. A panic that survives optimisation keeps `floorguard_panics` in the image, and
//! the audit reports who calls it.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]
#![allow(missing_docs)]

#[cfg(target_os = "none")]
mod bases;
#[cfg(target_os = "none")]
mod drivers;
#[cfg(target_os = "none")]
mod perception;
#[cfg(target_os = "none")]
mod roots;

#[cfg(target_os = "none")]
#[panic_handler]
fn floorguard_panics(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("this image is built for the target and read by `cargo xtask audit`");
}
