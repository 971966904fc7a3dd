//! What the display does with stops that cannot be written.

use floorguard_guard::{Cause, CauseRecord, GuardState};
use floorguard_runtime::shared::StopRecord;
use floorguard_types::geometry::Pose2;
use floorguard_types::time::Stamp;

use super::*;

#[test]
fn unwritable_black_box_is_counted_without_blocking() {
    let configuration =
        floorguard_configuration::parse("robot.toml", floorguard_configuration::EXAMPLE).unwrap();
    let shared: Box<HostedShared> = new_shared(&configuration.robot, Stamp::ZERO).unwrap();
    let arguments = RunArguments {
        file: PathBuf::from("robot.toml"),
        learn: None,
        map_here: MapHere::default(),
        outputs: RunOutputs { black_box: Some(PathBuf::from("/dev/null/stops")), ..RunOutputs::default() },
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
