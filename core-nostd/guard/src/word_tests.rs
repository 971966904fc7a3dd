//! What the operator reads: each part of a record is printed only when it has content.

use std::string::ToString as _;

use super::tests::fixtures::{Rig, packet};
use crate::protection::{CauseRecord, Unit};
use crate::*;
use floorguard_types::geometry::Point2;
use floorguard_types::time::Stamp;

const NOW: Stamp = Stamp::from_micros(10_000_000);

#[test]
fn fg_req_004_record_has_cause_numbers_age_and_action() {
    let plain = CauseRecord::new(Cause::EmergencyStop, NOW);
    assert_eq!(plain.to_string(), "emergency stop pressed -> torque off (category 0)");
    let near = CauseRecord::new(Cause::ScanProtective, NOW).metres(1.234, 1.5).aged(42_900);
    assert_eq!(
        near.to_string(),
        "obstacle in the protective field (safety scanner): 1.23 m, limit 1.50 m, 42 ms old -> stop and hold (category 2)"
    );
    let units = [
        (Unit::MetresPerSecond, ": 0.50 m/s, limit 0.25 m/s"),
        (Unit::RadiansPerSecond, ": 0.50 rad/s, limit 0.25 rad/s"),
        (Unit::Seconds, ": 0.50 s, limit 0.25 s"),
        (Unit::Percent, ": 0.50 %, limit 0.25 %"),
        (Unit::Code, ", code 0x0000"),
        (Unit::None, ""),
    ];
    for (unit, words) in units {
        let record = CauseRecord::new(Cause::Overspeed, NOW).measured(0.5, 0.25, unit);
        let expected = std::format!("faster than permitted{words} -> stop, then torque off (category 1)");
        assert_eq!(record.to_string(), expected);
    }
    let coded = CauseRecord::new(Cause::DriveFault, NOW).measured(255.0, 0.0, Unit::Code);
    assert_eq!(coded.to_string(), "drive reports a fault, code 0x00ff -> torque off (category 0)");
}

#[test]
fn fg_req_013_source_reports_health_and_future_offset() {
    let mut record = CauseRecord::new(Cause::SourceLost(Source::Imu), NOW);
    (record.health, record.age_us) = (Health::Stale, 120_000);
    assert_eq!(record.to_string(), "inertial sensor stale, 120 ms old -> stop and hold (category 2)");
    (record.health, record.age_us, record.ahead_us) = (Health::Faulty, u64::MAX, 1_500_000);
    assert_eq!(
        record.to_string(),
        "inertial sensor faulty, stamped 1.500 s in the future: its clock and the robot's differ -> stop and hold (category 2)"
    );
    let late = CauseRecord::new(Cause::SourceLate(Source::Lidar), NOW).aged(1);
    assert_eq!(late.to_string(), "lidar, 0 ms old -> speed limited");
}

fn is_of_no_source(cause: &Cause) -> bool {
    !matches!(cause, Cause::SourceLate(_) | Cause::SourceLost(_))
}

#[test]
fn fg_req_002_every_word_is_its_own() {
    let mut words: std::vec::Vec<std::string::String> =
        Cause::all().into_iter().filter(is_of_no_source).map(|cause| cause.to_string()).collect();
    words.extend(Source::ALL.map(|source| source.name().to_string()));
    words.extend([Action::None, Action::Limit, Action::Category2].map(|action| action.to_string()));
    words.extend(
        [Health::Healthy, Health::Stale, Health::Frozen, Health::Blind, Health::Faulty, Health::Absent]
            .map(|health| health.to_string()),
    );
    let errors = [
        GuardConfigError::Footprint,
        GuardConfigError::NotPositive("wheelbase"),
        GuardConfigError::FieldTooShort { set: 2, needed_m: 1.0, given_m: 0.5 },
    ];
    words.extend(errors.map(|error| error.to_string()));
    let different: std::collections::BTreeSet<_> = words.iter().collect();
    assert_eq!(different.len(), words.len());
    assert!(words.iter().all(|word| word.len() > 3), "{words:?}");
    for source in Source::ALL {
        assert_eq!(Cause::SourceLost(source).to_string(), source.name());
        assert_eq!(Cause::SourceLate(source).to_string(), source.name());
    }
}

#[test]
fn fg_req_030_person_with_non_finite_number_is_refused() {
    assert!(AdvisedPerson::default().is_finite());
    let bad = f32::NAN;
    let people = [
        AdvisedPerson { position: Point2::new(bad, 0.0), ..AdvisedPerson::default() },
        AdvisedPerson { position: Point2::new(0.0, bad), ..AdvisedPerson::default() },
        AdvisedPerson { velocity_mps: Point2::new(bad, 0.0), ..AdvisedPerson::default() },
        AdvisedPerson { velocity_mps: Point2::new(0.0, bad), ..AdvisedPerson::default() },
        AdvisedPerson { position_sigma_m: bad, ..AdvisedPerson::default() },
        AdvisedPerson { velocity_sigma_mps: f32::INFINITY, ..AdvisedPerson::default() },
    ];
    for person in people {
        assert!(!person.is_finite(), "{person:?}");
        let mut rig = Rig::cruising();
        let people = [person].into_iter().collect();
        rig.guard.on_advice(&Advice { stamp: rig.now, people, ..Advice::default() }, rig.now);
        assert!(rig.guard.causes().any(|record| record.cause == Cause::AdviceStop), "{person:?}");
    }
}

#[test]
fn fg_req_023_two_packets_add_up_empty_is_none() {
    // Six returns are needed; each near column of the packet has one.
    let stops = |before: u8, near: usize| {
        let mut rig = Rig::cruising();
        rig.guard.state.packet_returns = before;
        rig.guard.copy = rig.guard.state;
        let mut packet = packet(rig.now, 0, 20.0);
        for column in packet.columns.iter_mut().take(near) {
            column.range_raw[7] = 450;
        }
        rig.guard.on_lidar_packet(&packet, rig.now);
        assert_eq!(usize::from(rig.guard.state.packet_returns), near);
        rig.guard.causes().any(|record| record.cause == Cause::LidarProtective)
    };
    assert_eq!([stops(0, 5), stops(0, 6), stops(3, 2), stops(3, 3)], [false, true, false, true]);
    assert_eq!([stops(6, 0), stops(200, 0), stops(5, 1)], [false, false, true]);
}
