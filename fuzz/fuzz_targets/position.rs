//! The position packet of the lidar, and the sentence in it.
#![no_main]

use floorguard_tests::fuzz::decoders;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = decoders::position(data) + decoders::sentence(data);
});
