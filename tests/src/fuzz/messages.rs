//! Right messages of devices that the simulated robot does not hear.

use std::io::Cursor;

use floorguard_recording::Recorder;
use floorguard_sim::wire::{SentVelocity, VectorNavSample, vectornav_frame, vectornav_sentence};
use floorguard_types::sensing::ImuSample;
use floorguard_types::time::Stamp;

/// A message of the microScan3 family with a few beams, after its wire format (book, microScan3); no simulated device
/// sends one.
#[must_use]
pub fn microscan3_message(beams: u16) -> Vec<u8> {
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
#[must_use]
pub fn microscan3_datagrams(bytes: &[u8], identification: u32) -> Vec<Vec<u8>> {
    let datagram = |(index, piece): (usize, &[u8])| {
        let numbers = [bytes.len() as u32, identification, (index * 120) as u32, 0];
        let header = numbers.iter().flat_map(|number| number.to_le_bytes());
        b"MS3 MD\x01\x00".iter().copied().chain(header).chain(piece.iter().copied()).collect()
    };
    bytes.chunks(120).enumerate().map(datagram).collect()
}

/// A list of measured values of the inertial sensor, without its frame.
#[must_use]
pub fn xsens_list() -> Vec<u8> {
    [&XSENS_SAMPLE[..], &[0x10, 0x20, 2, 0, 7], &[0x10, 0x60, 4, 0, 0, 1, 0]].concat()
}

const XSENS_SAMPLE: [u8; 15] = [0x80, 0x20, 12, 0x3F, 0x80, 0, 0, 0, 0, 0, 0, 0xBF, 0x80, 0, 0];

/// Messages of the inertial sensor: the simulated device answers only who asks, so its own encoder makes them here.
#[must_use]
pub fn xsens_messages() -> Vec<Vec<u8>> {
    let message = |id, data: &[u8]| floorguard_sim::wire::encode_message(id, data);
    vec![message(0x36, &xsens_list()), message(0x36, &XSENS_SAMPLE), message(0x42, &[4]), message(0x31, &[])]
}

/// What a VectorNav sends: frames as the robot asks for them, and the sentences around its start.
#[must_use]
pub fn vectornav_messages() -> Vec<Vec<u8>> {
    let frame = |step: u64| {
        let sample = VectorNavSample {
            since_start_ns: step * 10_000_000,
            rate_radps: [0.01, -0.02, 0.3],
            acceleration_mps2: [0.1, 0.2, -9.81],
            saturation: 0,
        };
        vectornav_frame(&sample, 0x0121, 0x0800)
    };
    let sentences =
        ["VNASY,0", "VNRRG,01,VN-200S", "VNWRG,06,0", "VNWRG,75,3,4,05,0121,0800", "VNERR,03", "VNASY,1"];
    sentences.into_iter().map(vectornav_sentence).chain((1..=20).map(frame)).collect()
}

/// A recording of some samples.
///
/// # Panics
/// Never: memory takes everything.
#[must_use]
pub fn recording() -> Vec<u8> {
    let mut recorder = Recorder::new(Cursor::new(Vec::new())).expect("memory takes everything");
    for round in 0..20 {
        let sample = ImuSample { stamp: Stamp::from_micros(round * 10_000), ..Default::default() };
        recorder.imu(sample.stamp, &sample).expect("memory takes everything");
    }
    recorder.finish().expect("memory takes everything").into_inner()
}

/// Requests of a program that drives, as its encoder in the simulator writes them.
#[must_use]
pub fn velocity_requests() -> Vec<Vec<u8>> {
    let first = SentVelocity {
        sender: 7,
        sequence: 1,
        sent_ms: 0,
        deadline_ms: 150,
        linear_mps: 0.5,
        angular_radps: -0.1,
    };
    let numbered = |number: u32| SentVelocity { sequence: number, sent_ms: number * 50, ..first }.encode();
    (1..40).map(numbered).collect()
}
