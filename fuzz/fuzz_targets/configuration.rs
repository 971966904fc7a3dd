//! A `robot.toml`.
#![no_main]

use floorguard_tests::fuzz::files;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = files::configuration(data);
});
