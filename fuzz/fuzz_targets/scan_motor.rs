//! Frames of the motor under a lidar, and time between them.
#![no_main]

use floorguard_fuzz::scanning_corpus;
use floorguard_tests::campaign::Random;
use floorguard_tests::fuzz::scanning;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = scanning::scan_motor(scanning_corpus(), &mut Random::given(data));
});
