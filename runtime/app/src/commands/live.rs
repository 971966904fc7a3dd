//! From the robot's own status to what the user sees.

use floorguard_guard::Health;
use floorguard_runtime::shared::RobotStatus;

use floorguard_operator::display::{SourceStatus, Status};

/// The status for the live table; people, stops and the last stop come from the caller.
pub(super) fn status_of(
    elapsed_s: f64,
    status: &RobotStatus,
    (people, stops, last_stop): (usize, u32, Option<String>),
) -> Status {
    let sources = status.sources.iter().filter(|report| report.fitted).map(|report| SourceStatus {
        name: report.source.name().to_owned(),
        health: report.health.to_string(),
        good: report.health == Health::Healthy,
    });
    Status {
        elapsed_s,
        speed_mps: status.pose.twist.linear_mps,
        limit_mps: status.decision.speed_limit_mps,
        people,
        stops,
        last_stop,
        held_by: status.decision.holding_cause.map(|record| record.to_string()),
        mission: None,
        sources: sources.collect(),
    }
}
