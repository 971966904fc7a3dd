//! The guard's decision for one lidar packet, datagram by datagram.

use std::hint::black_box;
use std::time::Instant;

use floorguard_configuration::{EXAMPLE, parse};
use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice};
use floorguard_guard::Supervisor;
use floorguard_recording::capture::Datagram;
use floorguard_types::sensing::LidarPacket;
use floorguard_types::time::Stamp;

/// A decision may take this long, nanoseconds (the guard's own budget).
pub const DECISION_MAX_NS: f64 = 20_000.0;
/// From the measurement to the guard, microseconds.
const DELAY_US: u64 = 200;
const ROUNDS: usize = 15;

/// What decisions took, nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecisionTime {
    /// Median over packets and rounds.
    pub median_ns: f64,
    /// The packet that takes longest. Of each packet the fastest of all rounds counts: what interrupts the measurement
    /// is not the guard's.
    pub worst_ns: f64,
}

impl DecisionTime {
    /// Every packet is decided in time.
    #[must_use]
    pub fn is_in_time(&self) -> bool {
        self.worst_ns <= DECISION_MAX_NS
    }
}

/// Measures the guard of the example robot on all packets of a recording.
///
/// # Panics
/// Where the built-in configuration is refused.
#[must_use]
pub fn decisions(datagrams: &[Datagram]) -> DecisionTime {
    let packets = stamped(datagrams);
    let config = parse("robot.toml", EXAMPLE).expect("the example is right").robot.guard();
    let mut fastest = vec![f64::INFINITY; packets.len()];
    let mut all = Vec::with_capacity(packets.len() * ROUNDS);
    for _ in 0..ROUNDS {
        let start = packets.first().map_or(Stamp::ZERO, |(_, now)| *now);
        let mut guard =
            Box::new(Supervisor::new(config.clone(), start).expect("the guard takes the example"));
        for ((packet, now), fastest) in packets.iter().zip(&mut fastest) {
            let started = Instant::now();
            black_box(guard.on_lidar_packet(black_box(packet), *now));
            let took_ns = started.elapsed().as_nanos() as f64;
            *fastest = fastest.min(took_ns);
            all.push(took_ns);
        }
    }
    DecisionTime { median_ns: super::median(all), worst_ns: fastest.into_iter().fold(0.0, f64::max) }
}

/// Packets and the moments at which the guard gets them.
fn stamped(datagrams: &[Datagram]) -> Vec<(LidarPacket, Stamp)> {
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let decoded = datagrams.iter().filter_map(|datagram| {
        let (packet, _) = decoder.decode(&datagram.payload, Stamp::from_micros(datagram.captured_us)).ok()?;
        Some((packet, Stamp::from_micros(datagram.captured_us + DELAY_US)))
    });
    decoded.collect()
}
