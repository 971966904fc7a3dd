//! `floorguard`, the program.
fn main() {}
