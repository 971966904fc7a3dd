//! Bytes of the inertial sensor.
#![no_main]

use floorguard_tests::fuzz::decoders;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = decoders::xsens(data);
});
