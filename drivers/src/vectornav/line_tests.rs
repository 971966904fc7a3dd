//! Frames and sentences against what the maker's programming library 1.2 writes and takes for valid.

use std::vec::Vec;

use floorguard_types::time::Stamp;
use proptest::prelude::*;

use super::*;

/// Numbers that binary fractions hold exactly; the checksum is the library's, which also finds the frame valid and of this length.
pub(super) const FRAME: [u8; 42] = [
    0xFA, 0x05, 0x21, 0x01, 0x00, 0x08, 0x79, 0xDF, 0x0D, 0x86, 0x48, 0x70, 0x00, 0x00, 0x00, 0x00, 0x80,
    0x3E, 0x00, 0x00, 0x00, 0xBF, 0x00, 0x00, 0x00, 0x3D, 0x00, 0x00, 0xC0, 0x3F, 0x00, 0x00, 0x00, 0xBE,
    0x00, 0x00, 0x1D, 0xC1, 0x40, 0x00, 0x49, 0xCC,
];

#[derive(Clone, Debug, PartialEq)]
enum Found {
    Frame(Measurement),
    Sentence(Vec<u8>),
}

fn received(portions: &[&[u8]]) -> (Vec<Found>, LineCounters) {
    let (mut receiver, mut found) = (LineReceiver::default(), Vec::new());
    for portion in portions {
        receiver.push(portion, Stamp::ZERO, |message| {
            found.push(match message {
                Message::Frame(payload) => Found::Frame(Measurement::decode(payload).unwrap()),
                Message::Sentence(words) => Found::Sentence(words.to_vec()),
            });
        });
    }
    (found, receiver.counters())
}

fn sentences(bytes: &[u8]) -> Vec<Vec<u8>> {
    let words = |found| match found {
        Found::Sentence(words) => Some(words),
        Found::Frame(_) => None,
    };
    received(&[bytes]).0.into_iter().filter_map(words).collect()
}

#[test]
fn frame_of_the_makers_library() {
    let expected = Measurement {
        since_start_ns: 123_456_789_012_345,
        angular_radps: [0.25, -0.5, 0.031_25],
        linear_mps2: [1.5, -0.125, -9.812_5],
        saturation: 0x40,
    };
    let (found, counters) = received(&[&FRAME]);
    assert_eq!(found, [Found::Frame(expected)]);
    assert_eq!((counters.frames, counters.skipped), (1, 0));
    assert!(expected.is_saturated(), "the x axis of the gyroscope");
}

/// Magnetometer (bits 0 to 2) and barometer (bit 9) are not used: what they are driven to says nothing of the rest.
#[test]
fn saturation_of_accelerometer_and_gyroscope_counts() {
    for bit in 0..16 {
        let measurement = Measurement { saturation: 1 << bit, ..Measurement::default() };
        assert_eq!(measurement.is_saturated(), (3..9).contains(&bit), "{bit}");
    }
}

/// Sentences that the maker's library writes, that its interface documents print, and that devices were seen to answer.
#[test]
fn published_sentences() {
    for text in [
        "VNWRG,75,3,8,5,121,800*6C",
        "VNWRG,75,3,4,5,121,800*60",
        "VNWRG,75,3,4,5,121,800*5DEC",
        "VNWRG,06,0*6C",
        "VNRRG,01*72",
        "VNRRG,44*73",
        "VNRRG,04,3.1.0.0*77",
        "VNASY,0*4F",
        "VNASY,1*4E",
        "VNWRG,75,0,4,01,0128*7A",
    ] {
        let (words, sum) = text.split_once('*').unwrap();
        let bytes = std::format!("${text}\r\n");
        assert_eq!(sentences(bytes.as_bytes()), [words.as_bytes()], "{text}");
        if sum.len() == 2 {
            assert_eq!(sentence(words.as_bytes()).unwrap(), bytes.as_bytes());
        }
        let damaged = bytes.replacen("VN", "VM", 1);
        assert!(sentences(damaged.as_bytes()).is_empty(), "{damaged}");
    }
    assert_eq!(sentence(&[b'x'; 59]), None);
    assert!(sentence(&[b'x'; 58]).is_some());
}

/// A false beginning of either kind costs nothing behind it but the bytes that it takes for its own.
#[test]
fn false_beginnings_cost_one_frame_at_most() {
    for noise in
        [&b"\xFA\x05\x21"[..], b"$VN", b"$$$", b"\xFA\x05\x21\x01\x00\x08", b"$VNRRG,1*00\r\n", b"\x00\xFF"]
    {
        let bytes = [noise, &FRAME.repeat(4), &sentence(b"VNASY,0").unwrap()].concat();
        let (found, _) = received(&[&bytes]);
        let frames = found.iter().filter(|found| matches!(found, Found::Frame(_))).count();
        assert!(frames >= 3, "{noise:x?}: {frames}");
        assert_eq!(found.last(), Some(&Found::Sentence(b"VNASY,0".to_vec())), "{noise:x?}");
    }
}

#[test]
fn frame_that_stays_unfinished_is_given_up() {
    let (mut receiver, mut count) = (LineReceiver::default(), 0);
    receiver.push(&FRAME[..20], Stamp::ZERO, |_| count += 1);
    receiver.push(&FRAME, Stamp::from_micros(30_000), |_| count += 1);
    assert_eq!((count, receiver.counters().gaps), (1, 1));
}

#[test]
fn longest_text_fits_longer_is_noise() {
    let of_length = |words: usize| {
        let words = std::vec![b'1'; words];
        let sum = words.iter().fold(0_u8, |sum, byte| sum ^ byte);
        [b"$", &words[..], std::format!("*{sum:02X}\r\n").as_bytes(), &FRAME].concat()
    };
    let fitting = SENTENCE_MAX - "$*00\r\n".len();
    assert_eq!(received(&[&of_length(fitting)]).0.len(), 2);
    assert_eq!(received(&[&of_length(fitting + 1)]).0.len(), 1);
}

#[test]
fn infinite_number_is_refused() {
    for at in [14, 18, 22, 26, 30, 34] {
        for number in [f32::NAN, f32::INFINITY] {
            let mut payload: [u8; 34] = FRAME[6..40].try_into().unwrap();
            payload[at - 6..at - 2].copy_from_slice(&number.to_le_bytes());
            assert_eq!(Measurement::decode(&payload), Err(NotFinite), "{at}");
        }
    }
}

proptest! {
    #[test]
    fn portions_do_not_matter(
        bytes in proptest::collection::vec(
            prop_oneof![Just(0xFA_u8), Just(0x05), Just(b'$'), Just(b'*'), Just(b'\r'), Just(b'\n'), any::<u8>()],
            0..400,
        ),
        cut in 0_usize..400,
    ) {
        let mut receiver = LineReceiver::default();
        let mut count = |portions: &[&[u8]]| {
            receiver = LineReceiver::default();
            let mut lengths = Vec::new();
            for portion in portions {
                receiver.push(portion, Stamp::ZERO, |message| lengths.push(match message {
                    Message::Frame(_) => 42,
                    Message::Sentence(words) => words.len(),
                }));
            }
            (lengths, receiver.counters())
        };
        let whole = count(&[&bytes]);
        let (a, b) = bytes.split_at(cut.min(bytes.len()));
        prop_assert_eq!(count(&[a, b]), whole);
    }

    #[test]
    fn any_flipped_bit_of_a_frame_is_noticed(bit in 48_usize..336) {
        let mut damaged = FRAME;
        damaged[bit / 8] ^= 1 << (bit % 8);
        prop_assert!(received(&[&damaged]).0.is_empty());
    }
}
