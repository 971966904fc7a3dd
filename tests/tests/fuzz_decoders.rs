//! Any bytes into every decoder: no panic, nothing out of range comes out, and the next right message is understood.
//!
//! `cargo xtask campaign fuzz-…` runs as many messages as one likes. A finding becomes a named test beside its decoder.

use std::fmt::Write as _;
use std::io::Cursor;

use floorguard_core::sensing::BeamReturn;
use floorguard_core::time::Stamp;
use floorguard_drivers::can::{CanFrame, SlcanEvent, SlcanReceiver, encode_slcan};
use floorguard_drivers::microscan3::{
    Event as SafetyScannerEvent, Message as SafetyScannerMessage, Receiver as SafetyScanner,
};
use floorguard_drivers::s300::{Configuration, Event, Receiver};
use floorguard_drivers::three_wheel_base::{BaseConfiguration, BaseEvent, DriveCommand, ThreeWheelBase};
use floorguard_drivers::velodyne::{Decoder, Gprmc, ModelChoice, PositionPacket};
use floorguard_drivers::xsens::{FrameReceiver, Measurement};
use floorguard_hosted::configuration::{EXAMPLE, parse};
use floorguard_hosted::recording::Recording;
use floorguard_tests::campaign::{Random, Slice, report};
use floorguard_tests::fuzz::{Corpus, pick, spoil};

/// Runs each trial with its own random numbers and tells how many messages were of use.
fn campaign(trials: u64, trial: impl FnMut(&mut Random) -> u64) {
    campaign_of(trials, 1, trial);
}

/// The same where one trial feeds the decoder several spoilt messages.
fn campaign_of(trials: u64, messages: u64, mut trial: impl FnMut(&mut Random) -> u64) {
    let slice = Slice::from_environment(trials);
    let mut useful = 0;
    for number in slice.trials.clone() {
        let mut random = slice.random(number);
        useful += trial(&mut random);
    }
    let executions = (slice.trials.end - slice.trials.start) * messages;
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
        // After a pause, whatever came before, a whole scan follows within two telegrams. That costs ten times the
        // damage itself: one trial in eight looks.
        if !random.seldom(8) {
            return scans;
        }
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

/// Frames that one base sees.
const BUS_FRAMES: u64 = 20;

#[test]
fn fuzz_base() {
    let frames = Corpus::simulated().can;
    campaign_of(3_000, BUS_FRAMES, |random| {
        let mut base = ThreeWheelBase::new(BaseConfiguration::default());
        let mut now = 1_000_000;
        let mut told = 0;
        for _ in 0..BUS_FRAMES {
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
            if heard {
                break;
            }
        }
        assert!(heard, "it did not find back into step");
        seen
    });
}

/// A message of the microScan3 family with a few beams, after wire-formats 3: no simulated device sends one.
fn microscan3_message(beams: u16) -> Vec<u8> {
    let mut bytes = vec![0; 52];
    bytes[..4].copy_from_slice(b"V\x01\x02\x03");
    let mut status = vec![0; 16];
    status[0] = 1;
    let derived = [
        &[1, 0][..],
        &beams.to_le_bytes(),
        &[40, 0, 0, 0],
        &((-47.5 * 4_194_304.0) as i32).to_le_bytes(),
        &((0.1 * 4_194_304.0) as i32).to_le_bytes(),
        &[11, 0, 0, 0, 0, 0, 0, 0],
    ];
    let measured = (0..beams).flat_map(|beam| [beam as u8, 3, 99, 1]);
    let measured = u32::from(beams).to_le_bytes().into_iter().chain(measured).collect();
    for (place, content) in [(32, status), (36, derived.concat()), (40, measured)] {
        let (offset, size) = (bytes.len() as u16, content.len() as u16);
        bytes[place..place + 2].copy_from_slice(&offset.to_le_bytes());
        bytes[place + 2..place + 4].copy_from_slice(&size.to_le_bytes());
        bytes.extend(content);
    }
    bytes
}

/// The message in datagrams.
fn microscan3_datagrams(bytes: &[u8], identification: u32) -> Vec<Vec<u8>> {
    let datagram = |(index, piece): (usize, &[u8])| {
        let numbers = [bytes.len() as u32, identification, (index * 120) as u32, 0];
        let header = numbers.iter().flat_map(|number| number.to_le_bytes());
        b"MS3 MD\x01\x00".iter().copied().chain(header).chain(piece.iter().copied()).collect()
    };
    bytes.chunks(120).enumerate().map(datagram).collect()
}

#[test]
fn fuzz_microscan3() {
    let whole = microscan3_message(40);
    let corpus = [1, 2].map(|identification| microscan3_datagrams(&whole, identification)).concat();
    let known = microscan3_datagrams(&whole, 77);
    let mut receiver = SafetyScanner::new(Default::default());
    let mut now = 1_000_000;
    campaign(4_000, |random| {
        let mut scans = 0;
        let mut take = |datagram: &[u8], now, scans: &mut u64| {
            receiver.push(datagram, at(now), |event| {
                if let SafetyScannerEvent::Scan(scan) = event {
                    *scans += 1;
                    let right = |beam: &BeamReturn| !matches!(beam, BeamReturn::Hit(0));
                    assert!(scan.beams.iter().all(right), "a hit at no distance");
                }
            });
        };
        // Either the content is spoilt and then sent whole, or the datagrams are spoilt on their way.
        let mut message = whole.clone();
        if random.seldom(2) {
            spoil(&mut message, &whole, 2_048, random);
            let _ = SafetyScannerMessage::new_checked(&message).map(|message| {
                let paths = message.intrusion().map_or(0, |intrusion| intrusion.paths().count());
                let _ = (message.status(), message.geometry(), message.application(), paths);
            });
        }
        for mut datagram in microscan3_datagrams(&message, random.below(4) as u32) {
            if random.seldom(3) {
                spoil(&mut datagram, pick::<Vec<u8>>(&corpus, random), 1_500, random);
            }
            take(&datagram, now, &mut scans);
            now += random.below(20_000);
        }
        // Incomplete messages are given up in time, and a whole one is understood.
        now += 1_000_000;
        let before = scans;
        known.iter().for_each(|datagram| take(datagram, now, &mut scans));
        assert!(scans > before, "it did not find back into step");
        before
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
