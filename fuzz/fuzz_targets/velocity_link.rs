//! Frames of a program that drives the robot.
#![no_main]

use floorguard_fuzz::pieces;
use floorguard_tests::fuzz::decoders;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let timed = |frame: Vec<u8>| (frame.first().map_or(0, |pause| u64::from(*pause) * 500), frame);
    _ = decoders::velocity_link(&pieces(data).into_iter().map(timed).collect::<Vec<_>>());
});
