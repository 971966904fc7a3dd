//! Frames and lines of motor controllers, orders and time between them.
#![no_main]

use std::sync::OnceLock;

use floorguard_tests::campaign::Random;
use floorguard_tests::fuzz::motors;
use libfuzzer_sys::fuzz_target;

static FRAMES: OnceLock<[Vec<floorguard_sim::CanFrame>; 4]> = OnceLock::new();

fuzz_target!(|data: &[u8]| {
    let frames = FRAMES.get_or_init(motors::motor_frames);
    _ = motors::motors(frames, &mut Random::given(data));
});
