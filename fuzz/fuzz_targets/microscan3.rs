//! Datagrams of the microScan3 family, or the message that they carry.
#![no_main]

use floorguard_drivers::microscan3::Receiver;
use floorguard_fuzz::pieces;
use floorguard_tests::fuzz::{decoders, messages};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let datagrams: Vec<_> = pieces(data).into_iter().map(|piece| (1_000, piece)).collect();
    let right = messages::microscan3_datagrams(&messages::microscan3_message(40), 77);
    let (mut receiver, mut now_us) = (Receiver::new(Default::default()), 1_000_000);
    _ = decoders::microscan3(&mut receiver, &mut now_us, &datagrams, &right);
    decoders::microscan3_message(data);
});
