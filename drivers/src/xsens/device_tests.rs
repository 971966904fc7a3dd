//! The start-up and the known defects of the book, Xsens MTi, against a device played by hand.

use floorguard_types::sensing::ImuSample;
use floorguard_types::time::Stamp;
use proptest::prelude::*;
use std::vec::Vec;

use super::start_up::profile;
use super::{Device, DeviceConfiguration, DeviceEvent, DeviceFault, DevicePhase, FrameReceiver, encode};

const PROFILE: [u8; 24] = profile(100);

fn at(ms: u64) -> Stamp {
    Stamp::from_micros(ms * 1_000)
}

/// Frames sent at a moment.
fn sent(device: &mut Device, ms: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    device.poll(at(ms), &mut |frame| bytes.extend_from_slice(frame));
    bytes
}

fn answer(device: &mut Device, ms: u64, id: u8, data: &[u8]) {
    device.push(&encode(id, data).unwrap(), at(ms), |_| {});
}

fn samples(device: &mut Device, ms: u64, bytes: &[u8]) -> Vec<ImuSample> {
    let mut found = Vec::new();
    device.push(bytes, at(ms), |event| {
        if let DeviceEvent::Sample(sample) = event {
            found.push(sample);
        }
    });
    found
}

/// Everything but the orientation, with status bits.
fn data_frame(counter: u16, status: u32) -> Vec<u8> {
    let mut data = std::vec![0x10, 0x20, 2];
    data.extend(counter.to_be_bytes());
    for id in [0x40_u8, 0x80] {
        data.extend([id, 0x20, 12]);
        data.extend([0; 12]);
    }
    data.extend([0xE0, 0x20, 4]);
    data.extend(status.to_be_bytes());
    encode(0x36, &data).unwrap().to_vec()
}

/// A device that answered everything and measures; the start took until `ms`.
fn measuring(ms: u64) -> Device {
    let mut device = Device::new(115_200);
    sent(&mut device, ms);
    answer(&mut device, ms, 0x31, &[]);
    sent(&mut device, ms);
    answer(&mut device, ms, 0x01, &[3, 0x78, 0, 0x2A]);
    sent(&mut device, ms);
    answer(&mut device, ms, 0x1D, b"MTi-30-2A8G4");
    sent(&mut device, ms);
    answer(&mut device, ms, 0xC1, &PROFILE);
    sent(&mut device, ms);
    answer(&mut device, ms, 0x11, &[]);
    assert_eq!(device.phase(), DevicePhase::Measuring);
    device
}

/// The published frames, in their order, while data keep coming.
#[test]
fn start_up() {
    let mut device = Device::new(115_200);
    assert_eq!(sent(&mut device, 0), [0xFA, 0xFF, 0x30, 0x00, 0xD1]);
    assert_eq!(samples(&mut device, 5, &data_frame(1, 1)).len(), 1);
    assert_eq!(sent(&mut device, 50), []);
    assert_eq!(sent(&mut device, 100), [0xFA, 0xFF, 0x30, 0x00, 0xD1]);
    answer(&mut device, 110, 0x31, &[]);
    assert_eq!(sent(&mut device, 110), [0xFA, 0xFF, 0x00, 0x00, 0x01]);
    answer(&mut device, 120, 0x01, &[3, 0x78, 0, 0x2A]);
    assert_eq!(device.identifier(), 0x0378_002A);
    assert_eq!(sent(&mut device, 120), [0xFA, 0xFF, 0x1C, 0x00, 0xE5]);
    answer(&mut device, 130, 0x1D, b"MTi-30");
    let published = [
        0xFA, 0xFF, 0xC0, 0x18, 0x10, 0x20, 0xFF, 0xFF, 0x10, 0x60, 0xFF, 0xFF, 0x20, 0x10, 0x00, 0x64, 0x40,
        0x20, 0x00, 0x64, 0x80, 0x20, 0x00, 0x64, 0xE0, 0x20, 0xFF, 0xFF, 0x33,
    ];
    assert_eq!(sent(&mut device, 130), published);
    answer(&mut device, 140, 0xC1, &PROFILE);
    assert_eq!(sent(&mut device, 140), [0xFA, 0xFF, 0x10, 0x00, 0xF1]);
    answer(&mut device, 150, 0x11, &[]);
    assert_eq!(device.phase(), DevicePhase::Measuring);
    assert_eq!((device.fault(), device.counters().starts), (None, 1));
    assert_eq!(sent(&mut device, 1_000), []);
}

/// One reset, and then two seconds of patience: a device that is reset while it starts never comes up.
#[test]
fn no_answer_causes_one_reset_per_cycle() {
    let mut device = Device::new(115_200);
    let mut requests = Vec::new();
    for ms in (0..5_200).step_by(10) {
        requests.extend(sent(&mut device, ms).chunks_exact(5).map(|frame| (ms, frame[2])));
    }
    let resets: Vec<u64> = requests.iter().filter(|(_, id)| *id == 0x40).map(|(ms, _)| *ms).collect();
    assert_eq!(resets, [500, 3_100]);
    let asked = requests.iter().filter(|(ms, id)| (600..2_600).contains(ms) && *id == 0x30).count();
    assert_eq!(asked, 20);
    assert_eq!(device.counters().starts, 2);
}

#[test]
fn waking_device_is_acknowledged_and_configured() {
    for mut device in [Device::new(115_200), measuring(0)] {
        sent(&mut device, 1);
        answer(&mut device, 200, 0x3E, &[]);
        let bytes = sent(&mut device, 201);
        assert_eq!(bytes, [0xFA, 0xFF, 0x3F, 0x00, 0xC2, 0xFA, 0xFF, 0x30, 0x00, 0xD1]);
        answer(&mut device, 202, 0x31, &[]);
        assert_eq!(device.phase(), DevicePhase::Identifying);
    }
}

#[test]
fn silence_starts_over_and_lost_samples_are_counted() {
    let mut device = measuring(0);
    for (ms, counter) in [(0, 65_534), (10, 65_535), (20, 2)] {
        samples(&mut device, ms, &data_frame(counter, 3));
    }
    assert_eq!(device.counters().lost_samples, 2);
    assert_eq!(sent(&mut device, 1_020), []);
    assert_eq!(sent(&mut device, 1_021), [0xFA, 0xFF, 0x30, 0x00, 0xD1]);
    assert_eq!((device.phase(), device.counters().starts), (DevicePhase::GoingToConfig, 2));
}

/// A counter that stands still, and data without what is needed, are silence.
#[test]
fn frozen_and_incomplete_data_start_over() {
    let without_rate = encode(0x36, &[0x10, 0x20, 2, 0, 1]).unwrap();
    for frame in [data_frame(7, 3), without_rate.to_vec()] {
        let mut device = measuring(0);
        for ms in (0..1_100).step_by(10) {
            samples(&mut device, ms, &frame);
            sent(&mut device, ms);
        }
        assert_eq!(device.phase(), DevicePhase::GoingToConfig);
        assert!(device.counters().repeated_samples + device.counters().incomplete > 100);
    }
}

/// A known defect: the acknowledgement never comes, but data do.
#[test]
fn silent_device_is_used_unconfigured() {
    let mut device = Device::new(115_200);
    let mut delivered = 0;
    for step in 0..400_u16 {
        delivered += samples(&mut device, u64::from(step) * 10, &data_frame(step, 3)).len();
        sent(&mut device, u64::from(step) * 10);
    }
    assert_eq!(delivered, 400);
    assert_eq!((device.phase(), device.fault()), (DevicePhase::Measuring, Some(DeviceFault::NoAnswer)));
}

#[test]
fn wrong_product_is_refused_and_retried() {
    let mut device = Device::new(115_200);
    sent(&mut device, 0);
    answer(&mut device, 1, 0x31, &[]);
    answer(&mut device, 2, 0x01, &[0; 4]);
    answer(&mut device, 3, 0x1D, b"MTi-G-710");
    assert_eq!((device.phase(), device.fault()), (DevicePhase::Refused, Some(DeviceFault::WrongProduct)));
    assert_eq!(sent(&mut device, 4), []);
    assert_eq!(sent(&mut device, 5_003), []);
    assert_eq!(sent(&mut device, 5_004), [0xFA, 0xFF, 0x30, 0x00, 0xD1]);
}

/// Slower is accepted and reported; other items, or other formats, are not used.
#[test]
fn the_echo_is_compared() {
    let phase_after = |change: fn(&mut [u8])| {
        let mut device = measuring(0);
        device.push(&encode(0x3E, &[]).unwrap(), at(1), |_| {});
        answer(&mut device, 1, 0x31, &[]);
        answer(&mut device, 1, 0x01, &[0; 4]);
        answer(&mut device, 1, 0x1D, b"MTi-30");
        let mut echo = PROFILE;
        change(&mut echo);
        let mut reported = 0;
        device.push(&encode(0xC1, &echo).unwrap(), at(1), |event| {
            reported += u32::from(event == DeviceEvent::OtherConfiguration);
        });
        (device.phase(), device.fault(), reported)
    };
    let going = DevicePhase::GoingToMeasurement;
    assert_eq!(phase_after(|_| {}), (going, None, 0));
    assert_eq!(phase_after(|echo| echo[11] = 50), (going, Some(DeviceFault::LowerRate), 1));
    let refused = (DevicePhase::Refused, Some(DeviceFault::OtherItems), 1);
    assert_eq!(phase_after(|echo| echo[13] = 0x23), refused);
    assert_eq!(phase_after(|echo| echo[11] = 101), refused);
    assert_eq!(phase_after(|echo| echo[11] = 0), refused);
}

/// After error 0x29 less is asked for, and not for ever.
#[test]
fn slow_line_lowers_rate_then_gives_up() {
    let mut device = measuring(0);
    let mut codes = Vec::new();
    for rate_hz in [50, 25] {
        device.push(&encode(0x42, &[0x29]).unwrap(), at(1), |event| codes.push(event));
        assert_eq!((device.rate_hz(), device.phase()), (rate_hz, DevicePhase::GoingToConfig));
    }
    device.push(&encode(0x42, &[0x29]).unwrap(), at(1), |event| codes.push(event));
    assert_eq!(codes, [DeviceEvent::Error(0x29); 3]);
    assert_eq!((device.phase(), device.fault()), (DevicePhase::Refused, Some(DeviceFault::LineTooSlow)));
}

#[test]
fn rejected_configuration_is_not_repeated_at_once() {
    let mut device = Device::new(115_200);
    for (id, data) in [(0x31, &[][..]), (0x01, &[0; 4]), (0x1D, b"MTi-30"), (0x42, &[0x21])] {
        sent(&mut device, 0);
        answer(&mut device, 0, id, data);
    }
    assert_eq!((device.phase(), device.fault()), (DevicePhase::Refused, Some(DeviceFault::Rejected(0x21))));
}

#[test]
fn doubtful_samples_are_marked() {
    let suspect = |status: u32| samples(&mut measuring(0), 1, &data_frame(1, status))[0].suspect;
    assert!(!suspect(0x0180_0003));
    assert!(suspect(2), "the self-test failed");
    for bit in [8, 9, 10, 11, 12, 13, 14, 15, 16, 19] {
        assert!(suspect(1 << bit | 3), "clipping, bit {bit}");
    }
    let mut without_status = data_frame(1, 3);
    without_status[3] -= 7;
    without_status.truncate(without_status.len() - 8);
    let sum = without_status[1..].iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    without_status.push(sum.wrapping_neg());
    assert!(samples(&mut measuring(0), 1, &without_status)[0].suspect, "nobody vouches for it");
}

/// Quaternions in another local frame, or from a filter that is not valid, are no orientation.
#[test]
fn orientation_is_valid_east_north_up() {
    let orientation = |id_low: u8, status: u8| {
        let mut data = data_frame(1, u32::from(status));
        data.truncate(data.len() - 1);
        data.drain(..4);
        data.extend([0x20, id_low, 16, 0x3F, 0x80, 0, 0]);
        data.extend([0; 12]);
        samples(&mut measuring(0), 1, &encode(0x36, &data).unwrap())[0].orientation
    };
    assert_eq!(orientation(0x10, 3), Some([1.0, 0.0, 0.0, 0.0]));
    assert_eq!(orientation(0x14, 3), None);
    assert_eq!(orientation(0x10, 1), None);
}

#[test]
fn stamp_falls_back_to_arrival_less_latency() {
    let configuration =
        DeviceConfiguration { baud: 100_000, latency_us: 700, ..DeviceConfiguration::default() };
    let mut device = Device::with_configuration(configuration);
    let frame = data_frame(1, 3);
    let stamp = samples(&mut device, 100, &frame)[0].stamp;
    assert_eq!(stamp.as_micros(), 100_000 - 700 - 100 * frame.len() as u64);
}

/// Pieces of a line's life: right frames of all kinds, and bytes of no kind.
fn any_piece() -> impl Strategy<Value = Vec<u8>> {
    let ids = std::vec![0x01_u8, 0x11, 0x1D, 0x31, 0x36, 0x3E, 0x41, 0x42, 0x43, 0xC1];
    let frame = (proptest::sample::select(ids), proptest::collection::vec(any::<u8>(), 0..40))
        .prop_map(|(id, data)| encode(id, &data).unwrap().to_vec());
    prop_oneof![
        frame,
        proptest::collection::vec(prop_oneof![Just(0xFA_u8), Just(0xFF), any::<u8>()], 0..30),
        (any::<u16>(), any::<u32>()).prop_map(|(counter, status)| data_frame(counter, status)),
        Just(encode(0xC1, &PROFILE).unwrap().to_vec()),
        Just(encode(0x1D, b"MTi-30").unwrap().to_vec()),
    ]
}

proptest! {
    /// Any life of the line, at any times, even backwards: no panic, no request longer than the profile, no sample from
    /// the future, and a device that then behaves is measuring within ten seconds.
    #[test]
    fn any_line_is_survived(life in proptest::collection::vec((any_piece(), 0_u64..2_000, any::<bool>()), 0..60)) {
        let mut device = Device::new(115_200);
        let mut ms = 1_000;
        for (bytes, step_ms, back) in life {
            ms = if back { ms - (ms - 1_000).min(step_ms) } else { ms + step_ms };
            for sample in samples(&mut device, ms, &bytes) {
                prop_assert!(sample.stamp <= at(ms));
                prop_assert!(sample.angular_radps.iter().chain(&sample.linear_mps2).all(|number| number.is_finite()));
            }
            prop_assert!(sent(&mut device, ms).len() <= 34);
        }
        // From here on it answers everything and measures.
        let end_ms = ms + 10_000;
        let (mut measuring, mut counter) = (false, 0_u16);
        for ms in (ms..end_ms).step_by(10) {
            for request in requests(&sent(&mut device, ms)) {
                let (id, data): (u8, &[u8]) = match request {
                    0x00 => (0x01, &[1, 2, 3, 4]),
                    0x10 => (0x11, &[]),
                    0x1C => (0x1D, b"MTi-30"),
                    0x30 => (0x31, &[]),
                    0x40 => (0x41, &[]),
                    0xC0 => (0xC1, &[]),
                    _ => continue,
                };
                measuring = request == 0x10;
                if id == 0xC1 {
                    let echo = profile(device.rate_hz());
                    answer(&mut device, ms, id, &echo);
                } else {
                    answer(&mut device, ms, id, data);
                }
            }
            if measuring {
                counter = counter.wrapping_add(1);
                samples(&mut device, ms, &data_frame(counter, 3));
            }
        }
        prop_assert_eq!(device.phase(), DevicePhase::Measuring);
    }

    /// However a stream is cut, the same samples with the same numbers come out.
    #[test]
    fn portions_do_not_matter(
        pieces in proptest::collection::vec(any_piece(), 0..30),
        sizes in proptest::collection::vec(1_usize..90, 1..20),
    ) {
        let stream = pieces.concat();
        let whole = samples(&mut Device::new(115_200), 50, &stream);
        let mut device = Device::new(115_200);
        let (mut cut, mut rest) = (Vec::new(), stream.as_slice());
        for size in sizes.iter().cycle().take(stream.len()) {
            let (portion, after) = rest.split_at((*size).min(rest.len()));
            cut.extend(samples(&mut device, 50, portion));
            rest = after;
        }
        prop_assert_eq!(cut, whole);
    }
}

/// Identifiers of the frames that were sent.
fn requests(bytes: &[u8]) -> Vec<u8> {
    let mut found = Vec::new();
    FrameReceiver::new().push(bytes, Stamp::ZERO, |message, _| found.push(message.id));
    found
}

#[test]
fn warnings_and_frames_are_counted() {
    let mut device = measuring(1_000);
    let before = device.frames().frames;
    answer(&mut device, 1_010, 0x43, &[1]);
    assert_eq!((device.counters().warnings, device.phase()), (1, DevicePhase::Measuring));
    assert_eq!((before, device.frames().frames), (5, 6));
}

/// The answer to a reset is waited for no longer than until it comes.
#[test]
fn acknowledged_reset_continues_at_once() {
    let mut device = Device::new(115_200);
    (0..5).for_each(|number| _ = sent(&mut device, 100 * number));
    assert_eq!(sent(&mut device, 500), [0xFA, 0xFF, 0x40, 0x00, 0xC1]);
    answer(&mut device, 510, 0x41, &[]);
    assert_eq!(device.phase(), DevicePhase::AfterReset);
    assert_eq!(sent(&mut device, 510), [0xFA, 0xFF, 0x30, 0x00, 0xD1]);
}
