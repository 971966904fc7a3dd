//! Real messages of the simulated devices: what fuzzing begins with.

use floorguard_sim::can::CanFrame;
use floorguard_sim::scenario::Scenario;
use floorguard_sim::{Payload, Simulation, Stream};

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
            (Stream::ScannerData | Stream::RearScannerSerial | Stream::Can, Payload::Bytes(_)) => {}
        });
        corpus.scanner = telegrams(&corpus.scanner.concat());
        corpus
    }
}

/// The scanner's bytes arrive in portions: a telegram begins where six zeros, its block and its size stand
/// (book, SICK S300: Telegram), here at even distances because the simulated scanner sends one kind only.
fn telegrams(bytes: &[u8]) -> Vec<Vec<u8>> {
    let header = &bytes[..10];
    let distance = (1..bytes.len()).find(|at| bytes[*at..].starts_with(header)).unwrap_or(bytes.len());
    bytes.chunks_exact(distance).map(<[u8]>::to_vec).collect()
}
