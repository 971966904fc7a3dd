//! How fast the robot may be, and how late its sources.

use floorguard_runtime::configuration::{Deadlines, Limits};

use super::reader::Reader;

/// `[limits]`.
pub(super) fn read_limits(section: Reader<'_>) -> Limits {
    let limits = Limits {
        speed_mps: section.number("speed_mps", 0.05..=2.0),
        reverse_mps: section.number("reverse_mps", 0.0..=0.5),
        turn_radps: section.number("turn_radps", 0.05..=2.0),
        acceleration_mps2: section.number("acceleration_mps2", 0.05..=2.0),
        braking_mps2: section.number("braking_mps2", 0.1..=5.0),
        response_s: section.number("response_s", 0.0..=1.0),
    };
    section.finish();
    limits
}

/// `[deadlines]`.
pub(super) fn read_deadlines(section: Reader<'_>) -> Deadlines {
    // Microseconds are exact for every value that passes the range check.
    let micros = |key, longest_s| (section.number(key, 0.02..=longest_s) * 1.0e6) as u64;
    let scanner_us = micros("scanner_s", 0.3);
    let rear_s = section.number_or("rear_scanner_s", 0.02..=0.3, scanner_us as f32 * 1.0e-6);
    let deadlines = Deadlines {
        scanner_us,
        rear_scanner_us: (rear_s * 1.0e6) as u64,
        lidar_us: micros("lidar_s", 0.5),
        odometry_us: micros("odometry_s", 0.2),
        command_us: micros("command_s", 0.5),
    };
    section.finish();
    deadlines
}
