//! Real messages of the simulated devices: what fuzzing begins with.

use floorguard_drivers::ouster::{Beams, DataFormat};
use floorguard_sim::can::CanFrame;
use floorguard_sim::robot::OusterFormat;
use floorguard_sim::scenario::Scenario;
use floorguard_sim::wire::{
    ColaHeader, ColumnsDatagram, LivoxDatagram, OusterPacket, ScanNote, cola_scan, imu_link_frame,
    rplidar_capsule, rplidar_descriptor, scan_link_datagrams,
};
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

/// Datagrams of a bridge of two rings.
#[must_use]
pub fn bridged_datagrams() -> Vec<Vec<u8>> {
    let datagram = |number: u32| {
        let mut datagram = ColumnsDatagram::new((7, number), 9_000_000 + u64::from(number) * 2_000, 2);
        for column in 0..16_u16 {
            datagram.column((number as u16 * 560 + column * 35) % 36_000, column * 98, &[(250, 10), (0, 0)]);
        }
        datagram.into_bytes()
    };
    (0..60).map(datagram).collect()
}

/// Datagrams of a bridge of 900 beams, two of each scan.
#[must_use]
pub fn bridged_scans() -> Vec<Vec<u8>> {
    let datagrams = |sequence: u32| {
        let note = ScanNote {
            sender: 7,
            sequence,
            first_beam_us: 9_000_000 + u64::from(sequence) * 50_000,
            angles_udeg: (-180_000_000, 400_000),
            between_ns: 55_555,
        };
        let ranges_mm: Vec<u16> = (0..900).map(|beam| (beam * 37 + sequence as u16 * 5) % 30_000).collect();
        scan_link_datagrams(&note, &ranges_mm)
    };
    (0..20).flat_map(datagrams).collect()
}

/// Frames of an inertial sensor behind a bridge, two samples each.
#[must_use]
pub fn bridged_samples() -> Vec<Vec<u8>> {
    let frame = |number: u32| {
        let turn_radps = f32::from(number as u16) * 0.01;
        let sample = ([0.0, 0.0, turn_radps], [0.1, 0.0, 9.81], 0);
        let first_us = 9_000_000 + u64::from(number) * 20_000;
        imu_link_frame((7, 2 * number), (first_us, 10_000), &[sample, sample])
    };
    (0..40).map(frame).collect()
}

/// Datagrams of a Livox with few points: one begins 6.4 ms after the other, so that they last for 0.77 s.
#[must_use]
pub fn livox_datagrams() -> Vec<Vec<u8>> {
    let datagram = |number: u16| {
        let mut datagram = LivoxDatagram::new(9_000_000_000 + u64::from(number) * 6_400_000, number);
        for point in 0..16_i32 {
            let side = (i32::from(number) * 7 + point * 3) % 11;
            datagram.point([2_000 - point * 300, side * 200 - 1_000, 100 * (point % 5)], 30);
        }
        datagram.into_bytes(6_000_000)
    };
    (0..120).map(datagram).collect()
}

/// Scans of a SICK TiM.
#[must_use]
pub fn cola_scans() -> Vec<Vec<u8>> {
    let scan = |number: u16| {
        let begun_us = u32::from(number) * 66_667;
        let header = ColaHeader {
            scan: number,
            clock_us: [begun_us, begun_us + 50_000],
            turns_chz: 1_500,
            angles: (-450_000, 3_333),
            ..ColaHeader::default()
        };
        let distances: Vec<u32> = (0..811).map(|beam| (beam * 37 + u32::from(number)) % 9_000).collect();
        cola_scan(&header, &distances)
    };
    (0..4).map(scan).collect()
}

/// The answer of an RPLidar of the A series to a request to measure: a descriptor, and capsules of 28.8° of four turns.
#[must_use]
pub fn rplidar_turns() -> Vec<Vec<u8>> {
    let capsule = |number: u16| {
        let angle_q6 = ((u32::from(number) * 1_843) % 23_040) as u16;
        let samples: Vec<(u16, u8)> =
            (0..32).map(|sample| (2_000 + number * 40 + sample, (sample % 4) as u8)).collect();
        rplidar_capsule(angle_q6, number == 0, &samples)
    };
    [rplidar_descriptor(84, true, 0x82)].into_iter().chain((0..50).map(capsule)).collect()
}

/// An Ouster of 16 beams that look to either side, and one turn of it.
#[must_use]
pub fn ouster_turn() -> (Beams, Vec<Vec<u8>>) {
    let mut beams = Beams { format: DataFormat::Dual, ..Beams::even(16, (15_000, -15_000)) };
    for (azimuth, angle) in
        beams.azimuth_mdeg.iter_mut().zip([4_230, 1_410, -1_410, -4_230].into_iter().cycle())
    {
        *azimuth = angle;
    }
    let packet = |first: u16| {
        let mut packet = OusterPacket::new(OusterFormat::Dual, (16, 16), 7);
        for column in 0..16_u16 {
            let number = first + column;
            packet.set_column(usize::from(column), 9_000_000_000 + u64::from(number) * 97_656, number);
            for channel in 0..16 {
                let range_mm = 1_000 + u32::from(number) * 3 + channel as u32 * 40;
                packet.set_pixel((usize::from(column), channel), range_mm, 40);
            }
        }
        packet.into_bytes()
    };
    (beams, (0..1_024).step_by(16).map(packet).collect())
}
