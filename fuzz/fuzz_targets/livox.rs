//! Datagrams of a Livox, two bytes of length before each.
#![no_main]

use std::sync::OnceLock;

use floorguard_fuzz::pieces;
use floorguard_tests::fuzz::{decoders, livox_datagrams};
use libfuzzer_sys::fuzz_target;

static RIGHT: OnceLock<Vec<Vec<u8>>> = OnceLock::new();

fuzz_target!(|data: &[u8]| {
    _ = decoders::livox(&pieces(data), RIGHT.get_or_init(livox_datagrams));
});
