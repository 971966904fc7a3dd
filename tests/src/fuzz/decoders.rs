//! Bytes into each decoder of the drivers: no panic, nothing out of range comes out, and the next right message is understood.
#![allow(clippy::missing_panics_doc)] // That they panic at a wrong answer is what they are for.

use floorguard_drivers::can::{CanFrame, SlcanEvent, SlcanReceiver, encode_slcan};
use floorguard_drivers::lidar_link::Decoder as Bridged;
use floorguard_drivers::livox::{DEFAULT_ELEVATIONS_MDEG, Decoder as Livox};
use floorguard_drivers::microscan3::{Event as SafetyScannerEvent, Message, Receiver as SafetyScanner};
use floorguard_drivers::ouster::{Beams, Decoder as Ouster};
use floorguard_drivers::ranging::{Cola, RPLIDAR_A, RangingEvent, RangingScanner, Rplidar, TIM5XX};
use floorguard_drivers::s300::{Configuration, Event, Receiver};
use floorguard_drivers::three_wheel_base::{BaseConfiguration, BaseEvent, DriveCommand, ThreeWheelBase};
use floorguard_drivers::vectornav;
use floorguard_drivers::velocity_link::{
    Acceptance, AcceptanceRules, Arrival, FrameError, LineReceiver, MotionReport, Permit, VelocityRequest,
};
use floorguard_drivers::velodyne::{Decoder, Gprmc, ModelChoice, PositionPacket};
use floorguard_drivers::xsens::{FrameReceiver, Measurement};
use floorguard_sim::can::CanFrame as SimulatedFrame;
use floorguard_sim::wire::SentVelocity;
use floorguard_types::profile::Native;
use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;

use super::messages::xsens_list;
use super::{corrupt, pick};
use crate::campaign::Random;

fn at(micros: u64) -> Stamp {
    Stamp::from_micros(micros)
}

/// Datagrams of the lidar's data port, one after another.
pub fn velodyne(datagrams: &[Vec<u8>]) -> u64 {
    let mut decoder = Decoder::new(ModelChoice::Auto);
    let mut accepted = 0;
    for (step, bytes) in datagrams.iter().enumerate() {
        if let Ok((packet, _)) = decoder.decode(bytes, at(1_000_000 + step as u64 * 1_327)) {
            accepted += 1;
            assert!(packet.columns.iter().all(|column| column.azimuth_cdeg < 36_000));
        }
    }
    let counted = decoder.counters();
    assert_eq!(u64::from(counted.accepted), accepted, "counted is what was delivered");
    accepted
}

/// Datagrams of an Ouster, one after another. Whatever came before: the next right ones are understood.
pub fn ouster(beams: &Beams, datagrams: &[Vec<u8>], right: &[Vec<u8>]) -> u64 {
    let mut decoder = Ouster::new(beams);
    let (mut accepted, mut now_us) = (0, 1_000_000);
    for bytes in datagrams {
        now_us += 1_563;
        if let Ok((packet, _)) = decoder.decode(bytes, at(now_us)) {
            accepted += 1;
            assert!(packet.columns.iter().all(|column| column.azimuth_cdeg < 36_000));
            assert!(packet.stamp <= at(now_us), "a packet from the future");
        }
    }
    let understood = right.iter().filter(|bytes| {
        now_us += 1_563;
        decoder.decode(bytes, at(now_us)).is_ok()
    });
    assert!(understood.count() > 0 || right.is_empty(), "it did not find back into step");
    accepted
}

/// Datagrams of a bridge of two rings, one after another.
pub fn lidar_link(datagrams: &[Vec<u8>]) -> u64 {
    let mut decoder = Bridged::new(2);
    let mut accepted = 0;
    for (step, bytes) in datagrams.iter().enumerate() {
        let now = at(1_000_000 + step as u64 * 2_000);
        if let Ok((packet, _)) = decoder.decode(bytes, now) {
            accepted += 1;
            assert!(packet.columns.iter().all(|column| column.azimuth_cdeg < 36_000) && packet.stamp <= now);
        }
    }
    accepted
}

/// Datagrams of a Livox, one after another. Whatever came before, a clock that was wrong by half a second too: the next right ones are
/// understood.
pub fn livox(datagrams: &[Vec<u8>], right: &[Vec<u8>]) -> u64 {
    let mut decoder = Livox::new(&DEFAULT_ELEVATIONS_MDEG);
    let (mut accepted, mut now_us) = (0, 1_000_000);
    let mut take = |bytes: &[u8]| {
        now_us += 6_400;
        let Ok((packet, _)) = decoder.decode(bytes, at(now_us)) else { return false };
        assert!(
            packet.columns.iter().all(|column| column.azimuth_cdeg < 36_000) && packet.stamp <= at(now_us)
        );
        true
    };
    for bytes in datagrams {
        accepted += u64::from(take(bytes));
    }
    let understood = right.iter().filter(|bytes| take(bytes)).count();
    assert!(understood > 0 || right.is_empty(), "it did not find back into step");
    accepted
}

/// Bytes of a SICK TiM in portions of so many. Whatever came before: the next right telegram is understood.
pub fn cola(bytes: &[u8], portion: usize, right: &[u8]) -> u64 {
    let mut scanner = Cola::new(TIM5XX);
    let (mut scans, mut now_us) = (0, 1_000_000);
    let mut push = |part: &[u8], now_us: u64| {
        let mut scans = 0;
        scanner.push(part, at(now_us), &mut |event| {
            if let RangingEvent::Scan(scan) = event {
                scans += 1;
                let is_known =
                    |beam: &BeamReturn| matches!(beam, BeamReturn::Hit(50..=25_000) | BeamReturn::Unknown);
                assert!(scan.beams.iter().all(is_known) && scan.stamp <= at(now_us));
            }
        });
        scans
    };
    for part in bytes.chunks(portion.max(1)) {
        now_us += 1_000;
        scans += push(part, now_us);
    }
    assert_eq!(push(right, now_us + 100_000), 1, "it did not find back into step");
    scans
}

/// Bytes of an RPLidar in portions of so many. Whatever came before: it is asked anew once it is silent or not understood, and its
/// right answer becomes scans.
pub fn rplidar(bytes: &[u8], portion: usize, right: &[u8]) -> u64 {
    let mut scanner = Rplidar::new(RPLIDAR_A);
    let mut push = |part: &[u8], now_us: u64| {
        let (mut scans, mut is_asked) = (0, false);
        let mut take = |event: RangingEvent<'_, Native>| {
            if let RangingEvent::Scan(scan) = event {
                scans += 1;
                let is_known =
                    |beam: &BeamReturn| matches!(beam, BeamReturn::Hit(150..=12_000) | BeamReturn::Unknown);
                assert!(
                    scan.beams.iter().all(is_known) && scan.stamp <= at(now_us) && scan.beams.len() == 300
                );
            }
        };
        scanner.push(part, at(now_us), &mut take);
        let mut send = |sent: &[u8]| is_asked |= sent.starts_with(&[0xA5, 0x82]);
        scanner.poll(at(now_us), &mut send, &mut take);
        (scans, is_asked)
    };
    let (mut scans, mut now_us) = (0, 1_000_000);
    for part in bytes.chunks(portion.max(1)) {
        now_us += 20_000;
        scans += push(part, now_us).0;
    }
    let mut found = 0;
    // Until it is asked in the way that it was not asked in before.
    for _ in 0..700 {
        now_us += 20_000;
        if push(&[], now_us).1 {
            found += right.chunks(84).map(|part| push(part, now_us).0).sum::<u64>();
        }
    }
    assert!(found > 0, "it did not find back into step");
    scans
}

/// A datagram of the lidar's position port.
pub fn position(bytes: &[u8]) -> u64 {
    let taken = PositionPacket::new_checked(bytes).map(|packet| {
        let _ = (packet.stamp_us(), packet.pps(), packet.temperatures());
        let _ = Gprmc::parse(packet.sentence());
    });
    u64::from(taken.is_ok())
}

/// The sentence of a satellite receiver.
pub fn sentence(bytes: &[u8]) -> u64 {
    u64::from(Gprmc::parse(&String::from_utf8_lossy(bytes)).is_ok())
}

/// Bytes of the safety scanner in portions of so many. After a pause, whatever came before, a whole scan follows within these
/// right telegrams.
pub fn s300(bytes: &[u8], portion: usize, afterwards: &[Vec<u8>]) -> u64 {
    let mut receiver = Receiver::new(Configuration::default());
    let (mut scans, mut now) = (0, 1_000_000);
    for part in bytes.chunks(portion.max(1)) {
        receiver.push(part, at(now), |event| {
            if let Event::Scan(scan) = event {
                scans += 1;
                assert!(!scan.beams.contains(&BeamReturn::Hit(0)), "a hit at no distance");
            }
        });
        now += 1_000;
    }
    let mut understood = 0;
    for telegram in afterwards {
        now += 100_000;
        receiver.push(telegram, at(now), |event| understood += u64::from(matches!(event, Event::Scan(_))));
    }
    assert!(understood > 0 || afterwards.is_empty(), "it did not find back into step");
    scans
}

/// Lines of a serial CAN adaptor.
pub fn slcan(bytes: &[u8]) -> u64 {
    let known = CanFrame::standard(0x181, &[1, 2, 3, 4]);
    let mut receiver = SlcanReceiver::new();
    let mut seen = 0;
    receiver.push(bytes, |event| {
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
}

/// Frames that one base sees.
pub const BUS_FRAMES: u64 = 20;

/// Corrupted frames of a bus, orders and time between them.
pub fn base(frames: &[SimulatedFrame], random: &mut Random) -> u64 {
    let mut base = ThreeWheelBase::new(BaseConfiguration::default());
    let mut now = 1_000_000;
    let mut reported = 0;
    for _ in 0..BUS_FRAMES {
        let frame = pick(frames, random);
        let mut payload = frame.data[..usize::from(frame.len.min(8))].to_vec();
        corrupt(&mut payload, &[0xFF; 8], 8, random);
        let id = if random.seldom(4) { random.below(0x800) as u16 } else { frame.id as u16 & 0x7FF };
        let begun = now;
        let mut event = |event: BaseEvent| {
            reported += 1;
            if let BaseEvent::Wheels(sample) = event {
                assert!(sample.stamp <= at(begun), "a sample from the future");
            }
        };
        base.on_frame(&CanFrame::standard(id, &payload), at(now), &mut event);
        now += random.below(9_000);
        if random.seldom(3) {
            let steering_rad = f32::from_bits(random.next() as u32);
            base.command(DriveCommand::Move { wheel_mps: 0.5, steering_rad });
            base.poll(at(now), &mut event, &mut |frame| assert!(frame.payload().len() <= 8));
        }
    }
    reported
}

/// Bytes of the inertial sensor.
pub fn xsens(bytes: &[u8]) -> u64 {
    let list = xsens_list();
    let known = floorguard_sim::wire::encode_message(0x36, &list);
    let mut receiver = FrameReceiver::new();
    let mut seen = 0;
    receiver.push(bytes, at(1_000_000), |message, _| {
        seen += u64::from(Measurement::decode(message.data).is_ok());
    });
    let _ = Measurement::decode(bytes);
    // A false length may swallow as much as the longest frame; after that the known message is heard.
    let mut heard = false;
    for _ in 0..200 {
        receiver.push(&known, at(1_000_000), |message, _| heard |= message.data == list);
        if heard {
            break;
        }
    }
    assert!(heard, "it did not find back into step");
    seen
}

/// Bytes of a VectorNav in portions of so many. Whatever came before: what it sends then becomes samples, unless it has refused its
/// configuration, which is named.
pub fn vectornav(bytes: &[u8], portion: usize, right: &[u8]) -> u64 {
    let mut device = vectornav::Device::new(115_200);
    let (mut samples, mut now_us) = (0, 1_000_000);
    for part in bytes.chunks(portion.max(1)) {
        now_us += 5_000;
        samples += vectornav_part(&mut device, part, now_us);
    }
    let heard = vectornav_part(&mut device, right, now_us + 50_000);
    let is_refused = device.phase() == vectornav::DevicePhase::Refused;
    assert!(heard > 0 || is_refused, "it did not find back into step");
    assert!(!is_refused || device.fault().is_some(), "a refusal is named");
    samples
}

/// How many samples a part becomes.
fn vectornav_part(device: &mut vectornav::Device, part: &[u8], now_us: u64) -> u64 {
    let mut count = 0;
    device.push(part, at(now_us), |event| {
        if let vectornav::DeviceEvent::Sample(sample) = event {
            let numbers = [sample.angular_radps, sample.linear_mps2].concat();
            assert!(numbers.iter().all(|number| number.is_finite()) && sample.stamp <= at(now_us));
            count += 1;
        }
    });
    device.poll(at(now_us), &mut |sent| assert!(sent.starts_with(b"$VN") && sent.len() <= 64));
    count
}

/// A message of the microScan3 family, as it would stand before it is cut into datagrams.
pub fn microscan3_message(bytes: &[u8]) {
    let _ = Message::new_checked(bytes).map(|message| {
        let paths = message.intrusion().map_or(0, |intrusion| intrusion.paths().count());
        let _ = (message.status(), message.geometry(), message.application(), paths);
    });
}

/// Datagrams of the microScan3 family into a receiver that has heard others before, with the time before each. Afterwards
/// the right ones are understood.
pub fn microscan3(
    receiver: &mut SafetyScanner,
    now_us: &mut u64,
    datagrams: &[(u64, Vec<u8>)],
    right: &[Vec<u8>],
) -> u64 {
    let mut take = |datagram: &[u8], now_us: u64| {
        let mut scans = 0;
        receiver.push(datagram, at(now_us), |event| {
            if let SafetyScannerEvent::Scan(scan) = event {
                scans += 1;
                assert!(!scan.beams.contains(&BeamReturn::Hit(0)), "a hit at no distance");
            }
        });
        scans
    };
    let mut scans = 0;
    for (pause_us, datagram) in datagrams {
        *now_us += pause_us;
        scans += take(datagram, *now_us);
    }
    // Incomplete messages are given up in time, and a whole one is understood.
    *now_us += 1_000_000;
    let understood: u64 = right.iter().map(|datagram| take(datagram, *now_us)).sum();
    assert!(understood > 0, "it did not find back into step");
    scans
}

/// Frames of a program that drives, as datagrams and on a line. Whatever came before: what is asked for is finite and ends at
/// its deadline, and the next right request is heard.
pub fn velocity_link(frames: &[(u64, Vec<u8>)]) -> u64 {
    let rules = AcceptanceRules { sender: None, deadline_max_us: 200_000 };
    let (mut acceptance, mut line) = (Acceptance::new(rules), LineReceiver::new());
    let (mut now, mut accepted) = (1_000_000, 0);
    for (pause_us, bytes) in frames {
        now += pause_us;
        let _ = (Permit::decode(bytes), MotionReport::decode(bytes));
        if let Ok(request) = acceptance.offer(bytes, Arrival { peer: 0, at: at(now) }) {
            accepted += 1;
            assert!(request.stamp <= at(now) && request.expires <= at(now + 200_000), "{request:?}");
        }
        assert!(acceptance.requested(at(now)).is_finite());
        assert_eq!(acceptance.requested(at(now + 200_000)).linear_mps, 0.0, "past every deadline");
        for byte in bytes {
            if let Some(frame) = line.byte(*byte) {
                // Whatever its kind: length and checksum are right.
                let error = VelocityRequest::decode(frame).err();
                let is_whole =
                    !matches!(error, Some(FrameError::Length { .. } | FrameError::Checksum { .. }));
                assert!(is_whole, "{error:?}");
            }
        }
    }
    let counted = acceptance.counters();
    assert_eq!(u64::from(counted.accepted), accepted, "counted is what was accepted");
    let known = SentVelocity {
        sender: 3,
        sequence: 9,
        sent_ms: 5,
        deadline_ms: 100,
        linear_mps: 0.5,
        angular_radps: 0.0,
    };
    // A sender that was heard before is silent for long enough.
    now += 11_000_000;
    let heard = acceptance.offer(&known.encode(), Arrival { peer: 1, at: at(now) });
    assert!(heard.is_ok(), "{heard:?}");
    // A false start may swallow as much as the longest frame; after that the known request is found.
    let mut found = 0;
    for byte in (0..9).flat_map(|_| known.encode()) {
        found += u32::from(line.byte(byte).is_some_and(|frame| frame == known.encode()));
    }
    assert!(found > 0, "it did not find back into step");
    accepted
}
