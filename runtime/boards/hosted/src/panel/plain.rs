//! What a cause means for the person beside the robot, and what helps.

use floorguard_core::guard::{Cause, CauseRecord, Clear};

/// What to do about it.
pub fn remedy(record: &CauseRecord) -> &'static str {
    match (record.cause, record.cause.clear()) {
        (Cause::EmergencyStop, _) => "Release the emergency stop, look around, then press reset.",
        (Cause::StartUp, _) => {
            "Wait: the robot checks its sensors. If it takes long, look which one is not healthy."
        }
        (Cause::BumperFront | Cause::BumperRear, _) => "Free the bumper, look around, then press reset.",
        (Cause::CliffFront | Cause::CliffRear, _) => "Push the robot back from the edge, then press reset.",
        (Cause::PersonNear | Cause::CollisionStop | Cause::CollisionSlow, _) => {
            "Nothing to do: the robot goes on when the person has passed."
        }
        (Cause::ScanProtective | Cause::LidarProtective | Cause::Warning, _) => {
            "Take away what stands in front of the robot, or wait until it has passed."
        }
        (Cause::BlindSector, _) => "Clean the window of the safety scanner.",
        (Cause::SourceLate(_) | Cause::SourceLost(_), Clear::Quiet(_)) => {
            "Check cable and power of the sensor; the robot goes on when it is back."
        }
        (_, Clear::Reset) => "Find out why, then press reset.",
        (_, Clear::Restart) => "Switch the robot off and on; call service if it happens again.",
        (_, Clear::Quiet(_)) => "Nothing to do: it clears by itself.",
    }
}
