//! The start-up with a device that answers, answers otherwise, or not at all.

use std::string::String;
use std::vec::Vec;

use floorguard_types::sensing::ImuSample;
use floorguard_types::time::Stamp;

use super::line_tests::FRAME;
use super::*;

/// What was sent within one poll.
fn polled(device: &mut Device, now_us: u64) -> String {
    let mut sent = Vec::new();
    device.poll(Stamp::from_micros(now_us), &mut |bytes| sent.extend_from_slice(bytes));
    String::from_utf8(sent).unwrap()
}

fn answer(device: &mut Device, words: &str, now_us: u64) -> Vec<DeviceEvent> {
    let mut events = Vec::new();
    let bytes = sentence(words.as_bytes()).unwrap();
    device.push(&bytes, Stamp::from_micros(now_us), |event| events.push(event));
    events
}

/// A frame of a time, with a checksum that leaves nothing behind it.
fn frame(since_start_ns: u64) -> [u8; 42] {
    let mut frame = FRAME;
    frame[6..14].copy_from_slice(&since_start_ns.to_le_bytes());
    frame[38..40].fill(0);
    let mut sum = 0_u16;
    for bit in frame[1..40].iter().flat_map(|byte| (0..8).rev().map(move |bit| (byte >> bit) & 1)) {
        let is_one = (sum >> 15) ^ u16::from(bit) == 1;
        sum = (sum << 1) ^ if is_one { 0x1021 } else { 0 };
    }
    frame[40..].copy_from_slice(&sum.to_be_bytes());
    frame
}

fn samples(device: &mut Device, bytes: &[u8], now_us: u64) -> Vec<ImuSample> {
    let mut samples = Vec::new();
    device.push(bytes, Stamp::from_micros(now_us), |event| match event {
        DeviceEvent::Sample(sample) => samples.push(sample),
        other => panic!("{other:?}"),
    });
    samples
}

/// A device that answers as its maker's documents print it.
fn started(model: &str) -> (Device, Vec<String>) {
    let (mut device, mut sent) = (Device::new(115_200), Vec::new());
    let configuration = if model.starts_with("VN-1") { "8" } else { "4" };
    let answers = [
        String::from("VNASY,0"),
        std::format!("VNRRG,01,{model}"),
        String::from("VNWRG,06,0"),
        std::format!("VNWRG,75,3,{configuration},05,0121,0800"),
        String::from("VNASY,1"),
    ];
    for (step, words) in (0_u64..).zip(&answers) {
        sent.push(polled(&mut device, step * 10_000));
        answer(&mut device, words, step * 10_000 + 5_000);
    }
    (device, sent)
}

#[test]
fn device_that_answers_is_measuring_after_five_steps() {
    let (device, sent) = started("VN-100S-CR");
    assert_eq!((device.phase(), device.fault()), (DevicePhase::Measuring, None));
    let expected = ["VNASY,0", "VNRRG,1", "VNWRG,6,0", "VNWRG,75,3,8,05,0121,0800", "VNASY,1"];
    let words: Vec<_> = sent.iter().map(|text| text[1..].split('*').next().unwrap()).collect();
    assert_eq!(words, expected);
    for (model, divisor) in [("VN-200S", "4"), ("VN-300T", "4"), ("VN-110E", "8"), ("VN-310", "4")] {
        let (device, sent) = started(model);
        assert_eq!(device.phase(), DevicePhase::Measuring, "{model}");
        assert!(sent[3].starts_with(&std::format!("$VNWRG,75,3,{divisor},")), "{model}: {}", sent[3]);
    }
}

/// The device's own answers may have other leading zeros.
#[test]
fn zeros_in_front_do_not_matter() {
    let mut device = Device::new(115_200);
    for words in ["VNASY,0", "VNRRG,1,VN-100T", "VNWRG,6,00", "VNWRG,75,3,8,5,121,800", "VNASY,1"] {
        let _ = polled(&mut device, 0);
        answer(&mut device, words, 1_000);
    }
    assert_eq!(device.phase(), DevicePhase::Measuring);
}

#[test]
fn other_product_other_output_and_errors_are_faults() {
    let up_to = |count: usize| {
        let mut device = Device::new(115_200);
        for words in ["VNASY,0", "VNRRG,01,VN-100S", "VNWRG,06,0"].into_iter().take(count) {
            let _ = polled(&mut device, 0);
            answer(&mut device, words, 1_000);
        }
        let _ = polled(&mut device, 2_000);
        device
    };
    for (steps, words, fault) in [
        (1, "VNRRG,01,AB-100", DeviceFault::WrongProduct),
        (3, "VNWRG,75,3,8,01,0121", DeviceFault::OtherItems),
        (3, "VNWRG,75,3,16,05,0121,0800", DeviceFault::OtherItems),
        (3, "VNERR,0C", DeviceFault::LineTooSlow),
        (3, "VNERR,12", DeviceFault::LineTooSlow),
        (3, "VNERR,07", DeviceFault::Rejected(7)),
    ] {
        let mut device = up_to(steps);
        assert_eq!(samples(&mut device, &frame(0), 2_500).len(), 1, "{words}");
        answer(&mut device, words, 3_000);
        assert_eq!((device.phase(), device.fault()), (DevicePhase::Refused, Some(fault)), "{words}");
        // What it sends is not used.
        assert_eq!(samples(&mut device, &frame(10_000_000), 9_000), [], "{words}");
        // It is asked anew after five seconds: it may have been replaced.
        assert_eq!(polled(&mut device, 10_000), "");
        assert_eq!(polled(&mut device, 4_000_000), "");
        assert_eq!(polled(&mut device, 6_000_000), "$VNASY,0*4F\r\n", "{words}");
    }
    // A damaged request is repeated, not given up.
    let mut device = up_to(3);
    assert_eq!(answer(&mut device, "VNERR,03", 3_000), [DeviceEvent::Error(3)]);
    assert_eq!((device.phase(), device.fault()), (DevicePhase::Configuring, None));
    assert!(polled(&mut device, 300_000).starts_with("$VNWRG,75"));
}

/// Without a wire to the device its samples are used all the same, and the engineer reads why it complains.
#[test]
fn device_that_never_answers_is_used() {
    let mut device = Device::new(115_200);
    let mut count = 0;
    for step in 0..200_u64 {
        let now_us = step * 10_000;
        count += samples(&mut device, &frame(step * 10_000_000), now_us).len();
        let _ = polled(&mut device, now_us);
    }
    assert_eq!(count, 200);
    assert_eq!((device.phase(), device.fault()), (DevicePhase::Measuring, Some(DeviceFault::NoAnswer)));
    // One that is not there is asked for ever.
    let mut device = Device::new(115_200);
    let sent: String = (0..2_000).map(|step| polled(&mut device, step * 10_000)).collect();
    assert_eq!(sent.matches("$VNASY,0*4F\r\n").count(), 100);
    assert_eq!(device.fault(), None);
}

/// A device that was switched off forgets what it was set to: silent for a second, it is set up again.
#[test]
fn silent_device_is_set_up_again() {
    let (mut device, _) = started("VN-100S");
    assert_eq!(samples(&mut device, &frame(0), 60_000).len(), 1);
    assert_eq!(polled(&mut device, 1_050_000), "");
    assert_eq!(polled(&mut device, 1_070_000), "$VNASY,0*4F\r\n");
    assert_eq!(device.counters().starts, 2);
}

/// x as printed on it, y and z turned round: lying flat it feels the floor push upward.
#[test]
fn axes_are_forward_left_up() {
    let (mut device, _) = started("VN-100S");
    let [sample] = samples(&mut device, &FRAME, 60_000)[..] else { panic!("one sample") };
    assert_eq!(sample.linear_mps2, [1.5, 0.125, 9.812_5]);
    assert_eq!(sample.angular_radps, [0.25, 0.5, -0.031_25]);
    assert!(sample.suspect, "a saturated axis");
    let [clear] = samples(&mut device, &frame(1), 61_000)[..] else { panic!("one sample") };
    assert!(!clear.suspect);
}

/// Its time counts the samples: lost ones leave gaps, a time that stands still is a frozen device, one that goes back a new one.
#[test]
fn sequence_follows_the_time_of_the_device() {
    let (mut device, _) = started("VN-100S");
    let mut sequence = |time_ms: u64, arrived_ms: u64| {
        samples(&mut device, &frame(time_ms * 1_000_000), arrived_ms * 1_000)[0].sequence
    };
    let first = sequence(5_000, 100);
    let steps =
        [(5_010, 110, 1), (5_020, 120, 2), (5_050, 150, 5), (5_050, 160, 5), (10, 170, 6), (20, 180, 7)];
    for (time_ms, arrived_ms, passed) in steps {
        assert_eq!(sequence(time_ms, arrived_ms).wrapping_sub(first), passed, "{time_ms}");
    }
    let counters = device.counters();
    assert_eq!((counters.lost_samples, counters.repeated_samples, counters.samples), (2, 1, 7));
}

#[test]
fn time_is_the_devices_and_never_late() {
    let (mut device, _) = started("VN-100S");
    let mut worst_us = 0;
    // Over the full hour of the device's time.
    for step in 0..2_000_u64 {
        let (true_us, jitter_us) = (1_000_000 + step * 10_000, (step * 7_919) % 8_000);
        // 42 bytes of ten bits at 115,200 baud, and the 1.25 ms that are taken for the device's own.
        let arrived_us = true_us + 3_645 + 1_250 + jitter_us;
        let sample = samples(&mut device, &frame((3_590_000_000 + step * 10_000) * 1_000), arrived_us)[0];
        assert!(sample.stamp.as_micros() <= arrived_us);
        if step > 100 {
            worst_us = worst_us.max(sample.stamp.as_micros().abs_diff(true_us));
        }
    }
    assert!(worst_us < 300, "{worst_us}");
}

/// A restarted device counts from zero: the clock that was learned from it before must not hold its samples back.
#[test]
fn restarted_time_is_learned_anew() {
    let (mut device, _) = started("VN-100S");
    let mut late_us = |time_us: u64, arrived_us: u64| {
        let sample = samples(&mut device, &frame(time_us * 1_000), arrived_us)[0];
        arrived_us - sample.stamp.as_micros()
    };
    for step in 0..100 {
        let _ = late_us(5_000_000 + step * 10_000, 1_000_000 + step * 10_000);
    }
    // 200 ms of silence, not enough for a new start-up, and a device that begins again.
    for step in 0..20 {
        let late_us = late_us(step * 10_000, 2_200_000 + step * 10_000);
        assert!(late_us < 10_000, "{late_us} us at sample {step}");
    }
}
