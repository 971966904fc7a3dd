//! A recording.
#![no_main]

use floorguard_tests::fuzz::files;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = files::recording(data.to_vec());
});
