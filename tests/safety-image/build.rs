//! Link arguments: no start-up code, one entry, everything that is not reached thrown away.
fn main() {
    if std::env::var("TARGET").is_ok_and(|target| target.starts_with("thumb")) {
        println!("cargo:rustc-link-arg-bins=--entry=entry");
        println!("cargo:rustc-link-arg-bins=--gc-sections");
        println!("cargo:rustc-link-arg-bins=-Ttext=0x20000");
    }
    println!("cargo:rerun-if-changed=build.rs");
}
