//! Blocks without an azimuth.

extern crate std;
use std::vec::Vec;

use floorguard_types::time::Stamp;

use super::decoder_tests::packet;
use super::*;

const SINGLE: [u8; 2] = [0x37, 0x22];
const DUAL: [u8; 2] = [0x39, 0x22];

fn set_azimuth(bytes: &mut [u8], block: usize, azimuth_cdeg: u16) {
    bytes[block * 100 + 2..block * 100 + 4].copy_from_slice(&azimuth_cdeg.to_le_bytes());
}

/// Azimuths of the columns that a fresh decoder gives.
fn columns(bytes: &[u8]) -> Vec<u16> {
    let mut decoder = Decoder::new(ModelChoice::Auto);
    let (packet, _) = decoder.decode(bytes, Stamp::from_micros(1_000_000)).expect("the packet is taken");
    packet.columns.iter().map(|column| column.azimuth_cdeg).collect()
}

/// A value above a whole turn costs its block: the columns of all others are where they were.
#[test]
fn an_odd_azimuth_costs_only_its_block() {
    for (tail, step, per_block) in [(SINGLE, 1, 2), (DUAL, 2, 2)] {
        let good = packet(1_000, 0, 500, tail);
        let all = columns(&good);
        for odd in 0..12 {
            let mut bytes = good.clone();
            set_azimuth(&mut bytes, odd, 36_001);
            let first = odd / step * per_block;
            let mut expected = all.clone();
            expected.drain(first..first + per_block);
            assert_eq!(columns(&bytes), expected, "block {odd}");
        }
    }
}

#[test]
fn a_block_left_out_is_counted_with_its_reason() {
    let mut bytes = packet(1_000, 0, 500, SINGLE);
    set_azimuth(&mut bytes, 5, 0xf0b8);
    let mut decoder = Decoder::new(ModelChoice::Auto);
    decoder.decode(&bytes, Stamp::ZERO).expect("the packet is taken");
    let reason = PacketError::Azimuth { block: 5, azimuth_cdeg: 0xf0b8 };
    assert_eq!((decoder.odd_block(), decoder.counters().odd_blocks), (Some(reason), 1));
    assert_eq!(decoder.counters().refused, 0);
    decoder.decode(&packet(1_480, 1_327, 500, SINGLE), Stamp::from_micros(1_327)).expect("taken");
    assert_eq!((decoder.odd_block(), decoder.counters().odd_blocks), (None, 1));
}

#[test]
fn returns_of_an_odd_block_are_left_out() {
    let mut bytes = packet(1_000, 0, 500, SINGLE);
    set_azimuth(&mut bytes, 7, 40_000);
    let checked = Packet::new_checked(&bytes).expect("eleven blocks are good");
    let (mut count, mut of_block_7) = (0, 0);
    Returns::new(Model::Vlp16).for_each(&checked, ReturnsOf::AllCells, |each| {
        count += 1;
        of_block_7 += u32::from(each.block == 7);
    });
    assert_eq!((count, of_block_7), (11 * 32, 0));
    assert_eq!(checked.gaps(), [40; 12]);
}

#[test]
fn a_packet_without_any_azimuth_is_refused() {
    let mut bytes = packet(1_000, 0, 500, SINGLE);
    (0..12).for_each(|block| set_azimuth(&mut bytes, block, 36_001));
    assert_eq!(
        Packet::new_checked(&bytes).err(),
        Some(PacketError::Azimuth { block: 0, azimuth_cdeg: 36_001 })
    );
    // One block alone does not tell how fast the head turns.
    set_azimuth(&mut bytes, 3, 0);
    let alone = Decoder::new(ModelChoice::Auto).decode(&bytes, Stamp::ZERO).err();
    assert_eq!(alone, Some(DecodeError::Rotation { gap_cdeg: 0 }));
}
