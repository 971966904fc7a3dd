//! The inertial sensor: brought to measure, kept measuring, turned into the robot's axes.

use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::{Duration, Ticker, Timer};
use embedded_io_async::{Read, Write};
use floorguard_drivers::inertial::{InertialEvent, InertialSensor};
use floorguard_guard::{FaultKind, Source};
use floorguard_types::geometry::Transform3;
use floorguard_types::sensing::ImuSample;
use heapless::Vec;

use crate::clock;
use crate::shared::{Complaints, Shared};

/// At 115,200 baud 10 ms are 115 bytes.
const PORTION_BYTES: usize = 128;
/// How often the start-up reads the clock, milliseconds.
const POLL_MS: u64 = 20;
/// Pause after a failure of the line, milliseconds.
const RETRY_MS: u64 = 50;
/// Requests of one poll, at most.
const REQUEST_BYTES: usize = 64;

/// Guard ring. Runs for ever.
pub async fn imu_input<M: RawMutex>(
    shared: &Shared<M>,
    mut line: impl Read + Write,
    (mut device, sensor_in_base): (impl InertialSensor, Transform3),
) {
    let mut ticker = Ticker::every(Duration::from_millis(POLL_MS));
    let mut portion = [0; PORTION_BYTES];
    let mut reported = None;
    loop {
        match select(line.read(&mut portion), ticker.next()).await {
            Either::First(Ok(count)) if count > 0 => {
                let bytes = portion.get(..count).unwrap_or_default();
                device.take(bytes, clock::now(), &mut |event| take_in(shared, &event, &sensor_in_base));
            }
            Either::First(_) => {
                fail(shared, FaultKind::LinkDown);
                Timer::after_millis(RETRY_MS).await;
            }
            Either::Second(()) => {}
        }
        let mut requests = Vec::<u8, REQUEST_BYTES>::new();
        device.request(clock::now(), &mut |frame| {
            // One poll sends one or two short messages at most.
            let _ = requests.extend_from_slice(frame);
        });
        if Complaints::ARE_REPORTED && device.complaint() != reported {
            reported = device.complaint();
            shared.complain(|complaints| complaints.imu = reported.or(complaints.imu));
        }
        if !requests.is_empty() && line.write_all(&requests).await.is_err() {
            fail(shared, FaultKind::LinkDown);
        }
    }
}

fn fail<M: RawMutex>(shared: &Shared<M>, kind: FaultKind) {
    shared.count(|links| links.imu_errors = links.imu_errors.saturating_add(1));
    shared.decide(|guard| guard.on_source_fault(Source::Imu, kind, clock::now()));
}

fn take_in<M: RawMutex>(shared: &Shared<M>, event: &InertialEvent, sensor_in_base: &Transform3) {
    match event {
        InertialEvent::Sample(sample) => {
            let sample = in_robot_axes(sample, sensor_in_base);
            shared.move_by(|motion| motion.on_imu(&sample));
            shared.decide(|guard| guard.on_imu(&sample, clock::now()));
        }
        InertialEvent::Refused => fail(shared, FaultKind::Garbled),
        InertialEvent::Error(code) => fail(shared, FaultKind::Device(u16::from(*code))),
    }
}

/// Rates and accelerations turned by the mounting. The lever arm does not matter for a rate of turn.
fn in_robot_axes(sample: &ImuSample, sensor_in_base: &Transform3) -> ImuSample {
    let turned = |vector: [f32; 3]| {
        sensor_in_base.rotation.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum::<f32>())
    };
    ImuSample {
        angular_radps: turned(sample.angular_radps),
        linear_mps2: turned(sample.linear_mps2),
        // The device's own orientation is not used: its magnetometer is of no use in a building.
        orientation: None,
        ..*sample
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::geometry::Point3;

    #[test]
    fn inverted_sensor_turns_the_other_way() {
        let mounting = Transform3::from_mounting(Point3::new(0.3, 0.0, 0.4), core::f32::consts::PI, 0.0, 0.0);
        let sample = ImuSample { angular_radps: [0.1, 0.2, 0.3], ..ImuSample::default() };
        let [x, y, z] = in_robot_axes(&sample, &mounting).angular_radps;
        assert!((x - 0.1).abs() < 1e-6 && (y + 0.2).abs() < 1e-6 && (z + 0.3).abs() < 1e-6);
    }
}
