//! `[scanner]` with `model = "bridged"`: what the scans are that a bridge sends.

use floorguard_drivers::scan_link::{BEAMS_MAX, ScanShape};

use super::reader::Reader;

/// Beams of the coarsest scanner that finds a leg.
const BEAMS_LEAST: i64 = 60;
/// A whole turn, and what rounding adds to it, degrees.
const TURN_DEG: f32 = 360.01;
/// The last beam looks no farther: the sector of the body is counted from the front to both sides.
const LAST_DEG: f32 = 180.01;
/// Before the keys are read.
pub(super) const NO_SHAPE: ScanShape =
    ScanShape { beams: 0, first_udeg: 0, step_udeg: 0, period_us: 0, range_mm: [0; 2] };

/// Beams, angles, period and range: datagrams with others are refused, because a beam that points elsewhere is an obstacle in the
/// wrong place.
pub(super) fn read_bridged(section: &Reader<'_>) -> Option<ScanShape> {
    let beams = section.integer("beams", BEAMS_LEAST..=i64::from(BEAMS_MAX)) as u16;
    let first_deg = section.number("first_deg", -180.0..=180.0);
    let step_deg = section.number("step_deg", 0.05..=5.0);
    let period_s = section.number("period_s", 0.01..=0.2);
    let nearest_m = section.number_or("nearest_m", 0.01..=1.0, 0.05);
    let farthest_m = section.number("farthest_m", 1.0..=65.0);
    if !section.good_so_far() {
        return None;
    }
    let around_deg = step_deg * f32::from(beams);
    if around_deg > TURN_DEG {
        section.refuse(
            section.span(),
            format!(
                "[scanner]: {beams} beams {step_deg}° apart are {around_deg:.1}°, more than a turn of 360°"
            ),
            "write `beams` and `step_deg` as the bridge sends them: a full turn of 0.25° has 1440 beams",
        );
        return None;
    }
    let last_deg = first_deg + step_deg * f32::from(beams.saturating_sub(1));
    if last_deg > LAST_DEG {
        section.refuse(
            section.span(),
            format!("[scanner]: the last of {beams} beams looks to {last_deg:.1}°, allowed is up to 180°"),
            "let the bridge begin a full turn at -180°; of a part of a turn that runs across the back, turn the frame and `yaw_deg`",
        );
        return None;
    }
    Some(ScanShape {
        beams,
        first_udeg: micro(first_deg) as i32,
        step_udeg: micro(step_deg) as u32,
        period_us: micro(period_s) as u32,
        range_mm: [nearest_m, farthest_m].map(|range_m| (range_m * 1_000.0).round() as u16),
    })
}

/// Millionths.
fn micro(value: f32) -> i64 {
    (f64::from(value) * 1.0e6).round() as i64
}

/// The keys of `[scanner]` for a scanner of a full turn behind a bridge, without those that every scanner has: for examples and simulated
/// robots.
#[must_use]
pub fn bridged_scanner_keys(shape: &ScanShape) -> String {
    let degrees = |micros: i64| micros as f64 / 1.0e6;
    let [nearest_m, farthest_m] = shape.range_mm.map(|range_mm| f64::from(range_mm) / 1.0e3);
    format!(
        "model = \"bridged\"\nsource = \"udp:127.0.0.1:2370\"\nbeams = {}\nfirst_deg = {:?}\nstep_deg = {:?}\nperiod_s = {:?}\n\
         nearest_m = {nearest_m:?}\nfarthest_m = {farthest_m:?}\n",
        shape.beams,
        degrees(i64::from(shape.first_udeg)),
        degrees(i64::from(shape.step_udeg)),
        f64::from(shape.period_us) / 1.0e6,
    )
}

/// A scanner of a full turn, 0.25° from beam to beam, ten turns a second: for examples and simulated robots.
pub const BRIDGED_EXAMPLE: ScanShape = ScanShape {
    beams: 1_440,
    first_udeg: -180_000_000,
    step_udeg: 250_000,
    period_us: 100_000,
    range_mm: [50, 30_000],
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, ScannerAddress, parse};
    use floorguard_guard::Source;
    use floorguard_runtime::configuration::{RangingModel, ScannerModel};

    const LINE: &str = "model = \"s300\"\nsource = \"serial:/dev/ttyUSB0\"\nbaud = 500000\n";

    fn with(keys: &str) -> String {
        assert!(EXAMPLE.contains(LINE));
        EXAMPLE.replace(LINE, keys)
    }

    fn accepted() -> String {
        bridged_scanner_keys(&BRIDGED_EXAMPLE) + "accept_uncertified_mps = 0.3\n"
    }

    #[test]
    fn keys_give_the_same_scans() {
        let read = parse("robot.toml", &with(&accepted())).unwrap_or_else(|refused| panic!("{refused}"));
        let ScannerModel::Ranging(RangingModel::Bridged(shape)) = read.robot.scanner.model else {
            panic!("{:?}", read.robot.scanner.model)
        };
        assert_eq!(shape, BRIDGED_EXAMPLE);
        assert!(matches!(read.carriers.scanner, ScannerAddress::Datagrams(_)));
        let guard = read.robot.guard();
        guard.validate().unwrap();
        assert_eq!((guard.scanner.beams, guard.scanner.step_rad), (1_440, 0.25_f32.to_radians()));
        // Ten scans a second let the robot react later, and the newest scan is late later.
        let plain = parse("robot.toml", EXAMPLE).unwrap().robot;
        assert!((read.robot.limits.response_s - plain.limits.response_s - 0.24).abs() < 1.0e-6);
        let rules = guard.rules(Source::Scanner);
        assert_eq!((rules.limit_after_us, rules.stop_after_us), (220_000, Some(320_000)));
    }

    /// It is no safety device, and no robot drives behind it without a stated speed.
    #[test]
    fn fg_req_085_bridged_scanners_need_a_speed() {
        let refused =
            parse("robot.toml", &with(&bridged_scanner_keys(&BRIDGED_EXAMPLE))).expect_err("refused");
        let refused = refused.to_string();
        assert!(
            refused.contains("scanner behind a bridge is no safety device")
                && refused.contains("accept_uncertified_mps = 0.3"),
            "{refused}"
        );
        let read = parse("robot.toml", &with(&accepted())).unwrap_or_else(|refused| panic!("{refused}"));
        let unseen = read.robot.unseen;
        for speed in [unseen.forward_mps, unseen.turning_mps, unseen.spinning_mps, unseen.reverse_mps] {
            assert!(speed <= 0.3, "{speed}");
        }
    }

    #[test]
    fn missing_and_impossible_keys_are_refused() {
        for (from, to, words) in [
            ("beams = 1440\n", "", "beams"),
            ("first_deg = -180.0\n", "", "first_deg"),
            ("period_s = 0.1\n", "", "period_s"),
            ("period_s = 0.1\n", "period_s = 0.5\n", "0.2"),
            ("farthest_m = 30.0\n", "", "farthest_m"),
            ("first_deg = -180.0", "first_deg = 0.0", "looks to 359.8°"),
            ("beams = 1440", "beams = 2000", "more than a turn of 360°"),
            ("step_deg = 0.25\n", "step_deg = 0.25\nbaud = 115200\n", "baud"),
        ] {
            let keys = accepted();
            assert!(keys.contains(from), "{from}");
            let refused =
                parse("robot.toml", &with(&keys.replace(from, to))).expect_err("refused").to_string();
            assert!(refused.contains(words), "{words} is not in: {refused}");
        }
    }
}
