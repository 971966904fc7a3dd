//! Datagrams of a bridge of two rings, two bytes of length before each.
#![no_main]

use floorguard_fuzz::pieces;
use floorguard_tests::fuzz::decoders;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = decoders::lidar_link(&pieces(data));
});
