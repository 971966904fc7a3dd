//! Bytes of a bridge before an inertial sensor; afterwards a right frame must be understood.
#![no_main]

use floorguard_tests::fuzz::{bridged_samples, links};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = links::imu_link(data, 1 + data.len() % 97, &bridged_samples()[10..14]);
});
