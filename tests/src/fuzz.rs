//! Damage for decoders: real messages of the simulator, spoilt in the ways that find mistakes in parsers.
//!
//! In-process and on the stable compiler, without coverage feedback; the number of executions makes up for part of it.

use floorguard_sim::can::CanFrame;
use floorguard_sim::scenario::Scenario;
use floorguard_sim::simulation::{Payload, Simulation, Stream};

use crate::campaign::Random;

/// Messages of each stream, as the simulated devices send them.
pub struct Corpus {
    /// UDP payloads of the lidar's data port.
    pub lidar: Vec<Vec<u8>>,
    /// UDP payloads of the lidar's position port.
    pub position: Vec<Vec<u8>>,
    /// Bytes of the safety scanner.
    pub scanner: Vec<Vec<u8>>,
    /// Bytes of the inertial sensor.
    pub imu: Vec<Vec<u8>>,
    /// Frames on the bus.
    pub can: Vec<CanFrame>,
}

impl Corpus {
    /// The first second and a half of a robot that stands in a warehouse.
    ///
    /// # Panics
    /// The built-in scenario is broken.
    #[must_use]
    pub fn simulated() -> Self {
        let scenario = Scenario::named("warehouse").expect("a built-in scenario");
        let mut simulation = Simulation::new(&scenario, 7).expect("a built-in scenario can be played");
        let (lidar, position, scanner, imu, can) = (vec![], vec![], vec![], vec![], vec![]);
        let mut corpus = Self { lidar, position, scanner, imu, can };
        simulation.advance_to(1_500_000, &mut |event| match (event.stream, event.payload) {
            (Stream::LidarData, Payload::Bytes(bytes)) => corpus.lidar.push(bytes),
            (Stream::LidarPosition, Payload::Bytes(bytes)) => corpus.position.push(bytes),
            (Stream::ScannerSerial, Payload::Bytes(bytes)) => corpus.scanner.push(bytes),
            (Stream::ImuSerial, Payload::Bytes(bytes)) => corpus.imu.push(bytes),
            (_, Payload::Frame(frame)) => corpus.can.push(frame),
            (Stream::ScannerData | Stream::Can, Payload::Bytes(_)) => {}
        });
        corpus.scanner = telegrams(&corpus.scanner.concat());
        corpus
    }
}

/// The scanner's bytes arrive in portions: a telegram begins where six zeros, its block and its size stand
/// (wire-formats 2.2), here at even distances because the simulated scanner sends one kind only.
fn telegrams(bytes: &[u8]) -> Vec<Vec<u8>> {
    let header = &bytes[..10];
    let distance = (1..bytes.len()).find(|at| bytes[*at..].starts_with(header)).unwrap_or(bytes.len());
    bytes.chunks_exact(distance).map(<[u8]>::to_vec).collect()
}

/// Values on which length fields, counters and comparisons tip over.
const EDGES: [u64; 12] =
    [0, 1, 2, 0x7F, 0x80, 0xFF, 0x100, 0x7FFF, 0x8000, 0xFFFF, 0x7FFF_FFFF, 0xFFFF_FFFF_FFFF_FFFF];

/// One to six mistakes in `bytes`, which keeps at most `longest` bytes. One message in eight stays as it is.
pub fn spoil(bytes: &mut Vec<u8>, other: &[u8], longest: usize, random: &mut Random) {
    if random.seldom(8) {
        return;
    }
    for _ in 0..=random.below(6) {
        mistake(bytes, other, random);
    }
    bytes.truncate(longest);
}

fn mistake(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let length = bytes.len() as u64;
    let at = random.below(length + 1) as usize;
    match random.below(8) {
        0 if length > 0 => bytes[at.min(length as usize - 1)] ^= 1 << random.below(8),
        1 if length > 0 => bytes[at.min(length as usize - 1)] = random.next() as u8,
        2 => bytes.truncate(at),
        3 => bytes.insert(at, random.next() as u8),
        4 if length > 0 => {
            let end = (at + random.below(16) as usize).min(bytes.len());
            bytes.drain(at..end);
        }
        5 => {
            let edge = EDGES[random.below(EDGES.len() as u64) as usize].to_le_bytes();
            let width = 1 << random.below(3);
            for (slot, byte) in bytes.iter_mut().skip(at).zip(edge.iter().take(width)) {
                *slot = *byte;
            }
        }
        6 => {
            let from = random.below(other.len() as u64 + 1) as usize;
            bytes.truncate(at);
            bytes.extend_from_slice(&other[from..]);
        }
        _ => {
            for _ in 0..random.below(40) {
                bytes.push(random.next() as u8);
            }
        }
    }
}

/// One of the messages.
///
/// # Panics
/// There is none.
pub fn pick<'a, T>(messages: &'a [T], random: &mut Random) -> &'a T {
    &messages[random.below(messages.len() as u64) as usize]
}
