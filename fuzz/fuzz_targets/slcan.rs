//! Lines of a serial CAN adaptor.
#![no_main]

use floorguard_tests::fuzz::decoders;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = decoders::slcan(data);
});
