//! The printed example of a binary telegram, and one that a sensor sent.

use std::vec::Vec;

use super::{Frame, Framer, ScanTelegram, TELEGRAM_BYTES, TelegramError};

/// A whole telegram of a TiM5xx with firmware of 2021: the first one of `test.pcapng` of `SICKAG/sick_scan_xd` (Apache-2.0).
const RECORDED: &[u8] = include_bytes!("tim5xx.bin");

/// The maker's telegram listing, `sRA LMDscandata`, binary: 21 distances from 10° in steps of 0.5°, with the bytes behind them.
const PRINTED: &[u8] = b"sRA LMDscandata \0\x01\0\x01\0\x89\xA2\x7F\0\0\x03\x43\x03\x47\x27\x47\x7B\xA9\x27\x47\x81\x3B\0\0\x07\0\0\0\0\0\x13\x88\0\0\x01\x68\0\0\0\x01DIST1\x3F\x80\0\0\0\0\0\0\
    \0\x01\x86\xA0\x13\x88\0\x15\x08\x93\x08\x95\x08\xAF\x08\xB3\x08\xB0\x08\xA4\x08\xB0\x08\xBF\x08\xB9\x08\xBA\x08\xD0\x08\xD3\x08\xCF\x08\xDE\x08\xEB\x08\xE3\x08\xFE\x08\xEC\x09\x03\x08\xFD\x08\xFD\0\0\0\0\0\0\0\0\0\0\0\0";

/// What a stream holds, as copies of its frames: `None` for a refused one.
fn frames(bytes: &[u8]) -> Vec<Option<Vec<u8>>> {
    let mut framer = Framer::default();
    let mut found = Vec::new();
    for byte in bytes {
        match framer.byte(*byte) {
            Some(Frame::Text(text) | Frame::Binary(text)) => found.push(Some(text.to_vec())),
            Some(Frame::Refused) => found.push(None),
            None => {}
        }
    }
    found
}

#[test]
fn printed_binary_example_is_understood() {
    let telegram = ScanTelegram::new_binary(PRINTED).unwrap();
    assert_eq!((telegram.status, telegram.scan, telegram.begun_us), (0, 0x347, 0x2747_7BA9));
    assert_eq!(
        (telegram.first_angle, telegram.step, telegram.count, telegram.unit_mm),
        (100_000, 5_000, 21, 1)
    );
    let distances: Vec<u32> = telegram.distances().collect();
    assert_eq!((distances.len(), distances[0], distances[20]), (21, 0x893, 0x8FD));
}

/// Expected are the numbers that Python's `struct` reads from the recording.
#[test]
fn recorded_telegram_is_understood() {
    let found = frames(RECORDED);
    let [Some(content)] = &found[..] else { panic!("one telegram") };
    let telegram = ScanTelegram::new_binary(content).unwrap();
    assert_eq!((telegram.status, telegram.scan, telegram.begun_us), (0, 44_981, 3_014_133_219));
    assert_eq!((telegram.first_angle, telegram.step, telegram.count), (-450_000, 3_333, 811));
    let distances: Vec<u32> = telegram.distances().collect();
    assert_eq!(distances[..4], [626, 657, 616, 2], "2 stands for no return");
    assert_eq!(distances[400..404], [1_266, 1_273, 1_301, 1_296]);
    assert_eq!((distances.iter().sum::<u32>(), distances.len()), (869_400, 811));
}

#[test]
fn damaged_binary_telegrams_are_refused() {
    for (at, value, error) in [
        (0, b'x', TelegramError::Form),
        (52, 9, TelegramError::Form),
        (56, b'R', TelegramError::Channel),
        (61, 0x41, TelegramError::Channel),
        (76, 0xFF, TelegramError::Values { found: 27, announced: 255 }),
    ] {
        let mut bytes = PRINTED.to_vec();
        bytes[at] = value;
        assert_eq!(ScanTelegram::new_binary(&bytes).map(|_| ()), Err(error), "byte {at}");
    }
    for length in 0..PRINTED.len() - 12 {
        assert!(ScanTelegram::new_binary(&PRINTED[..length]).is_err(), "{length} bytes");
    }
}

/// A flipped bit, a length beyond all, a cut one: nothing of them is used, and the next whole one is found.
#[test]
fn framer_finds_the_next_telegram() {
    let mut flipped = RECORDED.to_vec();
    flipped[2_000] ^= 1;
    assert_eq!(
        frames(&[&flipped, RECORDED].concat()).iter().map(Option::is_some).collect::<Vec<_>>(),
        [false, true]
    );
    let long = [&[2, 2, 2, 2][..], &(TELEGRAM_BYTES as u32 + 1).to_be_bytes(), RECORDED].concat();
    assert_eq!(frames(&long).iter().map(Option::is_some).collect::<Vec<_>>(), [false, true]);
    let cut = [&RECORDED[..900], RECORDED, RECORDED, RECORDED].concat();
    assert!(frames(&cut).iter().flatten().filter(|found| found.len() == RECORDED.len() - 9).count() >= 2);
    let mixed = [&b"noise\x02sEA LMDscandata 1\x03"[..], RECORDED, b"\x02sFA 8\x03"].concat();
    let found: Vec<usize> = frames(&mixed).iter().flatten().map(Vec::len).collect();
    assert_eq!(found, [17, RECORDED.len() - 9, 5]);
}
