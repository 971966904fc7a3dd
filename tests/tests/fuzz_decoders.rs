//! Any bytes into every decoder: no panic, nothing out of range comes out, and the next right message is understood.
//!
//! `cargo xtask campaign fuzz-…` runs as many messages as one likes. A finding becomes a named test beside its decoder.

use std::fmt::Write as _;
use std::io::Cursor;

use floorguard_core::sensing::BeamReturn;
use floorguard_core::time::Stamp;
use floorguard_drivers::can::{CanFrame, SlcanEvent, SlcanReceiver, encode_slcan};
use floorguard_drivers::s300::{Configuration, Event, Receiver};
use floorguard_drivers::three_wheel_base::{BaseConfiguration, BaseEvent, DriveCommand, ThreeWheelBase};
use floorguard_drivers::velodyne::{Decoder, Gprmc, ModelChoice, PositionPacket};
use floorguard_drivers::xsens::{FrameReceiver, Measurement};
use floorguard_hosted::configuration::{EXAMPLE, parse};
use floorguard_hosted::recording::Recording;
use floorguard_tests::campaign::{Random, Slice, report};
use floorguard_tests::fuzz::{Corpus, pick, spoil};

/// Runs each trial with its own random numbers and tells how many messages were of use.
fn campaign(trials: u64, mut trial: impl FnMut(&mut Random) -> u64) {
    let slice = Slice::from_environment(trials);
    let mut useful = 0;
    for number in slice.trials.clone() {
        let mut random = slice.random(number);
        useful += trial(&mut random);
    }
    let executions = slice.trials.end - slice.trials.start;
    report(&[("executions", executions), ("accepted", useful)]);
    assert!(useful > 0 || executions < 100, "every message was refused: the campaign tests nothing");
}

fn at(micros: u64) -> Stamp {
    Stamp::from_micros(micros)
}

#[test]
fn fuzz_velodyne() {
    let corpus = Corpus::simulated().lidar;
    campaign(8_000, |random| {
        let mut decoder = Decoder::new(ModelChoice::Auto);
        let mut accepted = 0;
        for step in 0..1 + random.below(3) {
            let mut bytes = pick(&corpus, random).clone();
            spoil(&mut bytes, pick::<Vec<u8>>(&corpus, random), 2_048, random);
            if let Ok((packet, _)) = decoder.decode(&bytes, at(1_000_000 + step * 1_327)) {
                accepted += 1;
                assert!(packet.columns.iter().all(|column| column.azimuth_cdeg < 36_000));
            }
        }
        let counted = decoder.counters();
        assert_eq!(u64::from(counted.accepted), accepted, "counted is what was delivered");
        accepted
    });
}

#[test]
fn fuzz_position() {
    let corpus = Corpus::simulated().position;
    let sentence = "$GPRMC,220516,A,5133.82,N,00042.24,W,173.8,231.8,130694,004.2,W*70";
    campaign(8_000, |random| {
        let mut bytes = pick(&corpus, random).clone();
        spoil(&mut bytes, pick::<Vec<u8>>(&corpus, random), 1_024, random);
        let taken = PositionPacket::new_checked(&bytes).map(|packet| {
            let _ = (packet.stamp_us(), packet.pps(), packet.temperatures_celsius());
            let _ = Gprmc::parse(packet.sentence());
        });
        let mut text = sentence.as_bytes().to_vec();
        spoil(&mut text, sentence.as_bytes(), 128, random);
        let text = String::from_utf8_lossy(&text).into_owned();
        u64::from(taken.is_ok()) + u64::from(Gprmc::parse(&text).is_ok())
    });
}

#[test]
fn fuzz_s300() {
    let corpus = Corpus::simulated().scanner;
    campaign(3_000, |random| {
        let mut receiver = Receiver::new(Configuration::default());
        let mut bytes = pick(&corpus, random).clone();
        spoil(&mut bytes, pick::<Vec<u8>>(&corpus, random), 4_096, random);
        let mut scans = 0;
        let mut now = 1_000_000;
        let portion = 1 + random.below(700) as usize;
        for part in bytes.chunks(portion) {
            receiver.push(part, at(now), |event| {
                if let Event::Scan(scan) = event {
                    scans += 1;
                    let right = |beam: &BeamReturn| !matches!(beam, BeamReturn::Hit(0));
                    assert!(scan.beams.iter().all(right), "a hit at no distance");
                }
            });
            now += 1_000;
        }
        // After a pause, whatever came before, a whole scan follows within two telegrams.
        let mut understood = 0;
        for telegram in corpus.iter().take(2) {
            now += 100_000;
            receiver
                .push(telegram, at(now), |event| understood += u64::from(matches!(event, Event::Scan(_))));
        }
        assert!(understood > 0, "it did not find back into step");
        scans
    });
}

#[test]
fn fuzz_slcan() {
    let frames = Corpus::simulated().can;
    let lines: Vec<Vec<u8>> =
        frames.iter().map(|frame| floorguard_sim::can::encode_slcan(frame).into_bytes()).collect();
    let known = CanFrame::standard(0x181, &[1, 2, 3, 4]);
    campaign(20_000, |random| {
        let mut receiver = SlcanReceiver::new();
        let mut bytes: Vec<u8> = (0..4).flat_map(|_| pick(&lines, random).clone()).collect();
        spoil(&mut bytes, pick::<Vec<u8>>(&lines, random), 512, random);
        let mut seen = 0;
        receiver.push(&bytes, |event| {
            if let SlcanEvent::Frame(frame) = event {
                assert!(frame.payload().len() <= 8);
                seen += 1;
            }
        });
        receiver.push(b"\r", |_| {});
        let mut last = None;
        receiver.push(&encode_slcan(&known), |event| last = Some(event));
        assert_eq!(last, Some(SlcanEvent::Frame(known)), "it did not find back into step");
        seen
    });
}

#[test]
fn fuzz_base() {
    let frames = Corpus::simulated().can;
    campaign(3_000, |random| {
        let mut base = ThreeWheelBase::new(BaseConfiguration::default());
        let mut now = 1_000_000;
        let mut told = 0;
        for _ in 0..20 {
            let frame = pick(&frames, random);
            let mut payload = frame.data[..usize::from(frame.len.min(8))].to_vec();
            spoil(&mut payload, &[0xFF; 8], 8, random);
            let id = if random.seldom(4) { random.below(0x800) as u16 } else { frame.id as u16 & 0x7FF };
            let begun = now;
            let mut event = |event: BaseEvent| {
                told += 1;
                if let BaseEvent::Wheels(sample) = event {
                    assert!(sample.stamp <= at(begun), "a sample from the future");
                }
            };
            base.on_frame(&CanFrame::standard(id, &payload), at(now), &mut event);
            now += random.below(9_000);
            if random.seldom(3) {
                base.command(DriveCommand::Move {
                    wheel_mps: 0.5,
                    steering_rad: f32::from_bits(random.next() as u32),
                });
                base.poll(at(now), &mut event, &mut |frame| assert!(frame.payload().len() <= 8));
            }
        }
        told
    });
}

#[test]
fn fuzz_xsens() {
    // The simulated device answers only who asks: its messages are made here by the simulator's own encoder.
    let sample = [0x80, 0x20, 12, 0x3F, 0x80, 0, 0, 0, 0, 0, 0, 0xBF, 0x80, 0, 0];
    let list = [&sample[..], &[0x10, 0x20, 2, 0, 7], &[0x10, 0x60, 4, 0, 0, 1, 0]].concat();
    let message = |id, data: &[u8]| floorguard_sim::wire::encode_message(id, data);
    let mut corpus = Corpus::simulated().imu;
    corpus.extend([message(0x36, &list), message(0x36, &sample), message(0x42, &[4]), message(0x31, &[])]);
    let known = message(0x36, &list);
    campaign(8_000, |random| {
        let mut bytes = pick(&corpus, random).clone();
        spoil(&mut bytes, pick::<Vec<u8>>(&corpus, random), 4_096, random);
        let mut receiver = FrameReceiver::new();
        let mut seen = 0;
        receiver.push(&bytes, at(1_000_000), |message, _| {
            seen += u64::from(Measurement::decode(message.data).is_ok());
        });
        let _ = Measurement::decode(&bytes);
        // A false length may swallow as much as the longest frame; after that the known message is heard.
        let mut heard = false;
        for _ in 0..200 {
            receiver.push(&known, at(1_000_000), |message, _| heard |= message.data == &list[..]);
        }
        assert!(heard, "it did not find back into step");
        seen
    });
}

#[test]
fn fuzz_configuration() {
    campaign(500, |random| {
        let mut bytes = EXAMPLE.as_bytes().to_vec();
        spoil(&mut bytes, EXAMPLE.as_bytes(), 64 * 1024, random);
        let text = String::from_utf8_lossy(&bytes).into_owned();
        match parse("robot.toml", &text) {
            Ok(_) => 1,
            Err(refused) => {
                let mut shown = String::new();
                write!(shown, "{refused}").expect("memory takes everything");
                assert!(shown.contains("robot.toml"), "a refusal names its file: {shown}");
                0
            }
        }
    });
}

#[test]
fn fuzz_recording() {
    let mut recorder = floorguard_hosted::recording::Recorder::new(Cursor::new(Vec::new()))
        .expect("memory takes everything");
    for round in 0..20 {
        let sample = floorguard_core::sensing::ImuSample { stamp: at(round * 10_000), ..Default::default() };
        recorder.imu(sample.stamp, &sample).expect("memory takes everything");
    }
    let whole = recorder.finish().expect("memory takes everything").into_inner();
    campaign(1_000, |random| {
        let mut bytes = whole.clone();
        spoil(&mut bytes, &whole, 1 << 20, random);
        let read = Recording::new(Cursor::new(bytes));
        // A reader that finds nothing wrong in a spoilt file would go on for ever only if it never came to the end.
        read.take(10_000).filter(|message| message.is_ok()).count() as u64
    });
}
