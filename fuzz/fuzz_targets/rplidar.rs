//! Bytes of an RPLidar; afterwards it is asked anew, and its answer must become scans.
#![no_main]

use floorguard_tests::fuzz::{decoders, rplidar_turns};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = decoders::rplidar(data, 1 + data.len() % 97, &rplidar_turns().concat());
});
