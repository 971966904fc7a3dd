//! The simulator's lidar packets at every speed of the head, through the decoder and the sweep builder.

use floorguard_drivers::velodyne::{Decoder, ModelChoice, SweepBuilder};
use floorguard_sim::wire::{DataPacket, ReturnMode};
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

/// From packet to packet, ns.
const PACKET_NS: u64 = 1_327_104;

/// Revolutions of a head at any speed, with the bytes of the simulator's own encoder: every firing is in a sweep.
#[test]
fn no_return_is_dropped_at_any_speed() {
    for rpm in (300..=1_200_u64).step_by(5) {
        let (mut decoder, mut builder) = (Decoder::new(ModelChoice::Auto), SweepBuilder::new(18_000));
        let mut building = Box::new(Sweep::<16>::EMPTY);
        let mut whole = Vec::new();
        let azimuth_cdeg = |time_ns: u64| (time_ns * rpm * 36 / 60_000_000 % 36_000) as u32;
        // Three and a half turns.
        for number in 0..210_000_000_000 / rpm / PACKET_NS {
            let start_ns = number * PACKET_NS;
            let mut packet = DataPacket::new(ReturnMode::Strongest, (start_ns / 1_000) as u32);
            for block in 0..12 {
                packet.set_azimuth(block, azimuth_cdeg(start_ns + PACKET_NS / 12 * block as u64));
                (0..32).for_each(|channel| packet.set_cell(block, channel, 1_000, 9));
            }
            let arrival = Stamp::from_micros(5_000_000 + (start_ns + PACKET_NS) / 1_000);
            let (columns, lost) = decoder.decode(&packet.into_bytes(), arrival).expect("a packet");
            builder.add(&columns, lost, &mut building, |sweep| {
                let used = sweep.used_columns();
                let widest = used.windows(2).map(|pair| {
                    (u32::from(pair[1].azimuth_cdeg) + 36_000 - u32::from(pair[0].azimuth_cdeg)) % 36_000
                });
                whole.push((sweep.dropped_columns, used.iter().all(|column| column.measured), widest.max()));
            });
        }
        assert!(whole.len() >= 3, "{rpm}: {whole:?}");
        for (dropped, all_measured, widest_cdeg) in &whole[1..] {
            assert_eq!((*dropped, *all_measured), (0, true), "{rpm} turns a minute");
            assert!(widest_cdeg.is_some_and(|widest_cdeg| widest_cdeg <= 43), "{rpm}: {widest_cdeg:?} cdeg");
        }
    }
}
