//! What the display does with stops that cannot be written.

use floorguard_guard::{Cause, CauseRecord, GuardState};
use floorguard_runtime::shared::StopRecord;
use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

use super::*;

/// Devices that have sent nothing since the start are named, with their nodes.
#[test]
fn silent_nodes_are_named() {
    let robot =
        floorguard_configuration::parse("robot.toml", floorguard_configuration::EXAMPLE).unwrap().robot;
    let mut report = BusReport::of(&floorguard_drivers::three_wheel_base::ThreeWheelBase::new(robot.base()));
    let lines = silent_devices(&report);
    assert!(lines.len() == 5 && lines[4].contains("safety controller (node 5): not heard of"), "{lines:?}");
    report.devices[0].phase = NodePhase::Operational;
    assert_eq!(silent_devices(&report).len(), 4);
}

#[test]
fn unwritable_black_box_is_counted_without_blocking() {
    let configuration =
        floorguard_configuration::parse("robot.toml", floorguard_configuration::EXAMPLE).unwrap();
    let shared: Box<HostedShared> = new_shared(&configuration.robot, Stamp::ZERO).unwrap();
    let arguments = RunArguments {
        file: PathBuf::from("robot.toml"),
        duration: None,
        json: false,
        black_box: Some(PathBuf::from("/dev/null/stops")),
        learn: None,
        record: None,
        panel: None,
    };
    let mut watch = Watch::new(&arguments, &shared);
    let stop = StopRecord {
        stamp: Stamp::ZERO,
        cause: CauseRecord::new(Cause::EmergencyStop, Stamp::ZERO),
        state: GuardState::Latched,
        pose_in_odometry: Pose2::default(),
        speed_mps: 0.5,
    };
    watch.on_stop(&stop);
    watch.on_stop(&stop);
    assert_eq!(watch.stops, 2);
    let reported = all_written(watch.unwritten.as_ref()).unwrap_err().to_string();
    assert!(reported.contains("2 files") && reported.contains("/dev/null/stops"), "{reported}");
    assert!(all_written(None).is_ok());
}
