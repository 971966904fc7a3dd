//! Datagrams of the lidar, cut where a length says so.
#![no_main]

use floorguard_fuzz::pieces;
use floorguard_tests::fuzz::decoders;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = decoders::velodyne(&pieces(data));
});
