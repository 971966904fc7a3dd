//! Streams of packets: what is lost, refused, repeated, set back or swapped.

extern crate std;
use std::vec::Vec;

use floorguard_types::time::Stamp;

use super::*;

/// A packet of a head at 600 rpm, all channels at `raw`.
pub(super) fn packet(azimuth_cdeg: u32, stamp_us: u32, raw: u16, tail: [u8; 2]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let is_dual = tail[0] == 0x39;
    for block in 0..12_u32 {
        let turned = if is_dual { block / 2 } else { block } * 40;
        bytes.extend([0xff, 0xee]);
        bytes.extend((((azimuth_cdeg + turned) % 36_000) as u16).to_le_bytes());
        for _ in 0..32 {
            bytes.extend(raw.to_le_bytes());
            bytes.push(50);
        }
    }
    bytes.extend(stamp_us.to_le_bytes());
    bytes.extend(tail);
    bytes
}

const SINGLE: [u8; 2] = [0x37, 0x22];
const DUAL: [u8; 2] = [0x39, 0x22];
const PERIOD_US: u32 = 1_327;

struct Stream {
    decoder: Decoder,
    number: u32,
}

impl Stream {
    fn new() -> Self {
        Self { decoder: Decoder::new(ModelChoice::Auto), number: 0 }
    }

    /// The next packet in time, changed on the way.
    fn send(&mut self, change: impl FnOnce(&mut Vec<u8>)) -> Result<u16, DecodeError> {
        let number = self.number;
        self.number += 1;
        let mut bytes = packet(480 * number, 1_000_000 + PERIOD_US * number, 500, SINGLE);
        change(&mut bytes);
        let arrival = Stamp::from_micros(9_000_000 + u64::from(PERIOD_US * number));
        self.decoder.decode(&bytes, arrival).map(|(_, lost)| lost)
    }
}

#[test]
fn whatever_was_refused_is_missing_before_the_next() {
    let mut stream = Stream::new();
    assert_eq!(stream.send(|_| ()), Ok(0));
    assert_eq!(stream.send(|_| ()), Ok(0));
    // Broken on the way, with a stamp that can be read or not.
    let stands =
        |bytes: &mut Vec<u8>| (0..12).for_each(|block| bytes[block * 100 + 2..block * 100 + 4].fill(0));
    assert_eq!(stream.send(stands), Err(DecodeError::Rotation { gap_cdeg: 0 }));
    assert!(matches!(stream.send(|bytes| bytes[300] = 0), Err(DecodeError::Packet(_))));
    assert!(matches!(stream.send(|bytes| bytes.truncate(1_205)), Err(DecodeError::Packet(_))));
    assert_eq!(stream.send(|_| ()), Ok(3));
    assert_eq!(stream.send(|_| ()), Ok(0));
    let counters = stream.decoder.counters();
    assert_eq!((counters.accepted, counters.refused, counters.lost), (4, 3, 3));
}

#[test]
fn repeated_and_overtaken_packets_are_refused() {
    let mut stream = Stream::new();
    let _ = (stream.send(|_| ()), stream.send(|_| ()));
    stream.number -= 1;
    assert!(matches!(stream.send(|_| ()), Err(DecodeError::NotNewer { .. })));
    stream.number -= 2;
    assert!(matches!(stream.send(|_| ()), Err(DecodeError::NotNewer { .. })));
    stream.number += 1;
    assert_eq!(stream.send(|_| ()), Ok(0));
    assert_eq!(stream.decoder.counters().not_newer, 2);
}

#[test]
fn a_clock_that_is_set_costs_no_packet() {
    // PPS locks: 20 minutes forwards, and back again.
    let mut decoder = Decoder::new(ModelChoice::Auto);
    for (number, stamp_us) in
        [1_000_000, 1_001_327, 1_201_000_000, 1_201_001_327, 5_000_000, 5_001_327].into_iter().enumerate()
    {
        let arrival = Stamp::from_micros(50_000_000 + 1_327 * number as u64);
        let (columns, lost) =
            decoder.decode(&packet(480 * number as u32, stamp_us, 500, SINGLE), arrival).expect("accepted");
        assert_eq!((columns.stamp, lost), (arrival.minus_micros(1_327), 0));
    }
    assert_eq!(decoder.clock_restarts(), 2);
}

#[test]
fn late_hour_rollover_is_handled() {
    // Stamps up to 3600.06 s have been seen (book, Velodyne: Clock).
    for (before, after) in [(3_599_999_500, 827), (3_600_060_000, 61_327)] {
        let mut decoder = Decoder::new(ModelChoice::Auto);
        let first = Stamp::from_micros(50_000_000);
        decoder.decode(&packet(0, before, 500, SINGLE), first).expect("accepted");
        let second = first.plus_micros(1_327);
        let (columns, lost) = decoder.decode(&packet(480, after, 500, SINGLE), second).expect("accepted");
        assert_eq!(
            (columns.stamp, lost, decoder.clock_restarts()),
            (first, 0, 0),
            "fired when the first one arrived"
        );
    }
}

#[test]
fn another_lidar_on_the_same_port_is_refused() {
    let mut decoder = Decoder::new(ModelChoice::Auto);
    let at = |number: u64| Stamp::from_micros(1_000_000 + 1_327 * number);
    decoder.decode(&packet(0, 0, 500, SINGLE), at(0)).expect("accepted");
    let swapped = decoder.decode(&packet(480, 1_327, 500, [0x37, 0x24]), at(1));
    assert!(matches!(
        swapped,
        Err(DecodeError::WrongModel { configured: Model::Vlp16, product_byte: 0x24, .. })
    ));
    decoder.decode(&packet(960, 2_654, 500, SINGLE), at(2)).expect("the first one still counts");
}

#[test]
fn the_return_mode_may_change_while_running() {
    let mut decoder = Decoder::new(ModelChoice::Auto);
    let mut lost_in_all = 0;
    for (number, (stamp_us, tail)) in
        [(0, SINGLE), (1_327, SINGLE), (2_654, DUAL), (3_317, DUAL), (3_981, DUAL), (4_644, SINGLE)]
            .into_iter()
            .enumerate()
    {
        let azimuth_cdeg = stamp_us * 36 / 100;
        let arrival = Stamp::from_micros(1_000_000 + u64::from(stamp_us));
        let (columns, lost) =
            decoder.decode(&packet(azimuth_cdeg, stamp_us, 500, tail), arrival).expect("accepted");
        assert_eq!(columns.columns.len(), if tail == DUAL { 12 } else { 24 }, "{number}");
        lost_in_all += lost;
    }
    // The first dual packet follows a full single one, which looks like one lost packet of the shorter period.
    assert!(lost_in_all <= 1, "{lost_in_all}");
}

#[test]
fn unpaired_or_standing_dual_packet_is_refused() {
    let mut bytes = packet(0, 0, 500, SINGLE);
    bytes[1_204] = 0x39;
    let mut decoder = Decoder::new(ModelChoice::Auto);
    let refused = decoder.decode(&bytes, Stamp::ZERO);
    assert_eq!(refused.err(), Some(DecodeError::NoPairs { first_cdeg: 0, second_cdeg: 40 }));
    let mut bytes = packet(0, 1_327, 500, DUAL);
    (0..12).for_each(|block| bytes[block * 100 + 2..block * 100 + 4].fill(7));
    assert_eq!(decoder.decode(&bytes, Stamp::ZERO).err(), Some(DecodeError::Rotation { gap_cdeg: 0 }));
}

#[test]
fn self_returns_are_unknown_and_counted() {
    let mut decoder = Decoder::new(ModelChoice::Auto).with_blind_range_mm(501);
    let (near, _) = decoder.decode(&packet(0, 0, 250, SINGLE), Stamp::ZERO).expect("accepted");
    assert!(near.columns.iter().flat_map(|column| column.range_raw).all(|raw| raw == 0));
    assert_eq!(decoder.counters().self_returns, 384);
    let (far, _) = decoder.decode(&packet(480, 1_327, 251, SINGLE), Stamp::ZERO).expect("accepted");
    assert!(far.columns.iter().all(|column| column.range_raw[..16].iter().all(|raw| *raw == 251)));
}

#[test]
fn an_echo_behind_the_robot_itself_stays() {
    let mut bytes = packet(0, 0, 100, DUAL);
    // The odd blocks of the pairs see farther.
    for block in [1, 3, 5, 7, 9, 11] {
        (0..32)
            .for_each(|channel| bytes[block * 100 + 4 + channel * 3..][..2].copy_from_slice(&[0xe8, 0x03]));
    }
    let mut decoder = Decoder::new(ModelChoice::Auto).with_blind_range_mm(500);
    let (columns, _) = decoder.decode(&bytes, Stamp::ZERO).expect("accepted");
    assert!(columns.columns.iter().all(|column| column.range_raw[..16].iter().all(|raw| *raw == 1_000)));
}

#[test]
fn rings_rise_in_every_model() {
    for model in [Model::Vlp16, Model::HiRes, Model::Vlp32C, Model::Hdl32E] {
        let rings = model.ring_angles();
        let used = &rings[..model.lasers()];
        assert!(used.windows(2).all(|pair| pair[0].elevation_deg < pair[1].elevation_deg), "{model:?}");
        assert!(used.iter().enumerate().all(|(ring, angle)| usize::from(angle.ring) == ring));
    }
}

proptest::proptest! {
    /// Whatever stamps, azimuths, arrivals and losses: nothing panics, nothing is measured after it arrived, and what
    /// does not fit is counted.
    #[test]
    fn any_stream_keeps_its_promises(
        stream in proptest::collection::vec(
            (0_u32..36_000, 0_u32..=3_601_000_000, 0_u64..20_000_000, 0_usize..8, 0_u16..),
            1..60,
        ),
        regular: bool,
    ) {
        let tails = [SINGLE, DUAL, [0x38, 0x21], [0x37, 0x24], [0x37, 0x28], [0x39, 0x28], SINGLE, SINGLE];
        let mut decoder = Decoder::new(ModelChoice::Auto);
        let mut builder = SweepBuilder::new(18_000);
        let mut building = std::boxed::Box::new(floorguard_types::sensing::Sweep::<16>::EMPTY);
        let mut arrival_us = 0;
        for (number, (azimuth_cdeg, stamp_us, wait_us, tail, lost)) in (0_u32..).zip(stream) {
            let stamp_us = if regular { number * PERIOD_US } else { stamp_us };
            arrival_us += if regular { wait_us % 3_000 } else { wait_us };
            let arrival = Stamp::from_micros(arrival_us);
            let Ok((columns, _)) = decoder.decode(&packet(azimuth_cdeg, stamp_us, 9, tails[tail]), arrival) else {
                continue;
            };
            proptest::prop_assert!(columns.stamp <= arrival);
            builder.add(&columns, lost, &mut building, |sweep| {
                assert!(sweep.column_count <= sweep.columns.len());
            });
            let entered = building.column_count + usize::from(building.dropped_columns);
            proptest::prop_assert!(building.column_count <= building.columns.len());
            proptest::prop_assert!(entered >= 1);
        }
        let counters = decoder.counters();
        proptest::prop_assert!(counters.accepted >= u32::from(counters.refused == 0));
    }
}

/// The model that was decided for, and none before.
#[test]
fn decided_model_is_reported() {
    let mut decoder = Decoder::new(ModelChoice::Auto);
    assert_eq!(decoder.model(), None);
    decoder.decode(&packet(0, 1_000, 500, SINGLE), Stamp::from_micros(9)).expect("a valid packet");
    assert_eq!(decoder.model(), Some(Model::Vlp16));
}

/// Early firmware of a VLP-16 names itself as the HDL-32E does: the period between two packets tells which it is.
#[test]
fn shared_product_byte_is_decided_by_period() {
    const SHARED: [u8; 2] = [0x37, 0x21];
    let play = |choice, period_us: u32| {
        let mut decoder = Decoder::new(choice);
        let mut decode = |number: u32| {
            let arrival = Stamp::from_micros(u64::from(period_us * number) + 9_000_000);
            decoder.decode(&packet(480 * number, period_us * number, 500, SHARED), arrival).map(|_| ())
        };
        let results = [decode(1), decode(2)];
        (results, decoder.model())
    };
    let (vlp16_us, hdl32e_us) = (Model::Vlp16.packet_us(false), Model::Hdl32E.packet_us(false));
    let (first, model) = play(ModelChoice::Auto, vlp16_us);
    assert_eq!((first, model), ([Err(DecodeError::ModelUndecided), Ok(())], Some(Model::Vlp16)));
    assert_eq!(play(ModelChoice::Fixed(Model::Vlp16), vlp16_us), ([Ok(()), Ok(())], Some(Model::Vlp16)));
    let ([first, second], model) = play(ModelChoice::Fixed(Model::Vlp16), hdl32e_us);
    assert_eq!((first, model), (Ok(()), None));
    assert!(matches!(second, Err(DecodeError::WrongModel { configured: Model::Vlp16, .. })), "{second:?}");
}

#[test]
fn configured_model_must_match_the_packet() {
    for (model, byte) in [(Model::Vlp16, 0x22), (Model::HiRes, 0x24)] {
        let mut decoder = Decoder::new(ModelChoice::Fixed(model));
        decoder
            .decode(&packet(0, 1_000, 500, [0x37, byte]), Stamp::from_micros(9))
            .expect("it is the configured one");
        assert_eq!(decoder.model(), Some(model));
        let other = decoder.decode(&packet(480, 2_327, 500, [0x37, byte ^ 0x06]), Stamp::from_micros(1_336));
        assert!(matches!(other, Err(DecodeError::WrongModel { .. })), "{other:?}");
    }
}

/// Each of the two firings of a block has its own sixteen distances.
#[test]
fn second_firing_has_its_own_distances() {
    let mut bytes = packet(0, 1_000, 500, SINGLE);
    for block in 0..12 {
        (16..32)
            .for_each(|channel| bytes[block * 100 + 4 + channel * 3..][..2].copy_from_slice(&[0xe8, 0x03]));
    }
    let mut decoder = Decoder::new(ModelChoice::Auto);
    let (found, _) = decoder.decode(&bytes, Stamp::from_micros(9_000)).expect("accepted");
    for (number, column) in found.columns.iter().enumerate() {
        let wanted = if number % 2 == 0 { 500 } else { 1_000 };
        assert!(column.range_raw[..16].iter().all(|raw| *raw == wanted), "column {number}");
    }
}

#[test]
fn the_robot_itself_is_counted_in_both_echoes() {
    let mut decoder = Decoder::new(ModelChoice::Auto).with_blind_range_mm(500);
    decoder.decode(&packet(0, 0, 100, DUAL), Stamp::ZERO).expect("accepted");
    assert_eq!(decoder.counters().self_returns, 384);
}

#[test]
fn the_last_stamp_that_is_one() {
    let of =
        |stamp_us| Packet::new_checked(&packet(0, stamp_us, 500, SINGLE)).map(|packet| packet.stamp_us());
    assert_eq!(of(3_601_000_000), Ok(3_601_000_000));
    assert_eq!(of(3_601_000_001), Err(PacketError::Stamp { micros: 3_601_000_001 }));
}

/// A lidar with as many lasers as the capacity is accepted, one with more is reported.
#[test]
fn thirty_two_lasers_need_the_capacity() {
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Hdl32E));
    let result = decoder.decode(&packet(0, 1_000, 500, [0x37, 0x21]), Stamp::from_micros(9)).map(|_| ());
    let has_capacity = floorguard_types::capacities::PACKET_RINGS_MAX >= 32;
    let too_many = |lasers_max| Err(DecodeError::TooManyLasers { model: Model::Hdl32E, lasers_max });
    assert_eq!(result, if has_capacity { Ok(()) } else { too_many(16) });
    // Stages that take sixteen rings are given no other lidar, whatever the build has room for.
    let mut decoder = Decoder::new(ModelChoice::Auto).with_lasers_max(16);
    let refused = decoder.decode(&packet(0, 1_000, 500, [0x37, 0x28]), Stamp::from_micros(9)).map(|_| ());
    assert_eq!(refused, Err(DecodeError::TooManyLasers { model: Model::Vlp32C, lasers_max: 16 }));
}
