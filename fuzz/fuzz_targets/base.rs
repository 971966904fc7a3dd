//! Frames of the bus, orders and time between them.
#![no_main]

use floorguard_fuzz::corpus;
use floorguard_tests::campaign::Random;
use floorguard_tests::fuzz::decoders;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = decoders::base(&corpus().can, &mut Random::given(data));
});
