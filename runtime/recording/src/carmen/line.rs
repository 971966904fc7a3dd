//! One line of a log.
//!
//! Source: the message formats that each log names in its head (`ODOM`, `FLASER`), and CARMEN's logger for
//! `ROBOTLASER` and `RAWLASER`.

use floorguard_types::geometry::{Pose2, Twist2};

/// What a line says; lines of other kinds say nothing to us.
#[derive(Clone, Debug, PartialEq)]
pub enum CarmenLine {
    /// Odometry: pose, speed, time in seconds.
    Odometry(Pose2, Twist2, f64),
    /// A scan.
    Laser(LaserLine),
    /// A comment, a parameter, another device.
    Other,
}

/// A scan.
#[derive(Clone, Debug, PartialEq)]
pub struct LaserLine {
    /// Angle of the first beam in the laser's frame, radians; beams run counter-clockwise.
    pub first_angle_rad: f32,
    /// From beam to beam, radians.
    pub step_rad: f32,
    /// Ranges of this and more mean that nothing came back, metres.
    pub range_max_m: f32,
    /// The ranges, metres.
    pub ranges_m: Vec<f32>,
    /// Laser in the frame of the log; `None` where the log does not tell.
    pub laser_in_odom: Option<Pose2>,
    /// Seconds, of the message if it has a time, else of the logger.
    pub time_s: f64,
}

/// Why a line of a known kind cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LineError {
    /// It ends too early, or a word is no number.
    #[error("{kind}: {what} is missing or no number")]
    Number {
        /// Kind of the line.
        kind: &'static str,
        /// What was expected.
        what: &'static str,
    },
    /// It claims more beams than any scanner has.
    #[error("{kind}: {beams} beams are more than any scanner has")]
    Beams {
        /// Kind of the line.
        kind: &'static str,
        /// What it claims.
        beams: usize,
    },
}

/// More beams in a line than this are a damaged number.
const BEAMS_MAX: usize = 20_000;
/// A SICK that says nothing else: no return from here on, metres.
const FLASER_RANGE_MAX_M: f32 = 80.0;

struct Words<'a> {
    words: std::str::SplitAsciiWhitespace<'a>,
    kind: &'static str,
}

impl<'a> Words<'a> {
    fn number(&mut self, what: &'static str) -> Result<f64, LineError> {
        let word = self.words.next().and_then(|word| word.parse::<f64>().ok());
        word.filter(|number| number.is_finite()).ok_or(LineError::Number { kind: self.kind, what })
    }

    fn single(&mut self, what: &'static str) -> Result<f32, LineError> {
        self.number(what).map(|number| number as f32)
    }

    fn beams(&mut self) -> Result<usize, LineError> {
        let kind = self.kind;
        let word = self.words.next().and_then(|word| word.parse::<usize>().ok());
        let beams = word.ok_or(LineError::Number { kind, what: "the number of beams" })?;
        if beams > BEAMS_MAX { Err(LineError::Beams { kind, beams }) } else { Ok(beams) }
    }

    fn ranges(&mut self, beams: usize) -> Result<Vec<f32>, LineError> {
        (0..beams).map(|_| self.range()).collect()
    }

    /// A range that is no finite number means nothing came back.
    fn range(&mut self) -> Result<f32, LineError> {
        let word = self.words.next().and_then(|word| word.parse::<f32>().ok());
        let range = word.ok_or(LineError::Number { kind: self.kind, what: "a range" })?;
        Ok(if range.is_finite() && range >= 0.0 { range } else { f32::INFINITY })
    }

    fn pose(&mut self, what: &'static str) -> Result<Pose2, LineError> {
        Ok(Pose2::new(self.single(what)?, self.single(what)?, self.single(what)?))
    }

    /// Time of the message, host, time of the logger: the first that is there and not zero.
    fn time(&mut self) -> Result<f64, LineError> {
        let message = self.number("the time")?;
        let _host: Option<&'a str> = self.words.next();
        let logger = self.words.next().and_then(|word| word.parse::<f64>().ok());
        Ok(if message > 0.0 { message } else { logger.filter(|time| *time > 0.0).unwrap_or(message) })
    }
}

/// Reads a line.
///
/// # Errors
/// A line of a known kind is damaged.
pub fn parse_line(text: &str) -> Result<CarmenLine, LineError> {
    let mut words = text.split_ascii_whitespace();
    let kind = words.next().unwrap_or_default();
    let known = |kind| Words { words: words.clone(), kind };
    match kind {
        "ODOM" => odometry(known("ODOM")),
        "FLASER" => flaser(known("FLASER")),
        "ROBOTLASER1" => robot_laser(known("ROBOTLASER1"), true),
        "RAWLASER1" => robot_laser(known("RAWLASER1"), false),
        _ => Ok(CarmenLine::Other),
    }
}

fn odometry(mut words: Words<'_>) -> Result<CarmenLine, LineError> {
    let pose = words.pose("the pose")?;
    let twist = Twist2 { linear_mps: words.single("the speed")?, angular_radps: words.single("the turn")? };
    let _acceleration = words.number("the acceleration")?;
    Ok(CarmenLine::Odometry(pose, twist, words.time()?))
}

fn flaser(mut words: Words<'_>) -> Result<CarmenLine, LineError> {
    let beams = words.beams()?;
    let ranges_m = words.ranges(beams)?;
    let laser = words.pose("the pose of the laser")?;
    // Corrected logs carry the odometry here and the better pose in front.
    let _odometry = words.pose("the odometry")?;
    // 180 and 360 beams begin at −90° and leave out the last one; with 181 and 361 both ends are there.
    let steps = if beams % 2 == 1 { beams.saturating_sub(1) } else { beams };
    let step_rad = std::f32::consts::PI / steps.max(1) as f32;
    Ok(CarmenLine::Laser(LaserLine {
        first_angle_rad: -std::f32::consts::FRAC_PI_2,
        step_rad,
        range_max_m: FLASER_RANGE_MAX_M,
        ranges_m,
        laser_in_odom: Some(laser),
        time_s: words.time()?,
    }))
}

fn robot_laser(mut words: Words<'_>, with_pose: bool) -> Result<CarmenLine, LineError> {
    let _kind = words.number("the type")?;
    let first_angle_rad = words.single("the first angle")?;
    let _field_of_view = words.number("the field of view")?;
    let step_rad = words.single("the resolution")?;
    let range_max_m = words.single("the greatest range")?;
    let _rest = (words.number("the accuracy")?, words.number("the remission mode")?);
    let beams = words.beams()?;
    let ranges_m = words.ranges(beams)?;
    let remissions = words.beams()?;
    for _ in 0..remissions {
        words.number("a remission")?;
    }
    let mut laser_in_odom = None;
    if with_pose {
        laser_in_odom = Some(words.pose("the pose of the laser")?);
        let _robot = words.pose("the pose of the robot")?;
        for what in ["the speed", "the turn", "a safety distance", "a safety distance", "the turn axis"] {
            words.number(what)?;
        }
    }
    let time_s = words.time()?;
    Ok(CarmenLine::Laser(LaserLine {
        first_angle_rad,
        step_rad,
        range_max_m,
        ranges_m,
        laser_in_odom,
        time_s,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scans_of_both_formats() {
        let line = parse_line("FLASER 3 1.0 2.5 81.91 1 2 0.5 1 2 0.5 12.25 host 3.0").unwrap();
        let CarmenLine::Laser(scan) = line else { panic!("{line:?}") };
        assert_eq!(scan.ranges_m, [1.0, 2.5, 81.91]);
        assert!((scan.step_rad - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        assert_eq!((scan.time_s, scan.laser_in_odom), (12.25, Some(Pose2::new(1.0, 2.0, 0.5))));
        let text = "ROBOTLASER1 0 -1.5 3.0 1.5 50 0.01 0 3 1 2 inf 1 7 3 4 0.1 3 4 0.1 0 0 0 0 0 9.5 host 1";
        let CarmenLine::Laser(scan) = parse_line(text).unwrap() else { panic!() };
        assert_eq!(scan.ranges_m, [1.0, 2.0, f32::INFINITY]);
        assert_eq!((scan.range_max_m, scan.time_s), (50.0, 9.5));
    }

    #[test]
    fn damage_is_named_other_lines_are_skipped() {
        assert_eq!(parse_line("# a comment"), Ok(CarmenLine::Other));
        assert_eq!(parse_line("PARAM robot_frontlaser_offset 0.0 nohost 0"), Ok(CarmenLine::Other));
        let number = |what| Err(LineError::Number { kind: "FLASER", what });
        assert_eq!(parse_line("FLASER 3 1 2"), number("a range"));
        assert_eq!(parse_line("FLASER x"), number("the number of beams"));
        assert_eq!(parse_line("FLASER 999999"), Err(LineError::Beams { kind: "FLASER", beams: 999_999 }));
        assert!(parse_line("ODOM 1 2 nan 0 0 0 1 h 1").is_err());
    }
}
