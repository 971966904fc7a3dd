//! Link arguments of the image: start-up code, and which half of the common memory map applies.
fn main() {
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "none") {
        provide_device_script();
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=--nmagic");
        println!("cargo:rustc-link-arg-bins=--defsym=_board_mps2=1");
    }
    // Cargo does not follow linker scripts.
    println!("cargo:rerun-if-changed=../../../memory.x");
    println!("cargo:rerun-if-changed=build.rs");
}

/// The start-up code asks for the interrupt names of a device; ours are all defined in Rust.
fn provide_device_script() {
    let Some(folder) = std::env::var_os("OUT_DIR").map(std::path::PathBuf::from) else { return };
    if std::fs::write(folder.join("device.x"), "/* every handler is defined in Rust */\n").is_ok() {
        println!("cargo:rustc-link-search={}", folder.display());
    }
}
