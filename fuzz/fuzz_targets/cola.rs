//! Bytes of a SICK TiM; afterwards the driver must find back into step.
#![no_main]

use floorguard_tests::fuzz::{cola_scans, decoders};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = decoders::cola(data, 1 + data.len() % 997, &cola_scans()[0]);
});
