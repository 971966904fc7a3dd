//! Bytes into the decoders of our own links: no panic, nothing out of range comes out, and the next right message is understood.
#![allow(clippy::missing_panics_doc)] // That they panic at a wrong answer is what they are for.

use floorguard_drivers::imu_link::{Device, DeviceEvent};
use floorguard_drivers::ranging::{Bridged, RangingEvent, RangingScanner};
use floorguard_drivers::scan_link::ScanShape;
use floorguard_types::profile::Native;
use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;

fn at(micros: u64) -> Stamp {
    Stamp::from_micros(micros)
}

/// Scans of [`super::bridged_scans`].
const BRIDGED: ScanShape = ScanShape {
    beams: 900,
    first_udeg: -180_000_000,
    step_udeg: 400_000,
    period_us: 50_000,
    range_mm: [50, 25_000],
};

/// Datagrams of a scanner behind a bridge, one after another. Whatever came before: after a second of silence a right scan is understood.
pub fn scan_link(datagrams: &[Vec<u8>], right: &[Vec<u8>]) -> u64 {
    let mut scanner = Bridged::new(BRIDGED);
    let (mut scans, mut now_us) = (0, 1_000_000);
    let mut push = |bytes: &[u8], now_us: u64| {
        let mut scans = 0;
        scanner.push(bytes, at(now_us), &mut |event: RangingEvent<'_, Native>| {
            if let RangingEvent::Scan(scan) = event {
                scans += 1;
                let is_known =
                    |beam: &BeamReturn| matches!(beam, BeamReturn::Hit(50..=25_000) | BeamReturn::Unknown);
                assert!(
                    scan.beams.iter().all(is_known) && scan.stamp <= at(now_us) && scan.beams.len() == 900
                );
            }
        });
        scans
    };
    for bytes in datagrams {
        now_us += 25_000;
        scans += push(bytes, now_us);
    }
    now_us += 1_000_000;
    let understood: u64 = right.iter().map(|bytes| push(bytes, now_us)).sum();
    assert_eq!(understood, 1, "it did not find back into step");
    scans
}

/// Bytes of a bridge before an inertial sensor in portions of so many. Whatever came before: after a second of silence a right frame is
/// understood.
pub fn imu_link(bytes: &[u8], portion: usize, right: &[Vec<u8>]) -> u64 {
    let mut device = Device::default();
    let mut push = |part: &[u8], now_us: u64| {
        let mut samples = 0;
        device.push(part, at(now_us), |event| {
            if let DeviceEvent::Sample(sample) = event {
                samples += 1;
                let numbers = [sample.angular_radps, sample.linear_mps2].concat();
                assert!(numbers.iter().all(|number| number.is_finite()) && sample.stamp <= at(now_us));
            }
        });
        samples
    };
    let (mut samples, mut now_us) = (0, 1_000_000);
    for part in bytes.chunks(portion.max(1)) {
        now_us += 5_000;
        samples += push(part, now_us);
    }
    now_us += 1_000_000;
    // A false start may swallow as much as the longest frame.
    let understood: u64 = right.iter().map(|frame| push(frame, now_us)).sum();
    assert!(understood > 0, "it did not find back into step");
    samples
}
