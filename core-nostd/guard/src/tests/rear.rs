//! The second safety scanner: what only it sees stops the robot and stays in the memory, and its loss stops as that of the first.

use super::fixtures::{Rig, config, config_with_rear, forward, scan_of};
use super::timelines::stopped;
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};

/// Between the rear corners, where no beam of the first scanner comes.
const BEHIND: [Point2; 3] = [Point2::new(-0.70, -0.02), Point2::new(-0.70, 0.0), Point2::new(-0.70, 0.02)];
/// Beside the rear, outside of every field: only a turn brings the body there.
const BESIDE: [Point2; 3] = [Point2::new(-0.42, -0.50), Point2::new(-0.40, -0.50), Point2::new(-0.38, -0.50)];

fn ready(config: GuardConfig) -> Rig {
    let mut rig = Rig::with(config);
    rig.wanted = Twist2::ZERO;
    rig.run_ms(3_000);
    rig
}

#[test]
fn fg_req_029_rear_field_stops_reversing() {
    for (config, holds) in [(config_with_rear(), true), (config(), false)] {
        let mut rig = ready(config);
        rig.wanted = forward(-0.2);
        assert!(rig.run_ms(1_500).permitted.linear_mps < -0.15);
        rig.obstacles = BEHIND.to_vec();
        let stopped_ms = rig.until(stopped);
        assert_eq!(stopped_ms.is_some(), holds, "only the second scanner looks there");
        if holds {
            assert!(stopped_ms.is_some_and(|ms| ms <= 90), "{stopped_ms:?}");
            assert!(rig.guard.causes().any(|record| record.cause == Cause::ScanProtective));
        }
    }
}

#[test]
fn fg_req_029_box_beside_rear_holds_turn() {
    for (config, holds) in [(config_with_rear(), true), (config(), false)] {
        let mut rig = ready(config);
        rig.obstacles = BESIDE.to_vec();
        rig.run_ms(1_000);
        rig.wanted = Twist2 { linear_mps: 0.0, angular_radps: 0.5 };
        let turned: f32 = (0..300).map(|_| rig.step().permitted.angular_radps * 0.01).sum();
        // The corner is 8 cm from the box: so much turn brings it there.
        assert_eq!(turned < 0.14, holds, "turned by {turned} rad");
        let is_way = |record: &CauseRecord| matches!(record.cause, Cause::WayClosed | Cause::WayNarrow);
        assert_eq!(rig.guard.causes().any(is_way), holds);
    }
}

#[test]
fn fg_req_029_lost_rear_scanner_stops_by_name() {
    let mut rig = ready(config_with_rear());
    rig.wanted = forward(0.6);
    assert!(rig.run_ms(4_000).permitted.linear_mps > 0.5);
    rig.silent.push(Source::RearScanner);
    let stopped_ms = rig.until(stopped);
    assert!(stopped_ms.is_some_and(|ms| ms <= 220), "{stopped_ms:?}");
    assert!(rig.guard.causes().any(|record| record.cause == Cause::SourceLost(Source::RearScanner)));
    // It never came: nothing moves.
    let mut rig = Rig::with(config_with_rear());
    rig.silent.push(Source::RearScanner);
    assert_eq!((0..400).filter(|_| !stopped(&rig.step())).count(), 0);
}

#[test]
fn fg_req_029_each_scanner_needs_its_own_scans() {
    let mut rig = ready(config_with_rear());
    rig.wanted = forward(0.6);
    rig.run_ms(2_000);
    // One hit of each: neither has two that agree.
    rig.obstacles = [BEHIND.as_slice(), &[Point2::new(1.2, 0.0)]].concat();
    let scan = scan_of(&rig.guard.config().scanner, (rig.now, 7), &rig.obstacles);
    rig.guard.on_scan(&scan, rig.now);
    let geometry = rig.guard.config().rear_scanner.unwrap();
    let behind = scan_of(&geometry, (rig.now, 7), &rig.obstacles);
    let decision = rig.guard.on_rear_scan(&behind, rig.now);
    assert!(!decision.action.stops(), "{decision:?}");
    // A scan of another device is a fault of the rear scanner alone.
    let mut short = behind;
    short.beams.truncate(500);
    rig.guard.on_rear_scan(&short, rig.now);
    let health = rig.guard.health();
    assert_eq!(health[Source::RearScanner.index()].health, Health::Faulty);
    assert_eq!(health[Source::Scanner.index()].health, Health::Healthy);
}

#[test]
fn fg_req_060_rear_scanner_without_deadline_is_refused() {
    let with = |change: fn(&mut GuardConfig)| {
        let mut config = config_with_rear();
        change(&mut config);
        config.validate()
    };
    assert_eq!(with(|_| ()), Ok(()));
    let changes: [fn(&mut GuardConfig); 4] = [
        |config| config.rear_scanner = None,
        |config| config.sources[Source::RearScanner.index()] = SourceRules::ABSENT,
        |config| config.rear_scanner.as_mut().unwrap().beams = 0,
        |config| config.rear_scanner.as_mut().unwrap().step_rad = f32::NAN,
    ];
    for change in changes {
        assert_eq!(with(change), Err(GuardConfigError::RearScanner));
    }
}
