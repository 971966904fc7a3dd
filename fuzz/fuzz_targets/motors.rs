//! Frames and lines of motor controllers, orders and time between them.
#![no_main]

use std::sync::OnceLock;

use floorguard_tests::campaign::Random;
use floorguard_tests::fuzz::motors::{self, MotorTalks};
use libfuzzer_sys::fuzz_target;

static TALKS: OnceLock<MotorTalks> = OnceLock::new();

fuzz_target!(|data: &[u8]| {
    let talks = TALKS.get_or_init(motors::motor_talks);
    _ = motors::motors(talks, &mut Random::given(data));
});
