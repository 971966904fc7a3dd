//! Bytes of a lidar that speaks SCIP; afterwards the driver must find back into step.
#![no_main]

use floorguard_fuzz::scanning_corpus;
use floorguard_tests::fuzz::scanning;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = scanning::scip(scanning_corpus(), data, data.len() % 16 == 0);
});
