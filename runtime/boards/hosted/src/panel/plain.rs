//! What a cause means for the person beside the robot, and what helps.
//!
//! `docs/src/operating.md` tells the same on paper; a test holds the two together.

use floorguard_core::guard::{Cause, CauseRecord, Clear, Source};

/// What to do about it.
pub fn remedy(record: &CauseRecord) -> &'static str {
    match (record.cause, record.cause.clear()) {
        (Cause::EmergencyStop, _) => "Release the emergency stop, look around, then press reset.",
        (Cause::StartUp, _) => {
            "Wait: the robot checks its sensors. If it takes long, look which one is not healthy."
        }
        (Cause::BumperFront | Cause::BumperRear, _) => "Free the bumper, look around, then press reset.",
        (Cause::CliffFront | Cause::CliffRear, _) => {
            "By itself it drives only straight away from the edge. If it stays: press the emergency stop, hold the robot, release \
             its brake as the machine's manual says and move it away; then release the emergency stop, look around and press \
             reset."
        }
        (Cause::InputUnknown, _) => {
            "The safety inputs could not be read, and a button pressed meanwhile was not heard: check wiring and safety \
             controller, look around, then press reset."
        }
        (Cause::InputFault, _) => {
            "Check emergency stop, bumpers and cliff sensors, their cables and plugs: where one has two channels, both must \
             change together. Look around, then press reset."
        }
        (Cause::SourceLost(Source::Discrete), _) => {
            "Check cable and power of the safety controller, look around, then press reset."
        }
        (Cause::SourceLost(Source::Drive), _) => {
            "Check cable and power of the drive, look around, then press reset."
        }
        (Cause::DriveFault, _) => "Clear the reason of the drive's own fault, then press reset.",
        (Cause::Overspeed, _) => {
            "Faster than permitted: try the brake and the drive before it drives again, then press reset."
        }
        (Cause::SpeedDisagreement | Cause::TurnDisagreement, _) => {
            "Check encoders, wheels and inertial sensor: two of them tell different movements. Then press reset."
        }
        (Cause::SteeringDisagreement, _) => {
            "A wheel slips: dry the floor. If the floor is dry, have the steering checked."
        }
        (Cause::PersonNear | Cause::CollisionStop | Cause::CollisionSlow, _) => {
            "Nothing to do: the robot goes on when the person has passed."
        }
        (Cause::ScanProtective | Cause::LidarProtective | Cause::Warning, _) => {
            "Take away what stands in front of the robot, or wait until it has passed."
        }
        (Cause::BlindSector, _) => "Clean the window of the safety scanner.",
        (Cause::SourceLate(Source::Command) | Cause::SourceLost(Source::Command), _) => {
            "Nothing to do: nobody tells the robot where to go; it goes on with the next command."
        }
        (Cause::SourceLate(Source::Perception) | Cause::SourceLost(Source::Perception), _) => {
            "Wait: the computer is late. If it stays so, look whether the lidar is there, then switch the robot off and on."
        }
        (Cause::SourceLate(_) | Cause::SourceLost(_), Clear::Quiet(_)) => {
            "Check cable and power of the device; the robot goes on when it is back."
        }
        (_, Clear::Reset) => "Find out why, then press reset.",
        (_, Clear::Restart) => "Switch the robot off and on; call service if it happens again.",
        (_, Clear::Quiet(_)) => "Nothing to do: it clears by itself.",
    }
}

#[cfg(test)]
mod tests {
    use floorguard_core::time::Stamp;

    use super::*;

    /// How it clears, in the words of the book.
    fn clears(cause: Cause) -> String {
        match cause.clear() {
            Clear::Quiet(quiet_us) => {
                format!("by itself, {:.1} s after the last of it", quiet_us as f64 * 1.0e-6)
            }
            Clear::Reset => String::from("after reset"),
            Clear::Restart => String::from("after a restart"),
        }
    }

    fn said(cause: Cause) -> String {
        match cause {
            Cause::SourceLate(source) => format!("{} late", source.name()),
            Cause::SourceLost(source) => format!("{} absent, stale, frozen, blind or faulty", source.name()),
            plain => plain.to_string(),
        }
    }

    #[test]
    fn the_book_tells_every_cause_as_the_panel_does() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/src/operating.md");
        let book = std::fs::read_to_string(file).expect("the chapter");
        let rows: Vec<String> = Cause::all()
            .into_iter()
            .map(|cause| {
                let help = remedy(&CauseRecord::new(cause, Stamp::ZERO));
                format!("| {} | {} | {} | {help} |", said(cause), cause.action(), clears(cause))
            })
            .collect();
        let missing: Vec<&String> = rows.iter().filter(|row| !book.contains(*row)).collect();
        assert!(missing.is_empty(), "docs/src/operating.md lacks these rows:\n{}", rows.join("\n"));
    }

    #[test]
    fn whoever_must_press_reset_is_told_what_to_look_at_first() {
        let vague = Cause::all().into_iter().filter(|cause| {
            let help = remedy(&CauseRecord::new(*cause, Stamp::ZERO));
            cause.clear() == Clear::Reset
                && (!help.contains("press reset") || help.starts_with("Find out why"))
        });
        // The clock is nothing that anybody beside the robot could look at.
        assert_eq!(vague.collect::<Vec<_>>(), [Cause::ClockFault]);
    }
}
