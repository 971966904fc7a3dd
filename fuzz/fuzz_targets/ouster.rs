//! Datagrams of an Ouster, two bytes of length before each; afterwards its right datagrams must be understood.
#![no_main]

use floorguard_fuzz::{ouster, pieces};
use floorguard_tests::fuzz::decoders;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let (beams, right) = ouster();
    _ = decoders::ouster(beams, &pieces(data), right);
});
