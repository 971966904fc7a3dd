//! Bytes of a VectorNav; afterwards what it sends must become samples.
#![no_main]

use floorguard_tests::fuzz::{decoders, messages};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = decoders::vectornav(data, 1 + data.len() % 97, &messages::vectornav_messages().concat());
});
