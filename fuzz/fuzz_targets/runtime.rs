//! The whole robot on the virtual clock: the bytes choose the world and its faults.
#![no_main]

use floorguard_fuzz::on_a_large_stack;
use floorguard_tests::campaign::Random;
use floorguard_tests::fuzz::worlds;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    on_a_large_stack(|| _ = worlds::world(&mut Random::given(data)));
});
