//! Bytes of the safety scanner.
#![no_main]

use floorguard_fuzz::corpus;
use floorguard_tests::fuzz::decoders;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = decoders::s300(data, 1 + data.len() % 700, &corpus().scanner[..2]);
});
