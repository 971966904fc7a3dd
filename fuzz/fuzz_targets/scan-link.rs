//! Datagrams of a scanner behind a bridge, two bytes of length before each; afterwards a right scan must be understood.
#![no_main]

use floorguard_fuzz::pieces;
use floorguard_tests::fuzz::{bridged_scans, links};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    _ = links::scan_link(&pieces(data), &bridged_scans()[6..8]);
});
