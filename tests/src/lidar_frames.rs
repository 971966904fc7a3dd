//! Lidar recordings as sweeps, one per revolution of the key.

use std::path::Path;

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, SweepBuilder};
use floorguard_recording::capture::{Capture, Datagram};
use floorguard_types::sensing::{LidarPacket, Sweep};
use floorguard_types::time::Stamp;

/// The lidar datagrams of a capture.
///
/// # Panics
/// Where the capture is no whole capture: the recordings beside the project are.
#[must_use]
pub fn datagrams(capture: &Path) -> Vec<Datagram> {
    let opened = Capture::open(capture).expect("the recording opens");
    opened
        .map(|datagram| datagram.expect("the recording is whole"))
        .filter(|datagram| datagram.destination_port == 2_368)
        .collect()
}

/// Decoded datagrams of a VLP-16.
#[must_use]
pub fn packets(datagrams: &[Datagram]) -> Vec<LidarPacket> {
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let decoded = datagrams.iter().filter_map(|datagram| {
        decoder.decode(&datagram.payload, Stamp::from_micros(datagram.captured_us)).ok()
    });
    decoded.map(|(packet, _)| packet).collect()
}

/// All packets as one sweep, cut before the first of them.
///
/// # Panics
/// Without any packet.
#[must_use]
pub fn sweep_of(packets: &[LidarPacket]) -> Box<Sweep> {
    let mut building = Box::new(Sweep::EMPTY);
    let mut complete: Option<Box<Sweep>> = None;
    let first = packets.first().expect("a sweep has packets");
    let mut builder = SweepBuilder::new(first.columns[0].azimuth_cdeg);
    for packet in packets {
        builder.add(packet, 0, &mut building, |sweep| complete = Some(Box::new(sweep.clone())));
    }
    complete.unwrap_or(building)
}

/// Revolutions of a continuous recording, cut behind the robot; the incomplete ones at both ends are left out.
#[must_use]
pub fn revolutions(packets: &[LidarPacket]) -> Vec<Box<Sweep>> {
    let mut building = Box::new(Sweep::EMPTY);
    let mut builder = SweepBuilder::new(18_000);
    let mut sweeps = Vec::new();
    for packet in packets {
        builder.add(packet, 0, &mut building, |sweep| sweeps.push(Box::new(sweep.clone())));
    }
    if !sweeps.is_empty() {
        sweeps.remove(0);
    }
    sweeps
}
