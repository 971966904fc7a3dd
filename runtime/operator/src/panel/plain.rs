//! What a cause means for the person beside the robot, and what helps.
//!
//! `docs/src/operating.md` tells the same on paper; a test holds the two together.

use floorguard_guard::{Cause, CauseRecord, Clear, Health, Source, Unit};

/// What to do about it.
pub fn remedy(record: &CauseRecord) -> &'static str {
    match (record.cause, record.cause.clear()) {
        (Cause::EmergencyStop, _) => "Release the emergency stop, look around, then press reset.",
        (Cause::StartUp, _) => {
            "Wait: the robot checks its sensors. If it takes long, look which one is not healthy."
        }
        (Cause::StartNeeded, _) | (_, Clear::Start) => "Look around, then press start.",
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
        (Cause::SourceLost(Source::Discrete | Source::Drive), _) => for_latched(record),
        (Cause::DriveFault, _) => "Clear the reason of the drive's own fault, then press reset.",
        (Cause::Overspeed, _) => {
            "Faster than permitted: try the brake and the drive before it drives again, then press reset."
        }
        (Cause::StandstillLost, _) => {
            "It moved while it should stand: look whether somebody pushed it or the floor slopes, and have drive and brake tried; then \
             press reset."
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
        (Cause::WayClosed, _) => {
            "Take away what stands or hangs beside the robot, or drive it by hand to where it has room. If nothing is there, on no \
             side and not above it, press reset, then start."
        }
        (Cause::WayNarrow, _) => {
            "Take away what stands or hangs beside the robot, or drive it by hand to where it has room."
        }
        (Cause::BlindSector, _) => "Clean the window of the safety scanner.",
        (Cause::SourceLate(Source::Command) | Cause::SourceLost(Source::Command), _) => {
            "Nothing to do: nobody tells the robot where to go; it goes on with the next command."
        }
        (Cause::SourceLate(Source::Perception) | Cause::SourceLost(Source::Perception), _) => {
            "Wait: the computer is late. If it stays so, look whether the lidar is there, then switch the robot off and on."
        }
        (Cause::SourceLate(_) | Cause::SourceLost(_), Clear::Quiet(_)) => for_device(record),
        (_, Clear::Reset) => "Find out why, then press reset.",
        (_, Clear::Restart) => "Switch the robot off and on; call service if it happens again.",
        (_, Clear::Quiet(_)) => "Nothing to do: it clears by itself.",
    }
}

/// What to do about a device whose loss waits for the operator.
fn for_latched(record: &CauseRecord) -> &'static str {
    match (record.cause, record.health) {
        (Cause::SourceLost(Source::Drive), Health::Healthy) => {
            "The computer was off while the drive had power: look around, then press reset."
        }
        (Cause::SourceLost(Source::Drive), _) => {
            "Check cable and power of the drive, look around, then press reset."
        }
        _ => "Check cable and power of the safety controller, look around, then press reset.",
    }
}

/// What to do about a device: only one that says nothing is looked for at its cable first.
fn for_device(record: &CauseRecord) -> &'static str {
    match record.health {
        Health::Faulty if record.unit == Unit::Code => {
            "The device reports a fault of its own: look at its display, if it has one, then reset it or switch it off and on. \
             The robot goes on when it measures again."
        }
        Health::Faulty if record.ahead_us > 0 => {
            "Switch the device off and on; call service if it happens again."
        }
        Health::Faulty => {
            "See whether the device is still starting, or is another one than the robot was set up for; then check its cable and \
             power."
        }
        Health::Frozen => {
            "The device repeats one and the same measurement: switch it off and on; call service if it happens again."
        }
        Health::Blind => "Uncover the device and clean its window; the robot goes on when it sees again.",
        Health::Healthy | Health::Stale | Health::Absent => {
            "Check cable and power of the device; the robot goes on when it is back."
        }
    }
}

#[cfg(test)]
#[path = "plain_tests.rs"]
mod tests;
