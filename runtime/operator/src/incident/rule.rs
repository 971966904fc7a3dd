//! Which requirement of the guard stands behind a cause, and its text.

use floorguard_guard::Cause;

/// The list of requirements, as the audit reads it.
const REQUIREMENTS: &str = include_str!("../../../../docs/requirements.md");

/// Identifier of the requirement that a cause follows from.
#[must_use]
pub const fn requirement(cause: Cause) -> &'static str {
    match cause {
        Cause::StartUp => "FG-REQ-012",
        Cause::StartNeeded => "FG-REQ-019",
        Cause::EmergencyStop
        | Cause::InputFault
        | Cause::InputUnknown
        | Cause::BumperFront
        | Cause::BumperRear
        | Cause::CliffFront
        | Cause::CliffRear
        | Cause::DriveFault => "FG-REQ-002",
        Cause::ScanProtective => "FG-REQ-020",
        Cause::LidarProtective => "FG-REQ-023",
        Cause::BlindSector => "FG-REQ-024",
        Cause::WayClosed | Cause::WayNarrow => "FG-REQ-027",
        Cause::Warning => "FG-REQ-021",
        Cause::PersonNear | Cause::CollisionStop | Cause::CollisionSlow => "FG-REQ-031",
        Cause::AdviceStop | Cause::AdviceLimit => "FG-REQ-030",
        Cause::CommandInvalid => "FG-REQ-054",
        Cause::Overspeed => "FG-REQ-050",
        Cause::StandstillLost => "FG-REQ-057",
        Cause::SpeedDisagreement => "FG-REQ-051",
        Cause::TurnDisagreement => "FG-REQ-052",
        Cause::SteeringDisagreement => "FG-REQ-053",
        Cause::ClockFault => "FG-REQ-008",
        Cause::StateCorrupted => "FG-REQ-017",
        Cause::SourceLate(_) => "FG-REQ-010",
        Cause::SourceLost(_) => "FG-REQ-013",
    }
}

/// The text of a requirement; empty for one that the list does not have.
#[must_use]
pub fn requirement_text(identifier: &str) -> &'static str {
    let row = REQUIREMENTS
        .lines()
        .find(|line| line.strip_prefix("| ").is_some_and(|rest| rest.split(" |").next() == Some(identifier)));
    row.and_then(|line| line.split('|').nth(2)).map_or("", str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cause_has_a_requirement_with_a_text() {
        for cause in Cause::all() {
            assert!(requirement_text(requirement(cause)).len() > 20, "{cause}");
        }
        assert!(requirement_text(requirement(Cause::ScanProtective)).contains("protective field"));
        assert_eq!(requirement_text("FG-REQ-999"), "");
    }
}
